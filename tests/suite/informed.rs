//! Reading with the original, and with the record of an embedding.

use crate::portable_test;
use crate::support::fixtures::{asteroid, key, marked, payload};
use glam::{DMat3, DVec3};
use meshmark::internals::attack::{bend, crop, delaunay, quantize, remesh, similarity, simplify};
use meshmark::internals::carrier::{Frames, Host, Seen};
use meshmark::internals::code::{Codeword, Symbol};
use meshmark::internals::detection::{ln_p_of_errors, union};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::{
    Bounds, Leeway, Original, Parts, Registration, Search, Shown, Views,
};
use meshmark::internals::mesh::{Admissible, Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    Carrier, Comparison, EmbedOptions, Embedding, Payload, RecordOptions, Shape, Verdict, Witness,
    compare, compare_overlaid, compare_with_record, detect, embed, record, verify_with_original,
    verify_with_record,
};

/// An original, its marked copy, and the copy's mesh.
fn case() -> (Vec<u8>, Embedding, Mesh) {
    let original = to_glb(&asteroid());
    let marked = marked(&original, &key(1)).unwrap();
    let mesh = mesh_of(&marked.model);
    (original, marked, mesh)
}

fn mesh_of(model: &[u8]) -> Mesh {
    let document = Document::read(model, &Default::default()).unwrap();
    Scene::gather(&document).unwrap().mesh
}

fn mirrored(mesh: &Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| DVec3::new(-p.x, p.y, p.z));
    let mut mirrored = mesh.with_positions(turned.collect());
    mirrored.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mirrored
}

fn assert_found(answer: &Comparison, what: &str) {
    assert_eq!(answer.verdict, Verdict::Found, "{what}: {answer:?}");
    assert_eq!(answer.number, Some(payload().number()), "{what}");
    assert_eq!(answer.shape, Shape::Same, "{what}");
    assert_ne!(answer.witness, Some(Witness::Blind), "{what}");
}

#[portable_test]
fn informed_finds_pieces_with_other_triangles() {
    let (original, marked, mesh) = case();
    let kept = record(
        &original,
        &marked.report,
        &key(1),
        &RecordOptions::default(),
    )
    .unwrap();
    let piece = quantize(&simplify(&crop(&mesh, 0.3, 3), 0.5), 10);
    let piece = to_glb(&similarity(&piece, 4));
    let answer = compare(&piece, &original, &key(1)).unwrap();
    assert_found(&answer, "with the original");
    assert!(answer.near > 0.95 && (0.5..0.9).contains(&answer.covered));
    let answer = compare_with_record(&piece, &kept, &key(1)).unwrap();
    assert_found(&answer, "with the record");
}

#[portable_test]
fn informed_finds_mirrored_and_stretched_copies() {
    let (original, _, mesh) = case();
    let stretched = mesh
        .positions
        .iter()
        .map(|p| *p * DVec3::new(1.5, 1.0, 0.7));
    let stretched = mesh.with_positions(stretched.collect());
    for (name, suspect, is_mirrored) in [
        ("mirrored, remeshed", remesh(&mirrored(&mesh), 0.02), true),
        ("stretched, simplified", simplify(&stretched, 0.3), false),
    ] {
        let suspect = to_glb(&similarity(&suspect, 5));
        let answer = compare(&suspect, &original, &key(1)).unwrap();
        assert_found(&answer, name);
        assert_eq!(answer.is_mirrored, is_mirrored, "{name}");
    }
}

/// A part whose areas, and so the axes of its moments, a stretch changes most.
#[portable_test]
fn informed_lays_a_stretched_part_on_its_original() {
    let part = shapes::cad_part();
    let original = Original::new(&part);
    for stretch in [
        DVec3::new(1.5, 1.0, 0.7),
        DVec3::new(0.7, 1.0, 1.5),
        DVec3::new(0.5, 1.0, 1.0),
        DVec3::new(1.0, 3.0, 1.0),
    ] {
        let stretched = part.positions.iter().map(|p| *p * stretch).collect();
        let suspect = similarity(&simplify(&part.with_positions(stretched), 0.5), 7);
        let best = original.registrations(&suspect, Search::Quick)[0];
        assert!(best.near > 0.95 && best.exact > 0.9, "{stretch}: {best:?}");
    }
}

#[portable_test]
fn informed_tells_an_unmarked_copy_from_another_shape() {
    let (original, ..) = case();
    let unmarked = to_glb(&similarity(&asteroid(), 6));
    let answer = compare(&unmarked, &original, &key(1)).unwrap();
    assert_eq!((answer.verdict, answer.shape), (Verdict::None, Shape::Same));
    assert!(answer.sentence.contains("your mark is not in it"));
    assert!(
        !serde_json::to_string(&answer).unwrap().contains("lnP"),
        "what follows the key is for its owner"
    );
    let other = to_glb(&shapes::torus_knot(60, 20));
    let answer = compare(&other, &original, &key(1)).unwrap();
    assert_eq!(
        (answer.verdict, answer.shape),
        (Verdict::None, Shape::Other),
        "near {}",
        answer.near
    );
}

/// A tenth of a model, with its triangles: what windows and rings say there adds up, and no less is enough. And where a mark is in rings alone,
/// other triangles between the same vertices.
#[portable_test]
fn informed_reads_rings_by_the_vertices_that_were_kept() {
    let (original, _, mesh) = case();
    let piece = to_glb(&similarity(&crop(&mesh, 0.88, 1), 8));
    let answer = compare(&piece, &original, &key(1)).unwrap();
    assert_found(&answer, "a small piece");
    assert_eq!(answer.witness, Some(Witness::Vertices));

    let options = EmbedOptions::default().with_carriers([Carrier::Ring]);
    let marked = embed(&original, payload(), &key(1), &options).unwrap();
    let others = to_glb(&delaunay(&mesh_of(&marked.model)));
    let blind = detect(&others, &key(1), None).unwrap();
    assert_eq!(blind.verdict, Verdict::None, "its rings are others");
    assert_found(&compare(&others, &original, &key(1)).unwrap(), "flipped");
}

/// Two ends of a mesh, the first turned and moved away.
fn two_pieces(mesh: &Mesh) -> Mesh {
    let along = DVec3::new(0.6, 0.7, 0.2).normalize();
    let end = |direction: DVec3| {
        let is_there = |v: &u32| mesh.positions[*v as usize].dot(direction) > 0.2;
        mesh.part(
            mesh.triangles
                .iter()
                .copied()
                .filter(|t| t.iter().all(is_there)),
        )
    };
    let turn = DMat3::from_rotation_y(0.7);
    let first = end(along);
    let turned = first.positions.iter().map(|p| turn * *p + DVec3::X * 5.0);
    Mesh::joined([first.with_positions(turned.collect()), end(-along)])
}

/// What one motion does not lay on the original is taken apart: limbs in another pose, and pieces that were put together anew.
#[portable_test]
fn informed_takes_apart_what_lies_in_several_ways() {
    let (original, marked, mesh) = case();
    let options = RecordOptions::default();
    let kept = record(&original, &marked.report, &key(1), &options).unwrap();
    let kit = simplify(&two_pieces(&mesh), 0.3);
    let knot = shapes::torus_knot(40, 12);
    let far = knot.positions.iter().map(|p| *p * 0.3 + DVec3::Y * 5.0);
    let kit = Mesh::joined([kit, knot.with_positions(far.collect())]);
    for (name, suspect) in [
        ("posed", simplify(&bend(&mesh, 30.0), 0.5)),
        ("put together", kit),
    ] {
        let suspect = to_glb(&similarity(&suspect, 5));
        let (answer, overlay) = compare_overlaid(&suspect, &original, &key(1), None).unwrap();
        assert_found(&answer, name);
        let overlay = overlay.unwrap();
        let all = overlay.additions.len() as f64;
        let near = overlay.additions.iter().filter(|d| **d < 0.006).count() as f64 / all;
        let is_in_parts = answer.num_parts > 1 || answer.is_bent;
        assert!(!is_in_parts || near > 0.9, "{name}: {near}");
        let wrong = compare(&suspect, &original, &key(2)).unwrap();
        assert_eq!(wrong.verdict, Verdict::None, "{name}");
        assert_eq!(wrong.is_bent, name == "posed", "{name}: {wrong:?}");
        assert!(wrong.num_parts > 1 || wrong.is_bent, "{name}: {wrong:?}");
        assert!(wrong.near > 0.6, "{name}: {wrong:?}");
        let answer = compare_with_record(&suspect, &kept, &key(1)).unwrap();
        assert_found(&answer, &format!("{name}, record"));
    }
}

/// What a pose bends is bent back: its vertices are where they were.
#[portable_test]
fn informed_bends_a_posed_copy_back() {
    let host = asteroid();
    let (lies, off) = bent_back(&host, 5).unwrap();
    assert!(lies.near > 0.9 && lies.exact > 0.9, "{lies:?}");
    assert!(off < 0.002, "{off}");
}

/// A knot lies on itself in six ways, and its strands on each other: mostly it is bent back onto its own place, however it was turned.
#[test]
fn informed_bends_a_posed_knot_back() {
    let host = shapes::torus_knot(120, 16);
    let offs = (1..5).map(|seed| bent_back(&host, seed).map(|(_, off)| off));
    let offs: Vec<Option<f64>> = offs.collect();
    let own = offs.iter().flatten().filter(|off| **off < 0.002).count();
    assert!(own >= 3, "{offs:?}");
}

/// How a posed copy lies once it is bent back, and how far half of its vertices are from the original's, as a share of the diagonal; none where it is not bent.
fn bent_back(host: &Mesh, seed: u64) -> Option<(Registration, f64)> {
    let original = Original::new(host);
    let suspect = similarity(&bend(host, 30.0), seed);
    let starts = [Search::Quick, Search::Pieces].map(|s| original.registrations(&suspect, s));
    let assembly = original.assembled(&suspect, &starts.concat())?;
    let off = |p: &DVec3| {
        let vertices = host.positions.iter();
        let distances = vertices.map(|q| q.distance(*p));
        distances.fold(f64::INFINITY, f64::min)
    };
    let mut offs: Vec<f64> = assembly.mesh.positions.iter().map(off).collect();
    offs.sort_by(f64::total_cmp);
    let median = offs[offs.len() / 2] / original.diagonal;
    assembly.is_bent.then_some((assembly.registration, median))
}

/// One payload is tested, and charged for one: a wrong one is not found beside a right key.
#[portable_test]
fn informed_charges_one_payload_where_one_is_expected() {
    let (original, marked, mesh) = case();
    let options = RecordOptions::default();
    let kept = record(&original, &marked.report, &key(1), &options).unwrap();
    let suspect = to_glb(&similarity(&simplify(&crop(&mesh, 0.3, 3), 0.5), 4));
    let wrong = Payload::from_tag("ADA-2").unwrap();
    let gain = Payload::BITS as f64 * std::f64::consts::LN_2 - libm::log(5.0 / 3.0);
    let verify = |expected| {
        [
            verify_with_original(&suspect, &original, &key(1), expected).unwrap(),
            verify_with_record(&suspect, &kept, &key(1), expected).unwrap(),
        ]
    };
    let read = [
        compare(&suspect, &original, &key(1)).unwrap(),
        compare_with_record(&suspect, &kept, &key(1)).unwrap(),
    ];
    for (answer, read) in verify(payload()).iter().zip(&read) {
        assert_found(answer, "expected");
        let gained = read.ln_p() - answer.ln_p();
        assert!((gained - gain).abs() < 1e-6, "{gained}, not {gain}");
    }
    for answer in verify(wrong) {
        assert_eq!(answer.verdict, Verdict::Partial, "{answer:?}");
        assert_eq!(
            answer.number,
            Some(payload().number()),
            "the one that is there"
        );
        assert!(answer.sentence.contains("another payload"));
    }
}

/// What a person is shown: the piece where it was cut out, with the mark's evidence there and nowhere else.
#[portable_test]
fn informed_lays_a_piece_on_its_original() {
    let (original, marked, mesh) = case();
    let piece = simplify(&crop(&mesh, 0.3, 3), 0.5);
    let piece = to_glb(&similarity(&piece, 4));
    let (answer, overlay) = compare_overlaid(&piece, &original, &key(1), None).unwrap();
    assert_found(&answer, "overlaid");
    assert_eq!(answer, compare(&piece, &original, &key(1)).unwrap());
    let overlay = overlay.unwrap();
    let host = mesh_of(&original);
    assert_eq!(overlay.original.triangles, host.triangles);
    assert_eq!(overlay.differences.len(), host.positions.len());
    let all = overlay.differences.len() as f64;
    let near = overlay.differences.iter().filter(|d| d.is_finite());
    let share = near.count() as f64 / all;
    assert!((share - answer.covered).abs() < 0.1, "{share}");
    assert!(overlay.additions.iter().all(|d| *d < 0.006));
    let evidence = overlay.evidence.as_deref().unwrap();
    let mean = evidence.iter().map(|e| f64::from(*e)).sum::<f64>() / (share * all);
    assert!(mean > 0.1, "{mean}");
    let mut cut = evidence.iter().zip(&overlay.differences);
    assert!(cut.all(|(e, d)| d.is_finite() || *e == 0.0));
    let wrong = compare_overlaid(&marked.model, &original, &key(2), None)
        .unwrap()
        .1;
    let wrong = wrong.unwrap();
    assert_eq!(wrong.evidence, None, "what was not found is not told");
    assert!(wrong.differences.iter().all(|d| *d < 0.01));
    let other = to_glb(&shapes::torus_knot(60, 20));
    assert_eq!(
        compare_overlaid(&other, &original, &key(1), None)
            .unwrap()
            .1,
        None
    );
}

/// Keys that marked nothing, on a marked copy that lies on its original.
#[portable_test]
fn informed_bound_holds_for_wrong_keys() {
    let (original, _, suspect) = case();
    let original = mesh_of(&original);
    let parts = Parts::new(&original);
    let leeway = Leeway::new(&original, &parts, Bounds::HIDDEN);
    let admissible = Admissible::default();
    let host = Host {
        mesh: &original,
        leeway: &leeway,
        admissible: &admissible,
        rms_rel: 0.0004,
        hidden: true,
        share: 1.0,
        on_top: None,
    };
    let surface = Original::new(&original);
    let views = Views::new(&original);
    let registration = surface.registrations(&suspect, Search::Quick)[0];
    let shown = Shown::new(&surface, &views, &suspect, &registration.motion).unwrap();
    let frames = Frames::new(&host);
    let observe = |radius: f64| shown.observations(radius);
    let seen: [&Seen; 1] = [&observe];
    let mut charged = Vec::new();
    for number in 100..112 {
        let mut best = 0.0f64;
        let reader = frames.with_key(&key(number));
        let mut hear = |way: meshmark::internals::carrier::Way| {
            let pilots = way.places.iter().filter(|p| p.symbol == Symbol::Pilot);
            let pilots = ln_p_of_errors(pilots.map(|p| (p.response, p.errors[1])));
            let all = way.places.iter().map(|p| {
                let is_plus = Codeword::Presence.sign(p.symbol) > 0.0;
                (p.response, p.errors[usize::from(is_plus)])
            });
            let ln_p = union(pilots.min(ln_p_of_errors(all)), way.ln_num_tests + 1.0);
            best = best.min(ln_p);
            false
        };
        let mut progress = |_, _| std::ops::ControlFlow::Continue(());
        reader.read(&seen, &mut progress, &mut hear).unwrap();
        charged.push(best);
    }
    let below = |most: f64| charged.iter().filter(|ln_p| **ln_p <= most).count();
    assert!(below(-3.0) <= 1 && below(-6.0) == 0, "{charged:?}");
}

#[portable_test]
fn informed_records_are_refused_where_they_are_not_as_they_were_written() {
    let (original, marked, mesh) = case();
    let options = RecordOptions::default()
        .with_owner("Ada")
        .with_date("2026-11-29");
    let kept = record(&original, &marked.report, &key(1), &options).unwrap();
    assert_eq!(
        kept,
        record(&original, &marked.report, &key(1), &options).unwrap(),
        "the same of the same"
    );
    assert!(kept.len() < 60_000, "{} bytes", kept.len());
    for clear in ["\"Ada\"", "\"2026-11-29\"", "\"ADA-1\""] {
        assert!(kept.contains(clear), "{clear}");
    }
    let suspect = to_glb(&mesh);
    let code = |text: &str, number: u8| {
        compare_with_record(&suspect, text, &key(number))
            .err()
            .map(|error| error.code())
    };
    assert_eq!(code(&kept, 1), None);
    assert_eq!(code(&kept, 2), Some("record.other-key"));
    let of_another = kept.replace("ADA-1", "BOB-1");
    assert_eq!(code(&of_another, 1), Some("record.damaged"), "another tag");
    let at = kept.find("\"sealed\": \"").unwrap() + 500;
    let other = if &kept[at..at + 1] == "A" { "B" } else { "A" };
    let changed = format!("{}{other}{}", &kept[..at], &kept[at + 1..]);
    assert_eq!(code(&changed, 1), Some("record.damaged"), "another letter");
    let later = kept.replace("\"version\": 1", "\"version\": 2");
    assert_eq!(code(&later, 1), Some("record.version"));
    assert_eq!(code("{}", 1), Some("record.not-a-record"));
}

/// docs/FORMAT.md, "The record": what is sealed never changes.
#[portable_test]
fn informed_seals_never_change() {
    let sealed = key(1).seal(b"sealed", b"clear");
    assert_eq!(key(1).unseal(&sealed, b"clear").unwrap(), b"sealed");
    assert_eq!(key(1).unseal(&sealed, b"other"), None);
    assert_eq!(key(2).unseal(&sealed, b"clear"), None);
    assert_eq!(sealed.len(), 12 + 6 + 16);
    let hex = |bytes: &[u8]| -> String { bytes.iter().map(|b| format!("{b:02x}")).collect() };
    assert_eq!(
        hex(&sealed),
        "5f6aa12adcb4656c637ccd47150481e43e91c1f7d5d5de6e381b9b0d59c732909880"
    );
    assert_eq!(key(1).commitment(), "e4761309fd89d2d3a4f4666a78f69988");
}
