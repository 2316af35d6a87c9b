//! The LOCAL carrier: found blind in a piece that was cut out and simplified.

use crate::support::fixtures::{key, strong};
use glam::DVec3;
use meshmark::internals::attack::{crop, similarity, simplify};
use meshmark::internals::carrier::Host;
use meshmark::internals::carrier::local::{Embedded, Measurement, embed};
use meshmark::internals::code::{Codeword, Symbol};
use meshmark::internals::detection::Statistic;
use meshmark::internals::geometry::diagonal;
use meshmark::internals::mesh::{Admissible, Mesh, shapes};
use meshmark::internals::progress::ignore;
use std::sync::LazyLock;

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
        on_top: None,
    };
    embed(&host, &key(owner), &[], &mut ignore).unwrap()
}

/// The machined part, marked once for all tests: that takes longer than to read it.
fn embedded_part() -> &'static Embedded {
    static PART: LazyLock<Embedded> = LazyLock::new(|| embedded(&shapes::cad_part(), 1).unwrap());
    &PART
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
    hold_half(0);
}

#[test]
#[ignore = "takes as long again: cargo xtask test --all"]
fn local_is_found_in_another_half() {
    hold_half(1);
}

/// What is left on one side of a plane says whose it is, and nothing under another key.
fn hold_half(plane: u64) {
    let mut marked = shapes::cad_part();
    marked.displace(&embedded_part().displacement);
    let piece = simplify(&crop(&marked, 0.5, plane), 0.5);
    let suspect = Measurement::new(&similarity(&piece, plane));
    let [own, other] = [1, 2].map(|reader| ln_p(&suspect, reader));
    assert!(own < -25.0, "{own}");
    assert!(other > -8.0, "another key: {other}");
}

#[test]
fn local_keeps_to_the_limit() {
    let mesh = shapes::cad_part();
    let embedded = embedded_part();
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
