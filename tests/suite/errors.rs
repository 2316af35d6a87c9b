//! The study of errors, Fig. 5.

use meshmark::attack::{catmull_clark, simplify};
use meshmark::carrier::osveta::{Barycentre, Ranking};
use meshmark::ignore;
use meshmark::mesh::{Mesh, shapes};
use meshmark::study::Spread;
use meshmark::study::errors::{Attack, Case, Errors, Finding, Hosts, errors, figure_5};
use wasm_bindgen_test::wasm_bindgen_test;

fn pebble() -> Mesh {
    shapes::asteroid(40, 60)
}

fn case<'a>(hosts: Hosts, attack: Attack<'a>) -> Case<'a> {
    Case {
        hosts,
        barycentre: Barycentre::Volume,
        strength: 8e-4,
        attack,
    }
}

fn none<'a>() -> Attack<'a> {
    Attack {
        name: "none",
        apply: &Mesh::clone,
    }
}

fn found(errors: &[Errors], finding: Finding) -> &Errors {
    let mut of = errors.iter().filter(|errors| errors.finding == finding);
    of.next().unwrap()
}

/// Unattacked, every way is right but one: ranking again is at chance, as the mark itself changes the ranking.
#[wasm_bindgen_test(unsupported = test)]
fn figure_5_without_an_attack() {
    let mesh = pebble();
    let of = |hosts| errors(&mesh, &case(hosts, none()), 0..2, &mut ignore).unwrap();
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

#[wasm_bindgen_test(unsupported = test)]
fn errors_trace_hosts_through_simplification() {
    let apply = |mesh: &Mesh| simplify(mesh, 0.1);
    let attack = Attack {
        name: "simplify 10 %",
        apply: &apply,
    };
    let mesh = pebble();
    let case = case(Hosts::Random, attack);
    let errors = errors(&mesh, &case, 0..1, &mut ignore).unwrap();
    let traced = found(&errors, Finding::Traced);
    assert!((0.02..0.6).contains(&traced.lost.mean), "{traced:?}");
    assert!(traced.raw.mean < 0.1, "{traced:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn errors_grow_with_the_smoothing() {
    let mesh = pebble();
    let of = |rounds| {
        let apply = |mesh: &Mesh| catmull_clark(mesh, rounds);
        let attack = Attack {
            name: "MeshSmooth",
            apply: &apply,
        };
        let case = case(Hosts::Ranked(Ranking::Integrated), attack);
        let errors = errors(&mesh, &case, 0..1, &mut ignore).unwrap();
        found(&errors, Finding::Traced).raw.mean
    };
    let [once, twice] = [1, 2].map(of);
    assert!(0.0 < once && once < twice && twice < 0.5, "{once} {twice}");
}

#[wasm_bindgen_test(unsupported = test)]
fn errors_refuse_what_is_too_small() {
    let error = figure_5(&shapes::asteroid(10, 20), 0..1, &mut ignore).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-hosts");
}

#[wasm_bindgen_test(unsupported = test)]
fn spread_of_draws() {
    let spread = Spread::of(&[1.0, 2.0, 6.0]);
    assert_eq!((spread.mean, spread.least, spread.most), (3.0, 1.0, 6.0));
    assert!((spread.deviation - 7f64.sqrt()).abs() < 1e-12);
    assert_eq!(Spread::of(&[4.0]).deviation, 0.0);
    assert_eq!(Spread::of(&[]), Spread::default());
}
