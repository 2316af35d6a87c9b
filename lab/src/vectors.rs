//! The whole mark of docs/VECTORS.md as files.

use meshmark::internals::mesh::shapes;
use meshmark::internals::scene::to_glb;
use meshmark::{EmbedOptions, Key, Payload, Strength, embed};
use std::path::Path;

/// Writes host and marked model into a new folder.
pub fn write(folder: &Path) -> Result<String, String> {
    let host = to_glb(&shapes::asteroid(30, 40));
    let key = Key::from_bytes(&[1; Key::BYTES]).map_err(|error| error.to_string())?;
    let tag = Payload::from_tag("ADA-1").map_err(|error| error.to_string())?;
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let marked = embed(&host, tag, &key, &options).map_err(|error| error.to_string())?;
    let said = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir(folder).map_err(said)?;
    std::fs::write(folder.join("host.glb"), &host).map_err(said)?;
    std::fs::write(folder.join("marked.glb"), &marked.model).map_err(said)?;
    Ok("host.glb and marked.glb are those of docs/VECTORS.md.\n".to_owned())
}
