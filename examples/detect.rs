//! Asks whether a suspect carries a mark: `cargo run --example detect -- suspect.glb`.

use meshmark::{Key, Verdict, detect};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let input = std::env::args().nth(1).ok_or("say which model to check")?;
    let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
    let found = detect(&std::fs::read(input)?, &key, None)?;
    println!("{}", found.sentence);
    match (found.verdict, found.tag, found.reason) {
        (Verdict::Found, Some(tag), _) => println!("It says {tag}."),
        (_, _, Some(reason)) => println!("{reason}"),
        _ => {}
    }
    Ok(())
}
