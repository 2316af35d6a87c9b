//! One model, marked once: what every row of the grid starts from.

use crate::baseline;
use crate::models::{Class, Model, gathered};
use crate::seed::Seed;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{EmbedOptions, EmbedReport, Key, Payload, Strength, embed};
use std::sync::OnceLock;

/// Bits of the baseline's message: what its authors embed.
const BASELINE_BITS: u64 = 64;

pub struct Case<'a> {
    pub model: &'a Model,
    pub strength_name: &'static str,
    pub strength: Strength,
    /// Each copy has a key and a payload of its own, and its rows have attacks of their own.
    pub copy: u32,
    /// What everything random of this case is for.
    pub purpose: String,
    pub key: Key,
    pub payload: Payload,
    pub seed: &'a Seed,
    pub host: Mesh,
    pub marked: Result<Marked, String>,
    baseline: OnceLock<Option<(Mesh, Vec<bool>)>>,
}

pub struct Marked {
    /// The file.
    pub bytes: Vec<u8>,
    pub mesh: Mesh,
    pub report: EmbedReport,
}

impl<'a> Case<'a> {
    pub fn new(
        model: &'a Model,
        (strength_name, strength): (&'static str, Strength),
        copy: u32,
        seed: &'a Seed,
    ) -> Result<Case<'a>, String> {
        let purpose = format!("{}, {strength_name}, {copy}", model.name);
        let mut case = Case {
            key: seed.key(&purpose, 0),
            payload: seed.payload(&purpose),
            model,
            strength_name,
            strength,
            copy,
            seed,
            host: gathered(&model.bytes)?,
            marked: Err(String::new()),
            baseline: OnceLock::new(),
            purpose,
        };
        case.marked = case.mark(&model.bytes, &case.key, case.payload);
        Ok(case)
    }

    /// A copy of a model under any key, at this case's strength.
    fn mark(&self, model: &[u8], key: &Key, payload: Payload) -> Result<Marked, String> {
        let options = EmbedOptions::default().with_strength(self.strength);
        let embedding = embed(model, payload, key, &options).map_err(|error| error.to_string())?;
        Ok(Marked {
            mesh: gathered(&embedding.model)?,
            bytes: embedding.model,
            report: embedding.report,
        })
    }

    /// RMS displacement of this case's mark; its limit, where there is none.
    pub fn rms_rel(&self) -> f64 {
        self.marked
            .as_ref()
            .map_or(self.strength.rms_rel(), |marked| marked.report.rms_rel)
    }

    /// The host marked by somebody else; `number` says by whom.
    pub fn by_another(&self, number: u64) -> Result<Mesh, String> {
        let key = self.seed.key(&self.purpose, number);
        let payload = self.seed.payload(&format!("{}, {number}", self.purpose));
        Ok(self.mark(&self.model.bytes, &key, payload)?.mesh)
    }

    /// The host under the same key with another payload, as another buyer has it.
    pub fn of_buyer(&self, number: u64) -> Result<Mesh, String> {
        let payload = self
            .seed
            .payload(&format!("{}, buyer {number}", self.purpose));
        Ok(self.mark(&self.model.bytes, &self.key, payload)?.mesh)
    }

    /// A mesh marked again by somebody else.
    pub fn marked_again(&self, mesh: &Mesh, number: u64) -> Result<Mesh, String> {
        let key = self.seed.key(&self.purpose, number);
        let payload = self.seed.payload(&format!("{}, {number}", self.purpose));
        Ok(self.mark(&to_glb(mesh), &key, payload)?.mesh)
    }

    /// Plain models with the mark of Cho, Prost and Jung, which knows single surfaces only, of the same RMS displacement; and
    /// its message.
    pub fn baseline(&self) -> Option<&(Mesh, Vec<bool>)> {
        let embedded = || {
            if self.model.class != Class::Plain || self.marked.is_err() {
                return None;
            }
            let number = self.seed.number(&self.purpose, 2);
            let bits: Vec<bool> = (0..BASELINE_BITS)
                .map(|bit| number >> bit & 1 == 1)
                .collect();
            let (marked, _) = baseline::embed(&self.host, &bits, self.rms_rel());
            Some((marked, bits))
        };
        self.baseline.get_or_init(embedded).as_ref()
    }
}
