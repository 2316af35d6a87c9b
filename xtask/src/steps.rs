//! Named, timed steps, and the table of them at the end.

use std::time::{Duration, Instant};

use crate::process::Result;

#[derive(Default)]
pub struct Steps(Vec<Step>);

struct Step {
    name: &'static str,
    took: Duration,
    passed: bool,
}

impl Steps {
    /// Runs one step between a line that names it and a line that says how long it took.
    pub fn run<T>(&mut self, name: &'static str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        println!("\n== {name}");
        let start = Instant::now();
        let result = work();
        let step = Step {
            name,
            took: start.elapsed(),
            passed: result.is_ok(),
        };
        println!(
            "== {name}: {} after {:.1} s",
            step.outcome(),
            step.took.as_secs_f64()
        );
        self.0.push(step);
        result
    }

    pub fn print_table(&self) {
        let width = self.0.iter().map(|step| step.name.len()).max().unwrap_or(0);
        println!();
        for step in &self.0 {
            println!(
                "{:width$}  {:>8.1} s  {}",
                step.name,
                step.took.as_secs_f64(),
                step.outcome()
            );
        }
        let passed = self.0.iter().filter(|step| step.passed).count();
        println!("steps: {passed} passed, {} failed", self.0.len() - passed);
    }
}

impl Step {
    fn outcome(&self) -> &'static str {
        if self.passed { "done" } else { "FAILED" }
    }
}
