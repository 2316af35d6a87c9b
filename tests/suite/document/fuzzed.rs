//! Damaged files of every kind: they are refused or read, but never end in a panic.

use meshmark::internals::document::Document;
use proptest::prelude::*;
use proptest::sample::Index;

use super::cases;
use crate::support::gltf_builder::Built;

/// A damage to a run of bytes.
#[derive(Clone, Debug)]
enum Damage {
    Truncate(Index),
    Overwrite(Index, u8),
    Remove(Index, usize),
    /// Puts a number where there was one, in JSON text.
    Number(Index, String),
}

fn damage() -> impl Strategy<Value = Damage> {
    let number = prop_oneof![
        any::<u32>().prop_map(|number| number.to_string()),
        (0_u32..40).prop_map(|number| number.to_string()),
        Just("18446744073709551615".into()),
        Just("4294967296".into()),
        Just("-1".into()),
        Just("1e999".into()),
        Just("null".into()),
    ];
    prop_oneof![
        1 => any::<Index>().prop_map(Damage::Truncate),
        3 => (any::<Index>(), any::<u8>()).prop_map(|(place, byte)| Damage::Overwrite(place, byte)),
        1 => (any::<Index>(), 1_usize..9).prop_map(|(place, length)| Damage::Remove(place, length)),
        6 => (any::<Index>(), number).prop_map(|(place, number)| Damage::Number(place, number)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    if bytes.is_empty() {
        return;
    }
    match damage {
        Damage::Truncate(place) => bytes.truncate(place.index(bytes.len())),
        Damage::Overwrite(place, byte) => {
            let place = place.index(bytes.len());
            bytes[place] = *byte;
        }
        Damage::Remove(place, length) => {
            let start = place.index(bytes.len());
            bytes.drain(start..(start + length).min(bytes.len()));
        }
        Damage::Number(place, number) => {
            let place = place.index(bytes.len());
            let Some(start) = (place..bytes.len()).find(|&at| bytes[at].is_ascii_digit()) else {
                return;
            };
            let end = (start..bytes.len())
                .find(|&at| !bytes[at].is_ascii_digit())
                .unwrap_or(bytes.len());
            bytes.splice(start..end, number.bytes());
        }
    }
}

/// Does everything there is to do.
fn exercise(model: &Built) {
    let Ok(mut document) = Document::read(&model.bytes, &model.files) else {
        return;
    };
    let meshes = document.meshes().to_vec();
    for (mesh, content) in meshes.iter().enumerate() {
        for (part, primitive) in content.primitives.iter().enumerate() {
            let triangles = document.triangles(mesh, part);
            let Some(accessor) = primitive.position else {
                continue;
            };
            let Ok(mut positions) = document.positions(accessor) else {
                continue;
            };
            for corner in triangles.iter().flatten().flatten() {
                assert!((*corner as usize) < positions.len());
            }
            let fixed = document
                .fixed_elements(accessor)
                .expect("elements of readable positions");
            for (position, fixed) in positions.iter_mut().zip(fixed) {
                let is_somewhere = position.iter().all(|component| component.is_finite());
                if !fixed && is_somewhere {
                    *position = position.map(|component| component + 1.0);
                }
            }
            document
                .set_positions(accessor, &positions)
                .expect("movable positions");
        }
    }
    let written = document.write().expect("a written document");
    let mut files = model.files.clone();
    files.extend(written.files);
    let reread = Document::read(&written.model, &files).expect("what was written can be read");
    for accessor in meshes
        .iter()
        .flat_map(|mesh| &mesh.primitives)
        .filter_map(|primitive| primitive.position)
    {
        // By their bits: what is no number is no number's equal.
        let bits = |document: &Document| {
            let positions = document.positions(accessor).expect("positions");
            let numbers = positions.into_iter().flatten();
            numbers.map(f64::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(bits(&reread), bits(&document));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_do_no_harm(case in any::<Index>(), damages in proptest::collection::vec(damage(), 1..4)) {
        let cases = cases::all();
        let sound = cases[case.index(cases.len())].build();
        let mut model = sound.clone();
        damages.iter().for_each(|damage| apply(&mut model.bytes, damage));
        exercise(&model);
        model.bytes = sound.bytes;
        for bytes in model.files.values_mut() {
            damages.iter().for_each(|damage| apply(bytes, damage));
        }
        exercise(&model);
    }
}
