//! Speed of what an owner does beside marking and checking: copies for buyers, and reading with the original or a record.
#![allow(missing_docs)] // criterion's macros write undocumented functions
#![allow(clippy::unwrap_used)] // a benchmark of what fails measures nothing

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use meshmark::internals::attack::simplify;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    EmbedOptions, Files, Key, Payload, RecordOptions, Shape, Strength, compare,
    compare_with_record, detect, embed, prepare, record,
};

fn key() -> Key {
    Key::from_bytes(&[3; Key::BYTES]).unwrap()
}

/// What lies before a plane through the middle.
fn half(mesh: &Mesh) -> Mesh {
    let normal = DVec3::new(0.8, 0.5, 0.33).normalize();
    let is_kept = |face: &&[u32; 3]| {
        face.iter()
            .all(|&v| mesh.positions[v as usize].dot(normal) > 0.0)
    };
    mesh.part(mesh.triangles.iter().filter(is_kept).copied())
}

fn copies(criterion: &mut Criterion) {
    let host = to_glb(&shapes::asteroid(156, 223));
    let (key, options) = (key(), EmbedOptions::default());
    let (plan, report) = prepare(&host, &key, &options).unwrap();
    let mut group = criterion.benchmark_group(format!("copies, {} vertices", report.vertices));
    group
        .throughput(Throughput::Elements(report.vertices as u64))
        .sample_size(10);
    group.bench_function("embed", |b| {
        b.iter(|| embed(&host, Payload::of_copy(7, &key).unwrap(), &key, &options).unwrap())
    });
    group.bench_function("prepare", |b| {
        b.iter(|| prepare(&host, &key, &options).unwrap())
    });
    let mut numbers = 1..;
    group.bench_function("stamp one more", |b| {
        b.iter(|| plan.stamp(numbers.next().unwrap()).unwrap())
    });
    group.finish();
}

/// Blind reading that finds nothing is here to compare with: it is what somebody has waited for before the original is looked for.
fn with_the_original(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(156, 223);
    let host = to_glb(&mesh);
    let (key, options) = (
        key(),
        EmbedOptions::default().with_strength(Strength::STRONG),
    );
    let marked = embed(&host, Payload::of_copy(7, &key).unwrap(), &key, &options).unwrap();
    let document = Document::read(&marked.model, &Files::new()).unwrap();
    let whole = simplify(&Scene::gather(&document).unwrap().mesh, 0.5);
    let suspects = [
        (
            "a whole copy, simplified to half",
            to_glb(&whole),
            Shape::Same,
        ),
        ("half of it", to_glb(&half(&whole)), Shape::Same),
        (
            "another model",
            to_glb(&shapes::torus_knot(366, 96)),
            Shape::Other,
        ),
    ];
    let kept = record(&host, &marked.report, &key, &RecordOptions::default()).unwrap();
    let num_vertices = mesh.positions.len();
    let mut group =
        criterion.benchmark_group(format!("with the original, {num_vertices} vertices"));
    group
        .throughput(Throughput::Elements(num_vertices as u64))
        .sample_size(10);
    for (name, suspect, shape) in &suspects {
        assert_eq!(
            compare(suspect, &host, &key).unwrap().shape,
            *shape,
            "{name}"
        );
        group.bench_function(format!("{name}: blind"), |b| {
            b.iter(|| detect(suspect, &key, None))
        });
        group.bench_function(format!("{name}: original"), |b| {
            b.iter(|| compare(suspect, &host, &key))
        });
        group.bench_function(format!("{name}: record"), |b| {
            b.iter(|| compare_with_record(suspect, &kept, &key))
        });
    }
    group.finish();
}

criterion_group!(benches, copies, with_the_original);
criterion_main!(benches);
