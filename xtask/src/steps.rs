//! Named steps: what does not wait for another runs beside it, and a table at the end says when each ran.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

use anyhow::{Result, anyhow};
use fs_err::{self as fs, File};

use crate::process::{Log, path};

/// How many steps run at a time: their long parts use one core or wait, so that three keep two cores busy.
const AT_A_TIME: usize = 3;

type Work<'a> = Box<dyn FnOnce(&mut Log) -> Result<()> + Send + 'a>;

/// Steps that have not begun.
#[derive(Default)]
pub struct Steps<'a>(Vec<Step<'a>>);

struct Step<'a> {
    name: String,
    after: Vec<String>,
    work: Work<'a>,
}

impl<'a> Steps<'a> {
    /// Adds a step that begins when the steps named in `after`, added before it, are done.
    pub fn add(
        &mut self,
        name: impl Into<String>,
        after: &[&str],
        work: impl FnOnce(&mut Log) -> Result<()> + Send + 'a,
    ) {
        let (name, work) = (name.into(), Box::new(work));
        let after: Vec<String> = after.iter().map(|&other| other.to_owned()).collect();
        let is_known = |other: &String| self.0.iter().any(|step| step.name == *other);
        assert!(after.iter().all(is_known), "{name}: {after:?}");
        self.0.push(Step { name, after, work });
    }

    /// Runs all. The output of a step is printed when it ends; meanwhile it is in target/steps. Once one has failed none begins, and
    /// those that run are waited for.
    pub fn run(self) -> Result<()> {
        let mut waiting = self.0;
        let mut done: Vec<String> = Vec::new();
        let mut failure = None;
        let mut table = format!("{:33}   from     to  (seconds)\n", "");
        let (end, ended) = mpsc::channel();
        let (start, mut num_running) = (Instant::now(), 0);
        thread::scope(|scope| {
            loop {
                let is_ready = |step: &Step| step.after.iter().all(|name| done.contains(name));
                while failure.is_none()
                    && num_running < AT_A_TIME
                    && let Some(place) = waiting.iter().position(is_ready)
                {
                    let Step { name, work, .. } = waiting.remove(place);
                    println!("== {name}");
                    let end = end.clone();
                    let from = start.elapsed().as_secs_f64();
                    scope.spawn(move || end.send((run_step(&name, work), name, from)));
                    num_running += 1;
                }
                if num_running == 0 {
                    break;
                }
                let Ok((result, name, from)) = ended.recv() else {
                    break;
                };
                num_running -= 1;
                let to = start.elapsed().as_secs_f64();
                let outcome = if result.is_ok() { "done" } else { "FAILED" };
                println!("{}\n== {name}: {outcome}", said(&name));
                table += &format!("{name:33} {from:>6.0} {to:>6.0}  {outcome}\n");
                match result {
                    Ok(()) => done.push(name),
                    Err(error) => failure = failure.take().or(Some(error)),
                }
            }
        });
        println!("\n{table}");
        failure.map_or(Ok(()), Err)
    }
}

fn run_step(name: &str, work: impl FnOnce(&mut Log) -> Result<()>) -> Result<()> {
    fs::create_dir_all(path("target/steps"))?;
    let mut log = Log(Some(File::create(log_file(name))?));
    let work = AssertUnwindSafe(|| work(&mut log));
    catch_unwind(work).unwrap_or_else(|_| Err(anyhow!("xtask panicked in {name}")))
}

fn said(name: &str) -> String {
    let said = fs::read(log_file(name)).unwrap_or_default();
    String::from_utf8_lossy(&said).into_owned()
}

fn log_file(name: &str) -> std::path::PathBuf {
    path("target/steps").join(format!("{name}.log"))
}

#[cfg(test)]
mod tests {
    use super::{Log, Steps};
    use anyhow::{Result, bail};
    use std::sync::Mutex;

    #[test]
    fn a_step_waits_for_others_and_none_begins_after_a_failure() {
        let order = Mutex::new(Vec::new());
        let say = |name| {
            let order = &order;
            move |_: &mut Log| -> Result<()> {
                order.lock().map(|mut order| order.push(name)).ok();
                if name == "c" {
                    bail!("it fails")
                } else {
                    Ok(())
                }
            }
        };
        let mut steps = Steps::default();
        steps.add("a", &[], say("a"));
        steps.add("b", &["a"], say("b"));
        steps.add("c", &["b"], say("c"));
        steps.add("d", &["c"], say("d"));
        assert!(steps.run().is_err());
        assert_eq!(order.into_inner().ok(), Some(vec!["a", "b", "c"]));
    }
}
