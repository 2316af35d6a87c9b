//! Named steps: what does not wait for another runs beside it, and a table at the end says when each ran.

use std::fs::{self, File};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use crate::process::{Failure, Log, Result, path};

/// The work of a step.
type Work<'a> = Box<dyn FnOnce(&mut Log) -> Result<()> + Send + 'a>;

/// Steps that have not begun.
#[derive(Default)]
pub struct Steps<'a>(Vec<Step<'a>>);

struct Step<'a> {
    name: String,
    after: Vec<String>,
    work: Work<'a>,
}

/// A step that has ended; times in seconds from the start of all.
struct Ended {
    name: String,
    from: f64,
    to: f64,
    is_done: bool,
    /// What its test programs counted, if there were any.
    tests: Option<Tests>,
}

struct State<'a> {
    waiting: Vec<Step<'a>>,
    ended: Vec<Ended>,
    failure: Option<Failure>,
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

    /// Runs the steps one after another; their output goes to the terminal.
    pub fn run(self) -> Result<()> {
        self.run_by(1)
    }

    /// Runs three steps at a time, for their long parts use one core or wait: they keep two busy. The output of each is printed when
    /// it ends; meanwhile it is in target/steps. Once one has failed none begins, and those that run are waited for.
    pub fn run_beside_each_other(self) -> Result<()> {
        self.run_by(3)
    }

    fn run_by(self, num_workers: usize) -> Result<()> {
        let start = Instant::now();
        let state = Mutex::new(State {
            waiting: self.0,
            ended: Vec::new(),
            failure: None,
        });
        let changed = Condvar::new();
        thread::scope(|scope| {
            for _ in 0..num_workers {
                scope.spawn(|| work(&state, &changed, start, num_workers == 1));
            }
        });
        let state = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        print_table(&state.ended);
        state.failure.map_or(Ok(()), Err)
    }
}

/// Runs one ready step after another, until there are none.
fn work(state: &Mutex<State>, changed: &Condvar, start: Instant, to_terminal: bool) {
    let mut now = lock(state);
    loop {
        if now.failure.is_some() || now.waiting.is_empty() {
            return;
        }
        let is_done = |name: &String| now.ended.iter().any(|step| step.name == *name);
        let ready = |step: &Step| step.after.iter().all(is_done);
        let Some(place) = now.waiting.iter().position(ready) else {
            now = changed.wait(now).unwrap_or_else(PoisonError::into_inner);
            continue;
        };
        let Step { name, work, .. } = now.waiting.remove(place);
        drop(now);
        println!("\n== {name}");
        let from = start.elapsed().as_secs_f64();
        let (result, said) = run_step(&name, work, to_terminal);
        let to = start.elapsed().as_secs_f64();
        now = lock(state);
        let is_done = result.is_ok();
        let outcome = outcome(is_done);
        println!("{said}== {name}: {outcome} after {:.1} s", to - from);
        now.ended.push(Ended {
            name,
            from,
            to,
            is_done,
            tests: Tests::counted_in(&said),
        });
        now.failure = now.failure.take().or(result.err());
        changed.notify_all();
    }
}

/// Runs a step, and returns what it said where that is not on the terminal already.
fn run_step(name: &str, work: Work, to_terminal: bool) -> (Result<()>, String) {
    if to_terminal {
        return (work(&mut Log(None)), String::new());
    }
    let file = path("target/steps").join(format!("{name}.log"));
    let created = fs::create_dir_all(path("target/steps")).and_then(|()| File::create(&file));
    let result = created
        .map_err(|error| Failure::of_file(&file, &error))
        .and_then(|created| work(&mut Log(Some(created))));
    let said = fs::read(&file).unwrap_or_default();
    (result, String::from_utf8_lossy(&said).into_owned())
}

fn lock<'a, 'b>(state: &'a Mutex<State<'b>>) -> MutexGuard<'a, State<'b>> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn print_table(ended: &[Ended]) {
    let width = ended.iter().map(|step| step.name.len()).max().unwrap_or(0);
    println!("\n{:width$}   from     to   took  (seconds)", "");
    for step in ended {
        let Ended { name, from, to, .. } = step;
        let (took, outcome) = (to - from, outcome(step.is_done));
        print!("{name:width$} {from:>6.0} {to:>6.0} {took:>6.1}  {outcome}");
        match &step.tests {
            Some(Tests([passed, failed, ignored])) => {
                println!("  tests: {passed} passed, {failed} failed, {ignored} ignored");
            }
            None => println!(),
        }
    }
    let num_done = ended.iter().filter(|step| step.is_done).count();
    let num_failed = ended.len() - num_done;
    println!("steps: {num_done} done, {num_failed} failed");
}

fn outcome(is_done: bool) -> &'static str {
    if is_done { "done" } else { "FAILED" }
}

/// How many tests passed, failed and were ignored.
struct Tests([u32; 3]);

impl Tests {
    /// The sums of what Rust's test programs and Node's say at their ends.
    fn counted_in(said: &str) -> Option<Self> {
        const NAMES: [[&str; 3]; 2] =
            [["passed", "failed", "ignored"], ["pass", "fail", "skipped"]];
        let mut sums = None;
        for line in said.lines() {
            let words: Vec<&str> = line.split([' ', ';']).collect();
            let pairs: Vec<(&str, &str)> = match words[..] {
                ["test", "result:", _, ref counts @ ..] => {
                    counts.windows(2).map(|pair| (pair[1], pair[0])).collect()
                }
                ["#" | "ℹ", name, count] => vec![(name, count)],
                _ => continue,
            };
            for (name, count) in pairs {
                let place = NAMES
                    .iter()
                    .find_map(|names| names.iter().position(|n| *n == name));
                if let (Some(place), Ok(count)) = (place, count.parse::<u32>()) {
                    sums.get_or_insert([0; 3])[place] += count;
                }
            }
        }
        sums.map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::{Log, Steps, Tests};
    use crate::process::{Failure, Result};
    use std::sync::Mutex;

    #[test]
    fn counts_what_test_programs_say() {
        let rust = "test result: ok. 12 passed; 1 failed; 3 ignored; 0 measured; 7 filtered out; finished in 1s\n";
        let node = "# tests 9\n# pass 7\n# fail 0\n# skipped 2\n";
        let both = Tests::counted_in(&format!("{rust}{node}")).map(|tests| tests.0);
        assert_eq!(both, Some([19, 1, 5]));
        assert!(Tests::counted_in("12 passed\n").is_none());
    }

    #[test]
    fn a_step_waits_for_others_and_none_begins_after_a_failure() {
        let order = Mutex::new(Vec::new());
        let say = |name| {
            let order = &order;
            move |_: &mut Log| -> Result<()> {
                order.lock().map(|mut order| order.push(name)).ok();
                let failure = || Err(Failure::new("it fails", "nothing"));
                if name == "c" { failure() } else { Ok(()) }
            }
        };
        let mut steps = Steps::default();
        steps.add("a", &[], say("a"));
        steps.add("b", &["a"], say("b"));
        steps.add("c", &["b"], say("c"));
        steps.add("d", &["c"], say("d"));
        assert!(steps.run_beside_each_other().is_err());
        assert_eq!(order.into_inner().ok(), Some(vec!["a", "b", "c"]));
    }
}
