//! How long each stage takes.

use meshmark::{Progress, Stage};
use serde_json::{Map, Value, json};
use std::io::{IsTerminal, Write, stderr};
use std::ops::ControlFlow;
use std::time::Instant;

/// Times the stages of the work, and shows them where somebody watches.
pub struct Clock {
    stages: Vec<(&'static str, f64)>,
    running: Option<(&'static str, Instant)>,
}

impl Clock {
    pub fn new() -> Clock {
        Clock {
            stages: Vec::new(),
            running: None,
        }
    }

    pub fn start(&mut self, stage: &'static str) {
        if self.running.is_none_or(|(running, _)| running != stage) {
            self.stop();
            self.running = Some((stage, Instant::now()));
        }
    }

    fn stop(&mut self) {
        if let Some((stage, since)) = self.running.take() {
            self.stages
                .push((stage, since.elapsed().as_secs_f64() * 1e3));
        }
    }

    /// Milliseconds by stage; a stage that ran twice counts both times.
    pub fn milliseconds(mut self) -> Value {
        self.stop();
        if stderr().is_terminal() {
            eprint!("\r\x1b[K");
        }
        let mut sums = Map::new();
        for (stage, ms) in self.stages {
            let sum = sums.get(stage).and_then(Value::as_f64).unwrap_or_default() + ms;
            sums.insert(stage.to_owned(), json!((sum * 1e3).round() / 1e3));
        }
        Value::Object(sums)
    }
}

impl Progress for Clock {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        self.start(stage.name());
        if stderr().is_terminal() {
            eprint!("\r\x1b[K{} {:.0} %", stage.name(), fraction * 100.0);
            let _ = stderr().flush();
        }
        ControlFlow::Continue(())
    }
}
