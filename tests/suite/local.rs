//! The LOCAL carrier: found blind in a piece that was cut out and simplified.

use crate::support::fixtures::{key, payload, strong};
use glam::DVec3;
use meshmark::internals::attack::{crop, similarity, simplify};
use meshmark::internals::carrier::Host;
use meshmark::internals::carrier::local::{Embedded, Measurement, embed};
use meshmark::internals::code::{Codeword, Symbol};
use meshmark::internals::detection::Statistic;
use meshmark::internals::document::Document;
use meshmark::internals::geometry::diagonal;
use meshmark::internals::mesh::{Admissible, Mesh, shapes};
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    Carrier, EmbedOptions, Embedding, Extraction, Files, Strength, Verdict, detect,
    detect_with_local, prepare,
};

/// The limit of the RMS displacement, as a fraction of the diagonal.
const RMS_REL: f64 = 0.0008;

fn embedded(mesh: &Mesh, owner: u8) -> Option<Embedded> {
    let host = Host {
        mesh,
        leeway: &strong(mesh),
        admissible: &Admissible::default(),
        rms_rel: RMS_REL,
        hidden: false,
        share: 1.0,
        on_top: false,
    };
    embed(&host, &key(owner), &[], &mut ignore).unwrap()
}

fn marked(mesh: &Mesh, owner: u8) -> Mesh {
    let mut marked = mesh.clone();
    marked.displace(&embedded(mesh, owner).unwrap().displacement);
    marked
}

/// The bound of a mark without a payload, what the carrier charges paid.
fn ln_p(measurement: &Measurement, reader: u8) -> f64 {
    let reading = measurement.read(&key(reader), &mut ignore).unwrap();
    let ways = reading.hypotheses.iter().map(|way| {
        let symbols = way.symbols.iter();
        let sign = |symbol| Codeword::Presence.sign(symbol);
        let signed = symbols.map(|soft| (soft.value * sign(soft.symbol), soft.weight));
        Statistic::new(signed).ln_p() + way.ln_num_tests
    });
    ways.fold(0.0, f64::min)
}

#[test]
fn local_is_found_in_half_a_model_that_was_simplified_to_half() {
    let marked = marked(&shapes::cad_part(), 1);
    for seed in 0..2 {
        let piece = simplify(&crop(&marked, 0.5, seed), 0.5);
        let suspect = Measurement::new(&similarity(&piece, seed));
        let [own, other] = [1, 2].map(|reader| ln_p(&suspect, reader));
        assert!(own < -25.0, "plane {seed}: {own}");
        assert!(other > -8.0, "plane {seed}, another key: {other}");
    }
}

#[test]
fn local_keeps_to_the_limit() {
    let mesh = shapes::cad_part();
    let embedded = embedded(&mesh, 1).unwrap();
    let squares = embedded.displacement.iter().map(|d| d.length_squared());
    let rms = (squares.sum::<f64>() / mesh.positions.len() as f64).sqrt();
    let limit = RMS_REL * diagonal(&mesh.positions);
    assert!((0.5 * limit..=1.0001 * limit).contains(&rms), "{rms}");
    assert!(embedded.exponent > 60.0, "{}", embedded.exponent);
    let is_near = |(centre, radius, _): &(DVec3, f64, f64)| {
        mesh.positions.iter().any(|p| p.distance(*centre) < *radius)
    };
    assert!(embedded.balls.iter().all(is_near));
}

#[test]
fn local_leaves_out_what_has_no_places() {
    assert!(embedded(&shapes::leaf(40, 50), 1).is_none());
    let measurement = Measurement::new(&shapes::leaf(40, 50));
    let reading = measurement.read(&key(1), &mut ignore).unwrap();
    assert!(reading.hypotheses.is_empty());
}

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

/// What a person does: mark, lose a copy, and find half of it simplified.
#[test]
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
    for other in 2..5 {
        let read = detect_with_local(&suspect, &key(other), None).unwrap();
        assert_eq!(read.verdict, Verdict::None, "key {other}");
    }
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

/// docs/SECURITY.md, LOCAL: pilots chose, so they do not testify; and the shares of all sets of balls are 1 together.
#[test]
fn local_charges_every_set_of_balls_and_hears_no_pilot() {
    let reading = Measurement::new(&shapes::low_poly())
        .read(&key(1), &mut ignore)
        .unwrap();
    assert_eq!(reading.hypotheses.len(), 4);
    let share = |ln: f64| libm::exp(-ln);
    let shares: f64 = reading
        .hypotheses
        .iter()
        .map(|way| share(way.ln_num_tests))
        .sum();
    assert!((shares - 1.0).abs() < 1e-12, "{shares}");
    let mut before = 0;
    for way in &reading.hypotheses {
        assert!(way.symbols.len() > before, "each set has a ball more");
        before = way.symbols.len();
        assert!(way.symbols.iter().all(|soft| soft.symbol != Symbol::Pilot));
    }
}
