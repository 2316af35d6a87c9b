//! The study of the seed paper: hosts found again.

use crate::portable_test;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::paper::{
    HostsOptions, HostsRow, Preparation, Rule, RuleCounts, Smoothing, fields, hosts, trace,
};
use meshmark::internals::paper::{Ranking, rank};

/// A mesh of 3000 faces, as the paper's was made.
fn optimized() -> Mesh {
    meshmark::internals::attack::optimize(&shapes::torus_knot(110, 30), 3000)
}

fn row(mesh: &Mesh, smoothing: Smoothing, iterations: u32) -> HostsRow {
    let options = HostsOptions {
        num_hosts: 300,
        ..HostsOptions::default()
    };
    hosts(mesh, smoothing, iterations, &options)
}

fn by(row: &HostsRow, rule: Rule) -> &RuleCounts {
    row.rules.iter().find(|counts| counts.rule == rule).unwrap()
}

#[portable_test]
fn study_finds_everything_where_nothing_was_smoothed() {
    let mesh = optimized();
    let row = row(&mesh, Smoothing::MeshSmooth, 0);
    assert_eq!(row.num_vertices, mesh.positions.len());
    for rule in [Rule::Index, Rule::Region] {
        let counts = by(&row, rule);
        assert_eq!(counts.random.least, mesh.positions.len() as f64);
        assert!(
            counts
                .ranked
                .iter()
                .all(|ranked| ranked.count == mesh.positions.len())
        );
    }
    let overlap = by(&row, Rule::Overlap);
    assert!(overlap.ranked.iter().all(|ranked| ranked.count >= 299));
    assert!((overlap.random.mean / overlap.chance.unwrap() - 1.0).abs() < 0.1);
}

/// Random hosts are found as often as chance has it, the rankings more often: Table I.
#[portable_test]
fn study_rankings_beat_chance() {
    let mesh = optimized();
    for iterations in [1, 2] {
        let row = row(&mesh, Smoothing::MeshSmooth, iterations);
        let index = by(&row, Rule::Index);
        let chance = (mesh.positions.len() * mesh.positions.len()) as f64 / row.num_vertices as f64;
        assert_eq!(index.chance, Some(chance));
        let spread = index.random.deviation / f64::from(HostsOptions::default().draws).sqrt();
        assert!(
            (index.random.mean - chance).abs() < 4.0 * spread,
            "{index:?}"
        );
        assert!((index.random.least..=index.random.most).contains(&chance.floor()));
        let ratios: Vec<f64> = index
            .ranked
            .iter()
            .map(|count| count.ratio.unwrap())
            .collect();
        let [literal, integrated, collapse] = ratios[..] else {
            panic!("{ratios:?}")
        };
        assert!(
            literal > 1.1 && integrated > 2.0 && collapse > 2.0,
            "{ratios:?}"
        );
        let region = by(&row, Rule::Region);
        assert!(region.chance.is_none() && region.random.mean > index.random.mean);
        let overlap = by(&row, Rule::Overlap);
        assert!(
            overlap
                .ranked
                .iter()
                .all(|count| count.ratio.unwrap() > 1.5),
            "{overlap:?}"
        );
    }
}

/// On a plane every collapse is for free, and originals must not be preferred for their low indices.
#[portable_test]
fn study_does_not_prefer_originals_among_equals() {
    let mut sheet = shapes::terrain(24);
    sheet.positions.iter_mut().for_each(|p| p.z = 0.0);
    let row = row(&sheet, Smoothing::Midpoint, 1);
    let index = by(&row, Rule::Index);
    let collapse = index
        .ranked
        .iter()
        .find(|count| count.ranking == Ranking::Collapse)
        .unwrap();
    assert!(
        (0.7..1.3).contains(&collapse.ratio.unwrap()),
        "{collapse:?}"
    );
}

#[portable_test]
fn study_compares_every_smoothing() {
    let mesh = shapes::asteroid(16, 24);
    for smoothing in Smoothing::ALL {
        assert_eq!(Smoothing::from_name(smoothing.name()), Some(smoothing));
        assert_eq!(smoothing.apply(&mesh, 0), mesh, "{}", smoothing.name());
        let (once, twice) = (smoothing.apply(&mesh, 1), smoothing.apply(&mesh, 2));
        assert_ne!(once, twice, "{}", smoothing.name());
        assert!(once.positions.len() >= mesh.positions.len());
        let row = row(&mesh, smoothing, 2);
        assert_eq!(row.num_vertices, twice.positions.len());
        let found = by(&row, Rule::Overlap)
            .ranked
            .iter()
            .map(|ranked| ranked.count);
        assert!(found.min().unwrap() > 0, "{}", smoothing.name());
    }
    for preparation in Preparation::ALL {
        assert_eq!(
            Preparation::from_name(preparation.name()),
            Some(preparation)
        );
        assert_eq!(preparation.apply(&mesh), mesh, "small enough as it is");
    }
}

#[portable_test]
fn study_fields_and_traces_agree_with_the_ranking() {
    let mesh = shapes::asteroid(16, 24);
    let order = rank(&mesh, Ranking::Integrated).order;
    let fields = fields(&mesh, Ranking::Integrated);
    assert_eq!(fields.stability[order[0] as usize], 1.0);
    assert_eq!(fields.stability[order[order.len() - 1] as usize], 0.0);
    assert_eq!(fields.mean.len(), mesh.positions.len());
    let tracing = trace(&mesh, Smoothing::MeshSmooth, 1, Ranking::Integrated, 50);
    assert_eq!(tracing.hosts, order[..50]);
    for (host, found) in tracing.hosts.iter().zip(&tracing.found) {
        assert_eq!(tracing.hosts_after.contains(host), *found);
    }
    assert!(tracing.found.contains(&true));
    let smoothed = Smoothing::MeshSmooth.apply(&mesh, 1);
    assert_eq!(tracing.positions.len(), 3 * smoothed.positions.len());
    assert_eq!(tracing.triangles.len(), 3 * smoothed.triangles.len());
    assert!(
        tracing
            .deviation
            .iter()
            .all(|&moved| moved > 0.0 && moved < 0.05)
    );
    assert_eq!(tracing.deviation.len(), mesh.positions.len());
    let nothing = trace(&Mesh::default(), Smoothing::Loop, 2, Ranking::Literal, 50);
    assert!(nothing.hosts.is_empty() && nothing.found.is_empty());
    hosts(
        &Mesh::default(),
        Smoothing::MeshSmooth,
        1,
        &HostsOptions::default(),
    );
}
