//! Speed of every stage, on a generated mesh of the size of the Stanford bunny.
#![allow(missing_docs)] // criterion's macros write undocumented functions

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use meshmark::carrier::osveta::{Ranking, rank};
use meshmark::document::Document;
use meshmark::mesh::shapes;
use meshmark::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Evidence, Files, Key, Payload, embed, extract, ignore};

fn pipeline(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(156, 223);
    let host = to_glb(&mesh);
    let files = Files::new();
    let key = Key::from_bytes(&[1; Key::BYTES]).expect("32 bytes");
    let payload = Payload::from_tag("BENCH").expect("a tag");
    let options = EmbedOptions::default();
    let marked = embed(&host, &files, payload, &key, &options, &mut ignore).expect("a mark");
    let evidence = Evidence::measure(&mesh);

    let mut group = criterion.benchmark_group(format!("{} vertices", mesh.positions.len()));
    group
        .throughput(Throughput::Elements(mesh.positions.len() as u64))
        .sample_size(20);
    group.bench_function("read", |b| b.iter(|| Document::read(&host, &files)));
    group.bench_function("gather", |b| {
        let document = Document::read(&host, &files).expect("a document");
        b.iter(|| Scene::gather(&document));
    });
    group.bench_function("embed, whole", |b| {
        b.iter(|| embed(&host, &files, payload, &key, &options, &mut ignore))
    });
    group.bench_function("measure", |b| b.iter(|| Evidence::measure(&mesh)));
    group.bench_function("extract, unmarked", |b| b.iter(|| extract(&evidence, &key)));
    group.bench_function("extract, marked", |b| {
        let document = Document::read(&marked.model, &files).expect("a document");
        let scene = Scene::gather(&document).expect("a scene");
        b.iter_batched(
            || Evidence::measure(&scene.mesh),
            |evidence| extract(&evidence, &key),
            BatchSize::LargeInput,
        );
    });
    group.finish();
    let large = shapes::asteroid(200, 250);
    let mut group = criterion.benchmark_group("rank 50k vertices");
    for ranking in Ranking::ALL {
        group.bench_function(ranking.name(), |b| b.iter(|| rank(&large, ranking)));
    }
    group.finish();
    criterion.bench_function("key from a passphrase", |b| {
        b.iter(|| Key::from_passphrase("Ada", "correct horse"))
    });
}

criterion_group!(benches, pipeline);
criterion_main!(benches);
