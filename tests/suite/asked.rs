//! LOCAL where it is asked for, by the public functions.

use crate::support::fixtures::{key, payload};
use meshmark::internals::attack::{crop, similarity, simplify};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    Carrier, EmbedOptions, Embedding, Extraction, Files, Strength, Verdict, detect,
    detect_with_local, prepare,
};

/// A model that all carriers mark.
fn marked_model(mesh: &Mesh, owner: u8) -> Embedding {
    let options = EmbedOptions::default()
        .with_strength(Strength::STRONG)
        .with_carriers(Carrier::ALL);
    meshmark::embed(&to_glb(mesh), payload(), &key(owner), &options).unwrap()
}

fn mesh_of(model: &[u8]) -> Mesh {
    let document = Document::read(model, &Files::new()).unwrap();
    Scene::gather(&document).unwrap().mesh
}

fn ln_p_of(read: &Extraction, carrier: Carrier) -> Option<f64> {
    let mut carriers = read.details().carriers.iter();
    carriers.find(|own| own.name == carrier).map(|own| own.ln_p)
}

/// What a person does: mark, lose a copy, and find half of it simplified. With every commit the command line's tests do the same.
#[test]
#[ignore = "takes a minute: cargo xtask test --all"]
fn local_finds_a_piece_by_the_public_functions() {
    let marked = marked_model(&shapes::cad_part(), 1);
    let report = &marked.report;
    assert_eq!(report.read_back.verdict, Verdict::Found);
    assert!(report.rms_rel <= 0.00081, "{}", report.rms_rel);
    assert!(report.worst_part_rel <= 0.02 && report.worst_turn_degrees <= 20.0);
    assert!(ln_p_of(&report.read_back, Carrier::Local).unwrap() < -45.0);
    assert!(ln_p_of(&report.read_back, Carrier::Solid).unwrap() < -60.0);

    let piece = simplify(&crop(&mesh_of(&marked.model), 0.5, 3), 0.5);
    let suspect = to_glb(&similarity(&piece, 3));
    let plain = detect(&suspect, &key(1), None).unwrap();
    assert!(ln_p_of(&plain, Carrier::Local).is_none());
    assert_eq!(plain.verdict, Verdict::None);
    for expected in [None, Some(payload())] {
        let found = detect_with_local(&suspect, &key(1), expected).unwrap();
        assert_eq!((found.verdict, found.number), (Verdict::Present, None));
        assert!(found.reason.unwrap().contains("Found by LOCAL"));
    }
    let read = detect_with_local(&suspect, &key(2), None).unwrap();
    assert_eq!(read.verdict, Verdict::None);
}

/// Carriers are as before where LOCAL is not asked for: the golden marks hold the bytes.
#[test]
fn local_is_used_where_it_is_asked_for() {
    assert_eq!(EmbedOptions::default().carriers, Carrier::STANDARD);
    let options = |carriers: &[Carrier]| EmbedOptions::default().with_carriers(carriers.to_vec());
    let rock = to_glb(&shapes::asteroid(40, 60));
    let with =
        |carriers: &[Carrier]| meshmark::embed(&rock, payload(), &key(1), &options(carriers));
    // It has no places: nothing is taken from the others, and the report says so.
    let [all, standard] = [&Carrier::ALL[..], &Carrier::STANDARD].map(|it| with(it).unwrap());
    assert!(all.model == standard.model);
    let mut warnings = all.report.warnings.iter();
    assert!(warnings.any(|warning| warning.contains("LOCAL was left out")));
    assert!(standard.report.warnings.is_empty());

    for carriers in [&[Carrier::Local][..], &[Carrier::Ring, Carrier::Local]] {
        assert_eq!(with(carriers).unwrap_err().code(), "options.no-solid");
    }
    let refused = prepare(&rock, &key(1), &options(&Carrier::ALL)).map(|_| ());
    assert_eq!(refused.unwrap_err().code(), "options.not-in-copies");
}
