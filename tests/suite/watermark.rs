//! The pipelines, from bytes to verdicts.

use crate::portable_test;
use crate::support::fixtures::{asteroid, gallery, key, marked, payload};
use crate::support::gltf_builder::{Built, Packing};
use glam::DVec3;
use meshmark::internals::attack::{crop, noise, simplify};
use meshmark::internals::carrier::{Measurement, ring};
use meshmark::internals::detection::LN_P_FOUND;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    Carrier, EmbedOptions, Embedding, Evidence, Extraction, Files, Holds, Model, Payload, Stage,
    Strength, Verdict, capacity, demo_model, embed, extract, inspect, measure, verify,
};
use std::ops::ControlFlow;

fn measured(model: &[u8]) -> Evidence {
    measure(model).unwrap()
}

fn read(model: &[u8], reader: u8) -> Extraction {
    extract(&measured(model), &key(reader))
}

fn strong() -> EmbedOptions {
    EmbedOptions::default().with_strength(Strength::STRONG)
}

#[portable_test]
fn watermark_is_found_by_its_key_and_no_other() {
    let marked = marked(&demo_model(), &key(1)).unwrap();
    let found = read(&marked.model, 1);
    assert_eq!(
        (found.verdict, found.tag.as_deref()),
        (Verdict::Found, Some("ADA-1"))
    );
    assert_eq!(found.number, Some(payload().number()));
    let details = found.details();
    assert!(
        details.ln_p < -500.0 && details.agreement > 0.6,
        "{found:?}"
    );
    assert_eq!(
        details,
        marked.report.read_back.details(),
        "the report is what a detector says"
    );
    let other = read(&marked.model, 2);
    assert_eq!(
        (other.verdict, other.tag, other.number),
        (Verdict::None, None, None)
    );
    assert!(other.sentence.contains("does not prove"));
}

#[portable_test]
fn watermark_is_not_in_the_unmarked_model() {
    assert_eq!(read(&demo_model(), 1).verdict, Verdict::None);
}

#[portable_test]
fn watermark_report_is_true() {
    let host = demo_model();
    let marked = marked(&host, &key(1)).unwrap();
    let report = &marked.report;
    assert_eq!(report.vertices, 12_002);
    assert!(report.moved_vertices > 6_000 && report.moved_vertices <= 12_002);
    assert!(
        report.rms_rel > 0.0 && report.rms_rel <= 0.0004 * (1.0 + 1e-6) && report.max_rel <= 0.0018
    );
    assert!((report.diagonal - 3.6).abs() < 0.3, "{}", report.diagonal);
    assert_ne!(report.host_sha256, report.marked_sha256);
    assert_eq!(report.host_sha256, inspect(&host).unwrap().sha256);
    assert_eq!(report.marked_sha256, inspect(&marked.model).unwrap().sha256);
}

#[portable_test]
fn watermark_marks_every_kind_of_document() {
    for packing in [Packing::Glb, Packing::DataUri, Packing::External] {
        let Built { bytes, files } = gallery(packing);
        let marked = embed(
            Model::new(&bytes).with_files(&files),
            payload(),
            &key(1),
            &strong(),
        )
        .unwrap();
        assert_eq!(
            marked.files.len(),
            usize::from(packing == Packing::External)
        );
        let found = extract(
            &measure(Model::new(&marked.model).with_files(&marked.files)).unwrap(),
            &key(1),
        );
        assert_eq!(
            (found.verdict, found.tag.as_deref()),
            (Verdict::Found, Some("ADA-1")),
            "{packing:?}"
        );
    }
}

#[portable_test]
fn watermark_of_another_owner_leaves_the_first() {
    let first = marked(&demo_model(), &key(1)).unwrap();
    let options = EmbedOptions::default();
    let other = Payload::from_tag("BOB").unwrap();
    let second = embed(&first.model, other, &key(2), &options).unwrap();
    let third = embed(&second.model, other, &key(3), &options).unwrap();
    let evidence = measured(&third.model);
    for (reader, tag) in [(1, "ADA-1"), (2, "BOB"), (3, "BOB")] {
        let found = extract(&evidence, &key(reader));
        assert_eq!(
            (found.verdict, found.tag.as_deref()),
            (Verdict::Found, Some(tag)),
            "{found:?}"
        );
    }
}

#[portable_test]
fn verify_finds_the_expected_payload_and_names_another() {
    let evidence = measured(&marked(&demo_model(), &key(1)).unwrap().model);
    let found = verify(&evidence, &key(1), payload());
    assert_eq!(
        (found.verdict, found.number),
        (Verdict::Found, Some(payload().number()))
    );
    assert!(
        found.details().ln_p < extract(&evidence, &key(1)).details().ln_p,
        "a payload that is known need not be guessed"
    );
    let other = verify(&evidence, &key(1), Payload::from_tag("ADA-2").unwrap());
    assert_eq!((other.verdict, other.number), (Verdict::Partial, None));
    assert!(other.reason.unwrap().contains("ADA-1"));
    assert_eq!(verify(&evidence, &key(2), payload()).verdict, Verdict::None);
}

/// A small mesh: few enough symbols that decoding may fail, and neighbours in payload must not pass.
#[portable_test]
fn verify_never_takes_one_payload_for_another() {
    let host = to_glb(&shapes::asteroid(20, 26));
    let model = embed(&host, payload(), &key(1), &strong()).unwrap().model;
    let evidence = measured(&model);
    for flip in (0..Payload::BITS).step_by(6) {
        let neighbour = Payload::from_number(payload().number() ^ 1 << flip).unwrap();
        assert_ne!(
            verify(&evidence, &key(1), neighbour).verdict,
            Verdict::Found,
            "bit {flip}"
        );
    }
}

/// Noise that leaves of these marks between all and nothing.
const NOISES: [f64; 3] = [0.0012, 0.0014, 0.0016];

/// A damaged mark, of which nothing is decoded any more: a neighbour in number shares two thirds of the symbols, and its bound alone
/// would do.
#[portable_test]
fn verify_names_no_neighbour_of_a_damaged_mark() {
    let host = simplify(&shapes::asteroid(70, 100), 0.5);
    let options = EmbedOptions::default().with_carriers([Carrier::Ring]);
    let number = 1_000_005;
    let payload = Payload::from_number(number).unwrap();
    let model = embed(&to_glb(&host), payload, &key(1), &options);
    let document = model.unwrap().model;
    let marked = Scene::gather(&Document::read(&document, &Files::new()).unwrap()).unwrap();
    let [mut num_right, mut num_undecoded] = [0, 0];
    for (seed, amplitude) in (0..8).flat_map(|seed| NOISES.map(|amplitude| (seed, amplitude))) {
        let damaged = noise(&crop(&marked.mesh, 0.6, seed), amplitude, seed);
        let evidence = Evidence::from_iter([Measurement::Ring(ring::Measurement::new(&damaged))]);
        let is_found = |number| {
            let payload = Payload::from_number(number).unwrap();
            verify(&evidence, &key(1), payload).verdict == Verdict::Found
        };
        num_right += u32::from(is_found(number));
        num_undecoded += u32::from(extract(&evidence, &key(1)).number.is_none());
        for neighbour in [-5, -4, -1, 1, 2, 3, 4, 9].map(|step| number.wrapping_add_signed(step)) {
            assert!(!is_found(neighbour), "{neighbour}, seed {seed}");
        }
    }
    assert!(
        num_right > 0 && num_undecoded > 0,
        "{num_right} found, {num_undecoded} not decoded"
    );
}

#[portable_test]
fn verdict_is_cannot_check_where_there_is_too_little() {
    let tiny = to_glb(&Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
        triangles: vec![[0, 1, 2]],
    });
    let answer = read(&tiny, 1);
    assert_eq!(answer.verdict, Verdict::CannotCheck);
    assert!(answer.reason.unwrap().contains("too few"));
    let error = marked(&tiny, &key(1)).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-addresses");
}

#[portable_test]
fn embed_returns_nothing_that_it_cannot_read() {
    let host = to_glb(&shapes::icosphere(2));
    let error = marked(&host, &key(1)).unwrap_err();
    assert_eq!(error.code(), "watermark.unreadable");
    let message = error.to_string();
    assert!(message.contains("alike from several sides"), "{message}");
    let tried = "no carrier and no strength up to strong helps";
    assert!(message.ends_with(tried), "{message}");
}

/// Advice was tried: a strength that is too small for any mark, where the strong one is not.
#[portable_test]
fn refused_models_are_told_what_helps() {
    let options = EmbedOptions::default().with_strength(Strength::new(1e-5).unwrap());
    let host = to_glb(&shapes::asteroid(18, 24));
    let error = embed(&host, payload(), &key(1), &options).unwrap_err();
    assert_eq!(error.code(), "carrier.too-weak");
    let message = error.to_string();
    assert!(
        message.ends_with("at the strong strength it can be marked"),
        "{message}"
    );
}

/// A model that cannot hold a payload holds a mark that says whose it is.
#[portable_test]
fn small_models_hold_a_mark_without_a_payload() {
    let host = to_glb(&shapes::asteroid(7, 12));
    let Embedding { model, report, .. } = marked(&host, &key(1)).unwrap();
    assert_eq!((report.number, report.tag), (None, None));
    assert!(report.warnings[0].contains("too small to hold a payload"));
    assert_eq!(report.read_back.verdict, Verdict::Present);
    let found = read(&model, 1);
    assert_eq!((found.verdict, found.number), (Verdict::Present, None));
    assert!(found.details().ln_p <= LN_P_FOUND);
    assert_ne!(read(&model, 2).verdict, Verdict::Present);
    let tested = verify(&measure(&model).unwrap(), &key(1), payload());
    assert_eq!((tested.verdict, tested.number), (Verdict::Present, None));
    // The smaller steps of the strong strength hold more.
    let capacity = capacity(&host).unwrap();
    assert_eq!(
        (capacity.holds, capacity.strength),
        (Holds::Payload, Some("strong"))
    );
}

/// A place on the globe in metres: 32-bit numbers there are 1 m apart.
#[portable_test]
fn embed_says_that_numbers_are_too_coarse() {
    let mut mesh = asteroid();
    for position in &mut mesh.positions {
        *position = *position * 2.0 + DVec3::new(1e7, 2e7, 0.0);
    }
    let error = marked(&to_glb(&mesh), &key(1)).err().unwrap();
    assert_eq!(error.code(), "scene.coarse-numbers");
    assert!(error.to_string().contains("origin"), "{error}");
}

#[portable_test]
fn embed_says_at_once_that_nothing_can_move() {
    let mut stages = Vec::new();
    let mut watch = |stage: Stage, _: f64| {
        stages.push(stage);
        ControlFlow::Continue(())
    };
    let (json, files) = {
        let Built { bytes, files } = gallery(Packing::External);
        let json = String::from_utf8(bytes).unwrap();
        (
            json.replace(r#""POSITION":"#, r#""_COPY":0,"POSITION":"#),
            files,
        )
    };
    let copies: Vec<&str> = json.split(r#""_COPY":0,"POSITION":"#).skip(1).collect();
    let mut aliased = json
        .split(r#""_COPY":0,"POSITION":"#)
        .next()
        .unwrap()
        .to_owned();
    for rest in copies {
        let accessor: String = rest.chars().take_while(char::is_ascii_digit).collect();
        aliased.push_str(&format!(r#""_COPY":{accessor},"POSITION":{rest}"#));
    }
    let model = Model::new(aliased.as_bytes())
        .with_files(&files)
        .with_progress(&mut watch);
    let error = embed(model, payload(), &key(1), &strong()).err().unwrap();
    assert_eq!(error.code(), "scene.nothing-movable");
    assert!(stages.iter().all(|&stage| stage == Stage::Read));
}

#[portable_test]
fn embed_stops_when_asked_at_any_stage() {
    let model = to_glb(&asteroid());
    let mut stages = Vec::new();
    let mut listen = |stage: Stage, fraction: f64| {
        assert!((0.0..=1.0).contains(&fraction));
        stages.push(stage);
        ControlFlow::Continue(())
    };
    embed(
        Model::new(&model).with_progress(&mut listen),
        payload(),
        &key(1),
        &EmbedOptions::default(),
    )
    .unwrap();
    let mut order = stages.clone();
    order.dedup();
    assert_eq!(
        order,
        [
            Stage::Read,
            Stage::Embed,
            Stage::Write,
            Stage::Read,
            Stage::Measure,
            Stage::Test,
            Stage::Forecast
        ]
    );
    // At the first and the last report of each stage, and between.
    let is_end = |stop: &usize| {
        let before = stop.checked_sub(1).map(|before| stages[before]);
        before != Some(stages[*stop]) || stages.get(stop + 1) != Some(&stages[*stop])
    };
    for stop in (0..stages.len()).filter(|stop| is_end(stop) || stop % 9 == 0) {
        let mut left = stop;
        let mut listen = |_: Stage, _: f64| match left.checked_sub(1) {
            Some(fewer) => {
                left = fewer;
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        };
        let error = embed(
            Model::new(&model).with_progress(&mut listen),
            payload(),
            &key(1),
            &EmbedOptions::default(),
        );
        assert_eq!(error.unwrap_err().code(), "aborted", "at report {stop}");
    }
}

#[portable_test]
fn options_out_of_range_are_refused() {
    for text in ["0", "-1", "0.02", "NaN", "loud", ""] {
        assert_eq!(
            text.parse::<Strength>().unwrap_err().code(),
            "options.strength",
            "{text:?}"
        );
    }
    assert_eq!("strong".parse::<Strength>().unwrap().rms_rel(), 0.0008);
    assert_eq!("0.0005".parse::<Strength>().unwrap().rms_rel(), 0.0005);
    let options = EmbedOptions::default().with_carriers([]);
    let error = embed(&demo_model(), payload(), &key(1), &options).unwrap_err();
    assert_eq!(error.code(), "options.no-carrier");
    for most in [0.0, -1.0, f64::NAN] {
        let options = EmbedOptions::default().with_max_movement(most);
        let error = embed(&demo_model(), payload(), &key(1), &options).unwrap_err();
        assert_eq!(error.code(), "options.max-movement", "{most}");
    }
    assert_eq!(Carrier::from_name("ring"), Some(Carrier::Ring));
    assert_eq!(Carrier::from_name("rings"), None);
}

/// Wrong keys against evidence of a marked and of an unmarked model: the tail of ln p inside its bound, none convicted.
#[portable_test]
fn wrong_keys_find_nothing() {
    let host = to_glb(&shapes::asteroid(24, 36));
    let marked = marked(&host, &key(255)).unwrap().model;
    let values: Vec<f64> = [&host, &marked]
        .into_iter()
        .map(|model| measured(model))
        .flat_map(|evidence| (0..25).map(move |wrong| extract(&evidence, &key(wrong))))
        .map(|answer| {
            assert!(
                matches!(answer.verdict, Verdict::None | Verdict::CannotCheck),
                "{answer:?}"
            );
            answer.details().ln_p
        })
        .collect();
    for threshold in [1.0, 2.0, 3.0] {
        let seen = values.iter().filter(|&&ln_p| ln_p <= -threshold).count() as f64;
        let allowed = values.len() as f64 * libm::exp(-threshold);
        assert!(
            seen <= allowed + 4.0 * allowed.sqrt(),
            "ln p <= -{threshold}: {seen} against {allowed}"
        );
    }
}

#[portable_test]
fn inspect_describes_the_scene() {
    let Built { bytes, files } = gallery(Packing::External);
    let inspection = inspect(Model::new(&bytes).with_files(&files)).unwrap();
    assert_eq!(
        (inspection.container, inspection.meshes, inspection.nodes),
        ("gltf", 5, 7)
    );
    assert_eq!((inspection.components, inspection.primitives), (5, 5));
    assert_eq!(
        (inspection.boundary_edges, inspection.non_manifold_edges),
        (80, 0)
    );
    assert_eq!(inspection.extensions_used, ["KHR_mesh_quantization"]);
    assert_eq!(inspection.bytes, bytes.len());
}
