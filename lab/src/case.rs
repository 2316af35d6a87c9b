//! One model, marked once: what every row of the grid starts from.

use crate::models::Model;
use crate::seed::Seed;
use meshmark::document::Document;
use meshmark::mesh::Mesh;
use meshmark::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, EmbedReport, Files, Key, Payload, Strength, embed, ignore};

pub struct Case<'a> {
    pub model: &'a Model,
    pub strength: Strength,
    /// What everything random of this case is for.
    pub purpose: String,
    pub key: Key,
    pub payload: Payload,
    pub seed: &'a Seed,
    pub host: Mesh,
    pub marked: Result<Marked, String>,
}

pub struct Marked {
    pub mesh: Mesh,
    pub report: EmbedReport,
}

impl<'a> Case<'a> {
    pub fn new(
        model: &'a Model,
        (name, strength): (&str, Strength),
        seed: &'a Seed,
    ) -> Result<Case<'a>, String> {
        let purpose = format!("{}, {name}", model.name);
        let mut case = Case {
            key: seed.key(&purpose, 0),
            payload: seed.payload(&purpose),
            model,
            strength,
            seed,
            host: gathered(&model.bytes)?,
            marked: Err(String::new()),
            purpose,
        };
        case.marked = case.mark(&model.bytes, &case.key, case.payload);
        Ok(case)
    }

    /// A copy of a model under any key, at this case's strength.
    fn mark(&self, model: &[u8], key: &Key, payload: Payload) -> Result<Marked, String> {
        let options = EmbedOptions {
            strength: self.strength,
            ..EmbedOptions::default()
        };
        let embedding = embed(model, &Files::new(), payload, key, &options, &mut ignore)
            .map_err(|error| error.to_string())?;
        Ok(Marked {
            mesh: gathered(&embedding.model)?,
            report: embedding.report,
        })
    }

    /// The host marked by somebody else; `number` says by whom.
    pub fn by_another(&self, number: u64) -> Result<Mesh, String> {
        let key = self.seed.key(&self.purpose, number);
        let payload = self.seed.payload(&format!("{}, {number}", self.purpose));
        Ok(self.mark(&self.model.bytes, &key, payload)?.mesh)
    }

    /// The host under the same key with another payload.
    pub fn with_another_payload(&self) -> Result<Mesh, String> {
        let payload = self.seed.payload(&format!("{}, other", self.purpose));
        Ok(self.mark(&self.model.bytes, &self.key, payload)?.mesh)
    }

    /// A mesh marked again by somebody else.
    pub fn marked_again(&self, mesh: &Mesh, number: u64) -> Result<Mesh, String> {
        let key = self.seed.key(&self.purpose, number);
        let payload = self.seed.payload(&format!("{}, {number}", self.purpose));
        Ok(self.mark(&to_glb(mesh), &key, payload)?.mesh)
    }
}

/// The mesh of a `.glb`, as it is seen by whoever checks it.
pub fn gathered(bytes: &[u8]) -> Result<Mesh, String> {
    let document = Document::read(bytes, &Files::new()).map_err(|error| error.to_string())?;
    let scene = Scene::gather(&document).map_err(|error| error.to_string())?;
    Ok(scene.mesh)
}
