//! The study of errors, Fig. 5.

use crate::portable_test;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::paper::figure_5::{Case, Errors, Finding, Hosts, errors, figure_5};
use meshmark::internals::paper::{Barycentre, Ranking};
use meshmark::internals::paper::{Smoothing, Spread};
use meshmark::internals::progress::ignore;

fn pebble() -> Mesh {
    shapes::asteroid(40, 60)
}

fn case(hosts: Hosts, iterations: u32) -> Case {
    Case {
        hosts,
        barycentre: Barycentre::Volume,
        strength: 8e-4,
        smoothing: Smoothing::MeshSmooth,
        iterations,
    }
}

fn found(errors: &[Errors], finding: Finding) -> &Errors {
    let mut of = errors.iter().filter(|errors| errors.finding == finding);
    of.next().unwrap()
}

/// Unattacked, every way is right but one: ranking again is at chance, as the mark itself changes the ranking.
#[portable_test]
fn figure_5_without_an_attack() {
    let mesh = pebble();
    let of = |hosts| errors(&mesh, &case(hosts, 0), 0..2, &mut ignore).unwrap();
    let ranked = of(Hosts::Ranked(Ranking::Collapse));
    assert_eq!(ranked.len(), 3);
    for finding in [Finding::Traced, Finding::Original] {
        let errors = found(&ranked, finding);
        assert_eq!((errors.payload.mean, errors.read), (0.0, 1.0), "{errors:?}");
    }
    let again = found(&ranked, Finding::Ranked);
    assert!((0.3..0.7).contains(&again.raw.mean), "{again:?}");
    assert!((0.25..0.75).contains(&again.payload.mean) && again.read == 0.0);
    let random = of(Hosts::Random);
    assert_eq!(random.len(), 2, "random hosts cannot be ranked again");
    assert_eq!(found(&random, Finding::Traced).payload.most, 0.0);
    let all = of(Hosts::All);
    assert_eq!(found(&all, Finding::Cells).payload.most, 0.0);
}

#[portable_test]
fn errors_grow_with_the_smoothing() {
    let of = |iterations| {
        let case = case(Hosts::Ranked(Ranking::Integrated), iterations);
        let errors = errors(&pebble(), &case, 0..1, &mut ignore).unwrap();
        found(&errors, Finding::Traced).raw.mean
    };
    let [once, twice] = [1, 2].map(of);
    assert!(0.0 < once && once < twice && twice < 0.5, "{once} {twice}");
}

#[portable_test]
fn errors_refuse_what_is_too_small() {
    let small = shapes::asteroid(10, 20);
    let error = figure_5(&small, Barycentre::Vertices, 0..1, &mut ignore).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-hosts");
}

#[portable_test]
fn spread_of_draws() {
    let spread = Spread::of(&[1.0, 2.0, 6.0]);
    assert_eq!((spread.mean, spread.least, spread.most), (3.0, 1.0, 6.0));
    assert!((spread.deviation - 7f64.sqrt()).abs() < 1e-12);
    assert_eq!(Spread::of(&[4.0]).deviation, 0.0);
    assert_eq!(Spread::of(&[]), Spread::default());
}
