//! Tests a suspect with the keys of many owners, measuring it once: `cargo run --example many_keys -- suspect.glb`.

use meshmark::{Key, Verdict, extract_many, measure};

const OWNERS: [(&str, &str); 3] = [
    ("Ada", "correct horse battery staple"),
    ("Grace", "a nanosecond is a foot of wire"),
    ("Hedy", "eighty-eight frequencies"),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let input = std::env::args().nth(1).ok_or("say which model to check")?;
    let evidence = measure(&std::fs::read(input)?)?;
    let keys = OWNERS.map(|(owner, passphrase)| Key::from_passphrase(owner, passphrase));
    let keys = keys.into_iter().collect::<Result<Vec<Key>, _>>()?;
    // That there are three is charged: all of them together are wrong with a probability of 1e-9 at most.
    for ((owner, _), found) in OWNERS.iter().zip(extract_many(&evidence, &keys)) {
        match found.verdict {
            Verdict::Found => println!("{owner}: {}", found.tag.unwrap_or_default()),
            _ => println!("{owner}: -"),
        }
    }
    Ok(())
}
