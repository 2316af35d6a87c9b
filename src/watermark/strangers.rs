//! Keys that marked nothing, on a suspect that lies on its original: what a comparison makes of them.
//!
//! How a suspect lies knows no key, so it is laid once. What is seen of windows knows where a key's lattice lies, and nothing else of the key; so each of
//! some lattices is read with what its points would hold under many keys. Each key is judged as in a comparison: in every way, payload and all.

use super::Error;
use super::compare::{Lyings, Rings, ln_num_searches, options_of_original, views_of, with_host};
use super::weigh::Scales;
use crate::carrier::{Frames, Known, Seen, Way};
use crate::document::Document;
use crate::geometry::{Original, Views};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::ignore;
use crate::scene::Scene;

/// The bound of each key, every choice charged: natural logarithms, in the order of `lattices` and their keys. Of each list, the first key says where the
/// lattice lies of all. Empty where the suspect lies nowhere on the original, a `.glb`: nothing is read then.
///
/// # Errors
/// Where the original cannot be read.
pub fn strangers(
    suspect: &Mesh,
    original: &[u8],
    lattices: &[Vec<Key>],
) -> Result<Vec<f64>, Error> {
    let scene = Scene::gather(&Document::read(original, &Default::default())?)?;
    with_host(&scene, &options_of_original(), |host| {
        let (original, views) = (Original::new(host.mesh), Views::new(host.mesh));
        let mut lyings: Vec<_> = Lyings::new(&original, &views, suspect).collect();
        lyings.retain(|lyings| !lyings.is_empty());
        let frames = Frames::new(host);
        let known = Known::new(host);
        let mut ln_ps = Vec::new();
        for keys in lattices.iter().filter(|_| !lyings.is_empty()) {
            let Some(place) = keys.first() else {
                continue;
            };
            let reader = frames.with_key(place);
            let mut scales: Vec<Scales> = keys.iter().map(Scales::new).collect();
            for lyings in &lyings {
                let observe: Vec<_> = lyings.iter().flat_map(views_of).collect();
                let seen: Vec<&Seen> = observe.iter().map(|observe| &**observe).collect();
                let rings = keys.iter();
                let rings: Vec<Rings> = rings
                    .map(|key| Rings::new(known.as_ref(), lyings, 0, key))
                    .collect();
                let mut hear = |number: usize, mut way: Way| {
                    way.ln_num_tests += ln_num_searches();
                    scales[number].hear(&way);
                };
                reader.read_as(&seen, keys, &mut ignore, &mut |number, mut way| {
                    way.ln_num_tests += Rings::LN_NUM_SHARES;
                    let beside = rings[number].beside(&way);
                    hear(number, way);
                    beside.into_iter().for_each(|way| hear(number, way));
                })?;
                for (number, rings) in rings.iter().enumerate() {
                    rings.alone().for_each(|way| hear(number, way));
                }
            }
            let concluded = scales.into_iter().map(Scales::conclude);
            ln_ps.extend(concluded.map(|said| said.ln_p_presence.min(said.ln_p_payload)));
        }
        Ok(ln_ps)
    })?
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::attack::{bend, crop, simplify};
    use crate::mesh::shapes;
    use crate::scene::to_glb;
    use crate::{EmbedOptions, Payload, Strength, embed};
    use std::f64::consts::LN_10;

    /// Lattices of each suspect, and keys of each; `cargo xtask lab --informed strong --wrong-keys 100000` tries more.
    const LATTICES: u64 = 2;
    const KEYS: u64 = 60;

    fn key(number: u64) -> Key {
        let mut bytes = [0x5e; Key::BYTES];
        bytes[..8].copy_from_slice(&number.to_le_bytes());
        Key::from_bytes(&bytes).unwrap()
    }

    #[test]
    fn informed_bound_holds_for_wrong_keys_on_what_lies_on_its_original() {
        let host = shapes::asteroid(24, 36);
        let original = to_glb(&host);
        let options = EmbedOptions::default().with_strength(Strength::STRONG);
        let payload = Payload::from_number(5).unwrap();
        let marked = embed(&original, payload, &key(0), &options).unwrap();
        let document = Document::read(&marked.model, &Default::default()).unwrap();
        let marked = Scene::gather(&document).unwrap().mesh;
        let suspects = [
            host,
            simplify(&crop(&marked, 0.4, 3), 0.3),
            bend(&marked, 30.0),
            marked,
        ];
        let mut ln_ps = Vec::new();
        for (suspect, first) in suspects
            .iter()
            .zip((1..).step_by((LATTICES * KEYS) as usize))
        {
            let keys = |lattice: u64| (0..KEYS).map(|k| key(first + lattice * KEYS + k)).collect();
            let lattices: Vec<Vec<Key>> = (0..LATTICES).map(keys).collect();
            let said = strangers(suspect, &original, &lattices).unwrap();
            assert_eq!(said.len() as u64, LATTICES * KEYS, "it lies nowhere");
            ln_ps.extend(said);
        }
        for decade in 1..=6 {
            let ln_p = -LN_10 * f64::from(decade);
            let below = ln_ps.iter().filter(|said| **said <= ln_p).count() as f64;
            let mean = ln_ps.len() as f64 * libm::exp(ln_p);
            assert!(
                below <= mean + 4.0 * mean.sqrt() + 3.0,
                "{below} below 10^-{decade}"
            );
        }
        assert!(ln_ps.iter().any(|ln_p| *ln_p < 0.0), "nothing was read");
    }
}
