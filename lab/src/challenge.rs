//! A challenge to outsiders: generated models, marked with a key that nobody is told, and the list that is published with them.

use crate::models::{Model, Size};
use getrandom::fill;
use meshmark::{EmbedOptions, Key, Payload, Strength, embed};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::Path;

const STRENGTHS: [(&str, Strength); 2] = [
    ("balanced", Strength::BALANCED),
    ("strong", Strength::STRONG),
];

/// Where the key is kept, which is not to be published.
const KEY: &str = "SECRET-key";

/// Writes the models and the key into a new folder; returns the list. The system draws key and payloads.
pub fn write(models: Vec<Model>, folder: &Path) -> Result<String, String> {
    let said = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir(folder).map_err(said)?;
    let mut bytes = [0; Key::BYTES];
    fill(&mut bytes).map_err(|error| error.to_string())?;
    let key = Key::from_bytes(&bytes).map_err(|error| error.to_string())?;
    std::fs::write(folder.join(KEY), bytes).map_err(said)?;
    let mut list = format!(
        "Key commitment: `{}`. The key is in {KEY}: do not publish it.\n\n\
         | file | strength | SHA-256 |\n|---|---|---|\n",
        key.commitment()
    );
    for model in models.iter().filter(|model| model.size <= Size::Usual) {
        let host = format!("{}-host.glb", model.name.replace(' ', "-"));
        std::fs::write(folder.join(host), &model.bytes).map_err(said)?;
        for (name, strength) in STRENGTHS {
            let number =
                getrandom::u64().map_err(|error| error.to_string())? >> (64 - Payload::BITS);
            let payload = Payload::from_number(number).map_err(|error| error.to_string())?;
            let options = EmbedOptions::default().with_strength(strength);
            let Ok(marked) = embed(&*model.bytes, payload, &key, &options) else {
                continue; // no challenge where nothing is claimed
            };
            let file = format!("{}-{name}.glb", model.name.replace(' ', "-"));
            std::fs::write(folder.join(&file), &marked.model).map_err(said)?;
            let digest = Sha256::digest(&marked.model);
            let digest: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            let _ = writeln!(list, "| {file} | {name} | {digest} |");
        }
    }
    std::fs::write(folder.join("LIST.md"), &list).map_err(said)?;
    Ok(list)
}
