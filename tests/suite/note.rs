//! Notes, from bytes to texts, alone and beside a mark.

use crate::portable_test;
use crate::support::fixtures::{gallery, key, marked};
use crate::support::gltf_builder::{Built, Packing};
use meshmark::internals::mesh::shapes;
use meshmark::internals::scene::to_glb;
use meshmark::{
    Error, Model, NoteEmbedding, NoteReading, Verdict, demo_model, embed_note, extract, measure,
    note_capacity, read_note,
};

fn noted(model: &[u8], text: &str) -> Result<NoteEmbedding, Error> {
    embed_note(model, text, &key(1))
}

fn read(model: &[u8], reader: u8) -> NoteReading {
    read_note(model, &key(reader)).unwrap()
}

#[portable_test]
fn note_is_read_by_its_key_and_no_other() {
    for text in ["A", "Grüße", "made in Niš", "© 2012 Ada Lovelace, London"] {
        let noted = noted(&demo_model(), text).unwrap();
        let report = &noted.report;
        assert_eq!(report.size.bits, 8 * text.len());
        assert_eq!(report.size.characters, text.chars().count());
        assert_eq!(report.capacity.characters, 29);
        assert!((5e-4..1e-3).contains(&report.rms_rel), "{report:?}");
        let found = read(&noted.model, 1);
        assert_eq!(found, report.read_back);
        assert_eq!(found.text.as_deref(), Some(text));
        assert_eq!(found.verdict, Verdict::Found);
        assert!(found.ln_p < -300.0 && found.agreement > 0.9, "{found:?}");
    }
    let noted = noted(&demo_model(), "A").unwrap();
    let other = read(&noted.model, 2);
    assert_eq!((other.verdict, other.text), (Verdict::None, None));
    assert_eq!(read(&demo_model(), 1).verdict, Verdict::None);
}

/// The order in which both keep all that they have: the note first.
#[portable_test]
fn note_stands_a_mark_on_top_and_leaves_it_alone() {
    let noted = noted(&demo_model(), "below the mark").unwrap();
    let [alone, both] =
        [&demo_model(), &noted.model].map(|model| marked(model, &key(1)).unwrap().model);
    let found = read(&both, 1);
    assert_eq!(found.text.as_deref(), Some("below the mark"));
    let [alone, both] = [alone, both].map(|model| {
        let evidence = measure(&model).unwrap();
        let mark = extract(&evidence, &key(1));
        assert_eq!(mark.verdict, Verdict::Found);
        mark
    });
    for (alone, both) in alone
        .details()
        .carriers
        .iter()
        .zip(&both.details().carriers)
    {
        assert!(both.ln_p < 0.7 * alone.ln_p, "{alone:?} {both:?}");
    }
}

#[portable_test]
fn note_fits_every_packing() {
    for packing in [Packing::Glb, Packing::DataUri, Packing::External] {
        let Built { bytes, files } = gallery(packing);
        let noted = embed_note(Model::new(&bytes).with_files(&files), "hello", &key(1)).unwrap();
        let external = usize::from(packing == Packing::External);
        assert_eq!(noted.files.len(), external);
        let found = read_note(Model::new(&noted.model).with_files(&noted.files), &key(1)).unwrap();
        assert_eq!(found.text.as_deref(), Some("hello"), "{packing:?}");
        let room = note_capacity(Model::new(&bytes).with_files(&files)).unwrap();
        assert_eq!(room, noted.report.capacity);
    }
}

#[portable_test]
fn note_that_does_not_fit_is_refused() {
    let code = |model: &[u8], text: &str| noted(model, text).unwrap_err().code();
    let small = to_glb(&shapes::asteroid(40, 60));
    assert_eq!(
        code(&small, "123456"),
        "text.too-long",
        "2 402 vertices hold 5 bytes"
    );
    assert_eq!(code(&small, ""), "text.empty");
    assert_eq!(code(&demo_model(), &"x".repeat(30)), "text.too-long");
    let smaller = to_glb(&shapes::asteroid(20, 30));
    assert_eq!(code(&smaller, "1"), "carrier.too-few-hosts");
    assert_eq!(read(&smaller, 1).verdict, Verdict::CannotCheck);
}

/// No key reads a note in a model that was made without it.
#[portable_test]
fn wrong_keys_read_no_notes() {
    let noted = noted(&demo_model(), "mine").unwrap();
    for stranger in 2..8 {
        let reading = read(&noted.model, stranger);
        assert_eq!((reading.verdict, reading.ln_p), (Verdict::None, 0.0));
    }
}
