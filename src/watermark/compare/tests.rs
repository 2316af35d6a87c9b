#![allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
//! The bound, held against keys that marked nothing. How a suspect lies knows no key, so it is laid once; what is seen of windows knows where a
//! key's lattice lies alone, so each of some lattices is read with what the points of many keys hold.

use super::*;
use crate::attack::{bend, crop, simplify};
use crate::carrier::Way;
use crate::detection::ln_p_of_errors;
use crate::mesh::shapes;
use crate::scene::to_glb;
use crate::{Strength, embed};
use std::f64::consts::LN_10;

/// Lattices of each suspect, and keys of each lattice: with `cargo xtask test --all`, 10^5 keys.
const LATTICES: [u64; 2] = [2, 25];
const KEYS: [u64; 2] = [150, 1000];
/// One key in so many is read in every way and judged, payload and all, as a comparison is; the others in one way, which takes no time.
const JUDGED: usize = 25;
/// Powers of ten down to which tails are counted.
const DECADES: usize = 6;

fn key(number: u64) -> Key {
    let mut bytes = [0x5e; Key::BYTES];
    bytes[..8].copy_from_slice(&number.to_le_bytes());
    Key::from_bytes(&bytes).unwrap()
}

/// How many tests fell below each power of ten.
#[derive(Default)]
struct Tail {
    num: u64,
    below: [u64; DECADES],
}

impl Tail {
    fn count(&mut self, ln_p: f64) {
        self.num += 1;
        for (decade, below) in (1..).zip(&mut self.below) {
            *below += u64::from(ln_p <= -LN_10 * f64::from(decade));
        }
    }

    /// No more are below than the bound allows, and four deviations.
    fn hold(&self, name: &str) {
        eprintln!(
            "{name}: of {} below 10^-1, 10^-2 ..: {:?}",
            self.num, self.below
        );
        for (decade, below) in (1..).zip(self.below) {
            let mean = self.num as f64 * libm::pow(10.0, -f64::from(decade));
            let most = mean + 4.0 * mean.sqrt() + 3.0;
            assert!(below as f64 <= most, "{name}: {below} below 10^-{decade}");
        }
    }
}

#[test]
fn informed_bound_holds_for_wrong_keys_on_what_lies_on_its_original() {
    let all = usize::from(std::env::var_os("MESHMARK_ALL").is_some());
    let original = to_glb(&shapes::asteroid(24, 36));
    let scene = Scene::gather(&Document::read(&original, &Default::default()).unwrap()).unwrap();
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let marked = embed(
        &original,
        Payload::from_number(5).unwrap(),
        &key(0),
        &options,
    )
    .unwrap();
    let document = Document::read(&marked.model, &Default::default()).unwrap();
    let marked = Scene::gather(&document).unwrap().mesh;
    let suspects = [
        ("unmarked", scene.mesh.clone()),
        ("marked by another", marked.clone()),
        (
            "a piece of that, simplified",
            simplify(&crop(&marked, 0.4, 3), 0.3),
        ),
        ("that, posed", bend(&marked, 30.0)),
    ];
    let mut charged = Tail::default();
    let mut single = Tail::default();
    let mut num_keys = 1;
    for (name, suspect) in &suspects {
        let before = single.num;
        with_host(&scene, &options, |host| {
            let original = Original::new(host.mesh);
            let views = Views::new(host.mesh);
            let at = (&original, &views);
            let lyings: Vec<Lying> = match *name == "that, posed" {
                true => {
                    let starts = original.registrations(suspect, Search::Quick);
                    let assembly = original.assembled(suspect, &starts).unwrap();
                    assert!(assembly.num_parts > 1);
                    let parts = (&assembly.mesh, &Motion::IDENTITY);
                    Lying::new(at, parts, assembly.registration, 2)
                        .into_iter()
                        .collect()
                }
                false => {
                    let searches = Search::ALL.into_iter();
                    let all = searches.flat_map(|search| original.registrations(suspect, search));
                    let near = all.filter(|r| r.near >= LEAST_NEAR).take(2);
                    near.filter_map(|r| Lying::new(at, (suspect, &r.motion), r, 1))
                        .collect()
                }
            };
            assert!(!lyings.is_empty(), "{name}");
            let observe: Vec<_> = lyings.iter().flat_map(views_of).collect();
            let seen: Vec<&Seen> = observe.iter().map(|observe| &**observe).collect();
            let frames = Frames::new(host);
            for _ in 0..LATTICES[all] {
                let place = key(num_keys);
                let keys: Vec<Key> = (0..KEYS[all]).map(|k| key(num_keys + k)).collect();
                num_keys += KEYS[all];
                let mut scales: Vec<Scales> = keys.iter().map(Scales::new).collect();
                let mut is_heard = vec![false; keys.len()];
                let mut hear = |number: usize, mut way: Way| {
                    if !is_heard[number] {
                        let own = way.places.iter().map(|p| (p.response, p.errors[1]));
                        single.count(ln_p_of_errors(own));
                        is_heard[number] = true;
                    }
                    if number.is_multiple_of(JUDGED) {
                        way.ln_num_tests += ln_num_searches();
                        scales[number].hear(&way);
                    }
                };
                frames
                    .with_key(&place)
                    .read_as(&seen, &place, &keys, &mut hear)
                    .unwrap();
                for scales in scales.iter().step_by(JUDGED) {
                    charged.count(scales.ln_p_presence.min(scales.ln_p_payload));
                }
            }
        })
        .unwrap();
        eprintln!("{name}: {} keys", single.num - before);
    }
    charged.hold("judged");
    single.hold("one way, before charges");
}
