//! The paper's multiple watermarking: a note and a mark in one model, and what each does to the other.

use super::note::{Read, read_note, text};
use crate::models::gathered;
use crate::seed::Seed;
use meshmark::internals::geometry::Distortion;
use meshmark::internals::paper::Smoothing;
use meshmark::internals::scene::to_glb;
use meshmark::{
    Carrier, EmbedOptions, Extraction, Files, Key, Model, Payload, Strength, embed, embed_note,
    extract, measure,
};

/// What is written, in this order.
#[derive(Clone, Copy, PartialEq)]
enum Write {
    Note,
    Mark,
}

pub const ORDERS: [&str; 4] = ["note", "mark", "note, then mark", "mark, then note"];

/// What is read from one copy.
pub struct Layer {
    /// One of [`ORDERS`].
    pub order: &'static str,
    /// Iterations of MeshSmooth.
    pub iterations: u32,
    pub read: Result<Layers, String>,
}

pub struct Layers {
    /// RMS displacement by all that was written, as a fraction of the diagonal.
    pub rms_rel: f64,
    pub note: Read,
    pub is_found: bool,
    pub ln_p: f64,
    pub ln_p_solid: f64,
    pub ln_p_ring: f64,
}

/// Each alone, and both in both orders; as they are, and after MeshSmooth 1.
pub fn layers(model: &[u8], name: &str, seed: &Seed) -> Vec<Layer> {
    let purpose = format!("{name}, layers");
    let trial = Trial {
        model,
        key: seed.key(&purpose, 0),
        payload: seed.payload(&purpose),
        text: text(seed, &purpose),
    };
    let writes: [&[Write]; 4] = [
        &[Write::Note],
        &[Write::Mark],
        &[Write::Note, Write::Mark],
        &[Write::Mark, Write::Note],
    ];
    let mut layers = Vec::new();
    for (order, writes) in ORDERS.into_iter().zip(writes) {
        let copy = trial.copy(writes);
        layers.extend([0, 1].map(|iterations| Layer {
            order,
            iterations,
            read: copy.clone().and_then(|copy| trial.read(&copy, iterations)),
        }));
    }
    layers
}

struct Trial<'a> {
    model: &'a [u8],
    key: Key,
    payload: Payload,
    text: String,
}

impl Trial<'_> {
    fn copy(&self, writes: &[Write]) -> Result<Vec<u8>, String> {
        let files = Files::new();
        let options = EmbedOptions::default().with_strength(Strength::STRONG);
        let write = |model: Vec<u8>, write: &Write| {
            let written = match write {
                Write::Note => {
                    embed_note(Model::new(&model).with_files(&files), &self.text, &self.key)
                        .map(|embedding| embedding.model)
                }
                Write::Mark => embed(
                    Model::new(&model).with_files(&files),
                    self.payload,
                    &self.key,
                    &options,
                )
                .map(|embedding| embedding.model),
            };
            written.map_err(|error| error.code().to_owned())
        };
        writes.iter().try_fold(self.model.to_vec(), write)
    }

    fn read(&self, copy: &[u8], iterations: u32) -> Result<Layers, String> {
        let (host, copy) = (gathered(self.model)?, gathered(copy)?);
        let suspect = to_glb(&Smoothing::MeshSmooth.apply(&copy, iterations));
        let evidence = measure(&suspect);
        let read = extract(&evidence.map_err(|error| error.to_string())?, &self.key);
        Ok(Layers {
            rms_rel: Distortion::between(&host.positions, &copy.positions).rms_rel,
            note: read_note(&suspect, &self.key, &self.text)?,
            is_found: read.number == Some(self.payload.number()),
            ln_p: read.details().ln_p,
            ln_p_solid: by(&read, Carrier::Solid),
            ln_p_ring: by(&read, Carrier::Ring),
        })
    }
}

fn by(read: &Extraction, name: Carrier) -> f64 {
    let reading = read
        .details()
        .carriers
        .iter()
        .find(|reading| reading.name == name);
    reading.map_or(0.0, |reading| reading.ln_p)
}
