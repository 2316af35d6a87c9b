//! Makes a copy for each buyer: `cargo run --release --example copies -- model.glb 3` writes model.1.glb, model.2.glb and model.3.glb.

use meshmark::{EmbedOptions, Key, Verdict, detect, prepare};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(input), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("say which model to copy, and for how many buyers".into());
    };
    let model = std::fs::read(&input)?;
    let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
    let start = Instant::now();
    let (plan, report) = prepare(&model, &key, &EmbedOptions::default())?;
    println!("prepared in {} ms", start.elapsed().as_millis());
    for warning in report.warnings {
        println!("{warning}");
    }
    for number in 1..=count.parse()? {
        let start = Instant::now();
        let copy = plan.stamp(number)?;
        let report = &copy.report;
        println!(
            "copy {number} in {} ms: ln p {:.0}{}",
            start.elapsed().as_millis(),
            report.ln_p,
            if report.is_weaker { ", weaker" } else { "" }
        );
        let found = detect(&copy.model, &key, None)?;
        assert_eq!(found.verdict, Verdict::Found);
        assert_eq!(found.number, Some(report.payload));
        let name = input.trim_end_matches(".glb");
        std::fs::write(format!("{name}.{number}.glb"), &copy.model)?;
    }
    Ok(())
}
