//! `meshmark copies`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{Opened, open, store};
use crate::ledger::{self, Buyer, Entry};
use crate::output::Output;
use crate::owner::Owner;
use crate::report::Report;
use clap::Args;
use meshmark::{EmbedOptions, Plan, StampReport, Strength, prepare};
use serde::Serialize;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Make a copy of a model for each buyer, and the ledger that says whose is which
#[derive(Args)]
pub struct Copies {
    /// The model: .glb, .vrm, .b3dm, or .gltf with its buffers beside it; or one of them as .gz
    input: PathBuf,
    /// The buyers: CSV with a line of headings (number, name; one of them will do), or JSON
    #[arg(long, value_name = "FILE")]
    ledger: PathBuf,
    /// Folder for the copies, ledger.csv and ledger.json; it must have no ledger yet
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// The number of the first buyer, where the list has none. Numbers must not be given twice under one key
    #[arg(long, default_value_t = 1)]
    first: u64,
    /// What the ledger says as its date, in your words
    #[arg(long, default_value = "")]
    date: String,
    /// Keep the plan here, for `stamp` in the library. It holds the key: as secret as that
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    #[command(flatten)]
    owner: Owner,
    /// subtle, balanced, strong, or a fraction of the diagonal
    #[arg(long, default_value = "balanced")]
    strength: Strength,
}

/// What is told of all copies.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Made {
    copies: Vec<Copy>,
    /// How many hold less than the specimen that was forecasted.
    num_weaker: usize,
    /// What the mark of a copy is likely to survive: of the plan's specimen.
    specimen: meshmark::EmbedReport,
}

#[derive(Serialize)]
struct Copy {
    name: String,
    file: String,
    #[serde(flatten)]
    report: StampReport,
}

impl Copies {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let buyers = ledger::read(&self.ledger, self.first)?;
        let ledgers = ["ledger.csv", "ledger.json"].map(|name| self.out.join(name));
        if let Some(there) = ledgers.iter().find(|path| path.exists()) {
            let words = format!(
                "{} is there already: a ledger is not written over",
                there.display()
            );
            return Err(Failure::Words(words));
        }
        let key = self.owner.key()?;
        let host = open(&self.input)?;
        let options = EmbedOptions::default().with_strength(self.strength);
        let (plan, specimen) = prepare(host.model(&mut clock), &key, &options)?;
        std::fs::create_dir_all(&self.out).map_err(|error| Failure::file(&self.out, error))?;
        if let Some(path) = &self.plan {
            store(path, &plan.to_bytes())?;
        }
        clock.start("stamp");
        let copies = self.stamp_all(&plan, &host, &buyers)?;
        let entry = |copy: &Copy| Entry {
            number: Some(copy.report.number),
            name: copy.name.clone(),
            file: copy.file.clone(),
            sha256: copy.report.marked_sha256.clone(),
            date: self.date.clone(),
            triangles: Some(copy.report.triangles as u64),
        };
        let entries: Vec<Entry> = copies.iter().map(entry).collect();
        let [csv, json] = &ledgers;
        store(csv, &ledger::to_csv(&entries)?)?;
        store(json, &serde_json::to_vec_pretty(&entries)?)?;
        let is_fragile = specimen.is_fragile;
        let made = Made {
            num_weaker: copies.iter().filter(|copy| copy.report.is_weaker).count(),
            copies,
            specimen,
        };
        Ok(Report::done(&made, clock)?.with_fragile(is_fragile))
    }

    /// All copies, on all cores, in the order of the list.
    fn stamp_all(
        &self,
        plan: &Plan,
        host: &Opened,
        buyers: &[Buyer],
    ) -> Result<Vec<Copy>, Failure> {
        let next = AtomicUsize::new(0);
        let made = Mutex::new(Vec::new());
        let work = || -> Result<(), Failure> {
            while let Some(buyer) = buyers.get(next.fetch_add(1, Ordering::Relaxed)) {
                let copy = self.stamp(plan, host, buyer);
                if copy.is_err() {
                    next.store(buyers.len(), Ordering::Relaxed);
                }
                let mut made = made.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                made.push(copy?);
            }
            Ok(())
        };
        let num_threads = thread::available_parallelism().map_or(1, NonZero::get);
        thread::scope(|scope| {
            let threads: Vec<_> = (0..num_threads).map(|_| scope.spawn(work)).collect();
            let mut ends = threads.into_iter().map(|thread| thread.join());
            ends.try_for_each(|end| end.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        })?;
        let mut made = made
            .into_inner()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        let place = |copy: &Copy| {
            let mut numbers = buyers.iter().map(|buyer| buyer.number);
            numbers.position(|number| number == copy.report.number)
        };
        made.sort_by_cached_key(place);
        Ok(made)
    }

    fn stamp(&self, plan: &Plan, host: &Opened, buyer: &Buyer) -> Result<Copy, Failure> {
        let mut copy = plan.stamp(buyer.number)?;
        let path = self.path(buyer.number);
        let stored = Output::to(path.clone()).store(&self.input, host, &copy.model, &copy.files)?;
        copy.report.marked_sha256.clone_from(&stored.sha256);
        let file = path.strip_prefix(&self.out).unwrap_or(&path);
        Ok(Copy {
            name: buyer.name.clone(),
            file: file.to_string_lossy().into_owned(),
            report: copy.report,
        })
    }

    /// `model.7.glb`; a model with files beside it gets a folder of its own, `7/model.gltf`.
    fn path(&self, number: u64) -> PathBuf {
        let name = self.input.file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        match name.split_once('.') {
            Some((_, rest)) if rest.contains("gltf") => {
                self.out.join(number.to_string()).join(&*name)
            }
            Some((stem, rest)) => self.out.join(format!("{stem}.{number}.{rest}")),
            None => self.out.join(format!("{name}.{number}")),
        }
    }
}
