//! Marks a model: `cargo run --example embed -- model.glb marked.glb`.

use meshmark::{EmbedOptions, Key, Model, Payload, Stage, Strength, embed};
use std::ops::ControlFlow;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [input, output] = arguments()?;
    let model = std::fs::read(input)?;
    let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
    let payload = Payload::from_tag("ADA-1")?;
    let options = EmbedOptions::default().with_strength(Strength::SUBTLE);
    let mut report = |stage: Stage, fraction: f64| {
        eprint!("\r{} {:.0} %   ", stage.name(), 100.0 * fraction);
        ControlFlow::Continue(()) // `Break` would end the work
    };
    let model = Model::new(&model).with_progress(&mut report);
    let marked = embed(model, payload, &key, &options)?;
    std::fs::write(output, &marked.model)?;
    eprintln!();
    println!(
        "moved by {:.4} % of the diagonal",
        100.0 * marked.report.rms_rel
    );
    for change in &marked.report.forecast {
        println!("{:12} {:?}", change.attack, change.level);
    }
    Ok(())
}

fn arguments() -> Result<[String; 2], &'static str> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    arguments
        .try_into()
        .map_err(|_| "say which model to mark, and where the marked one goes")
}
