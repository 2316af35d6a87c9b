//! Speed of every stage, on a generated mesh of the size of the Stanford bunny; and of one more key.
#![allow(missing_docs)] // criterion's macros write undocumented functions

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use meshmark::internals::attack::{simplify, smooth};
use meshmark::internals::carrier::{Carrier, Host, Mark, ring, solid};
use meshmark::internals::code::{Checked, Codeword, decode};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::spectral::{self, InverseFilter};
use meshmark::internals::geometry::{Bounds, Leeway, Parts, Pose, outward, roughness};
use meshmark::internals::mesh::{Admissible, Edges, shapes};
use meshmark::internals::paper::{Ranking, rank};
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Evidence, Files, Key, Model, Payload, embed, extract};

/// 0.04 % of the diagonal.
const RMS_REL: f64 = 0.0004;
/// Candidates of the decoder where the likeliest fails.
const LIST: usize = 64;

fn key(number: u8) -> Key {
    Key::from_bytes(&[number; Key::BYTES]).expect("32 bytes")
}

fn pipeline(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(156, 223);
    let host = to_glb(&mesh);
    let files = Files::new();
    let key = key(1);
    let payload = Payload::from_tag("BENCH").expect("a tag");
    let options = EmbedOptions::default();
    let marked = embed(
        Model::new(&host).with_files(&files),
        payload,
        &key,
        &options,
    )
    .expect("a mark");
    let evidence = Evidence::of_mesh(&mesh);

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
        b.iter(|| {
            embed(
                Model::new(&host).with_files(&files),
                payload,
                &key,
                &options,
            )
        })
    });
    group.bench_function("measure", |b| b.iter(|| Evidence::of_mesh(&mesh)));
    group.bench_function("extract, unmarked", |b| b.iter(|| extract(&evidence, &key)));
    group.bench_function("extract, marked", |b| {
        let document = Document::read(&marked.model, &files).expect("a document");
        let scene = Scene::gather(&document).expect("a scene");
        b.iter_batched(
            || Evidence::of_mesh(&scene.mesh),
            |evidence| extract(&evidence, &key),
            BatchSize::LargeInput,
        );
    });
    group.finish();
    let large = shapes::asteroid(200, 250);
    let mut group = criterion.benchmark_group("rank 50k vertices");
    group.throughput(Throughput::Elements(large.positions.len() as u64));
    for ranking in Ranking::ALL {
        group.bench_function(ranking.name(), |b| b.iter(|| rank(&large, ranking)));
    }
    group.finish();
    criterion.bench_function("key from a passphrase", |b| {
        b.iter(|| Key::from_passphrase("Ada", "correct horse"))
    });
}

/// What the pipelines are made of.
fn stages(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(156, 223);
    let edges = Edges::new(&mesh);
    let boundary: Vec<(u32, u32)> = edges.boundary(&mesh.triangles).collect();
    let rings = edges.rings(mesh.positions.len());
    let key = key(1);
    let payload = Payload::from_tag("BENCH").expect("a tag");
    let host = Host {
        mesh: &mesh,
        leeway: &Leeway::new(&mesh, &Parts::new(&mesh), Bounds::STRONG),
        admissible: &Admissible::default(),
        rms_rel: RMS_REL,
        hidden: false,
        share: 1.0,
        on_top: None,
    };
    let mark = Mark {
        key: &key,
        codeword: &Codeword::new(Checked::new(&key).message(payload)),
    };

    let mut group = criterion.benchmark_group(format!("stages, {} vertices", mesh.positions.len()));
    group
        .throughput(Throughput::Elements(mesh.positions.len() as u64))
        .sample_size(20);
    group.bench_function("edges and rings", |b| {
        b.iter(|| Edges::new(&mesh).rings(mesh.positions.len()))
    });
    group.bench_function("winding", |b| b.iter(|| outward(&mesh)));
    group.bench_function("pose", |b| b.iter(|| Pose::of_volume(&mesh, &boundary)));
    group.bench_function("roughness", |b| b.iter(|| roughness(&mesh, &edges)));
    group.bench_function("undo smoothing, 8 strengths", |b| {
        let filters: Vec<InverseFilter> = (1..=8)
            .map(|number| InverseFilter {
                steps: 5.0 * f64::from(number),
                step: spectral::laplacian,
                gain: 100.0,
            })
            .collect();
        let moves = vec![true; mesh.positions.len()];
        b.iter(|| spectral::filtered(&mesh.positions, &rings, &filters, &moves));
    });
    group.bench_function("SOLID: measure the surface as it is", |b| {
        b.iter(|| solid::Surfaces::new(&mesh).next())
    });
    group.bench_function("SOLID: measure all surfaces", |b| {
        b.iter(|| solid::Surfaces::new(&mesh).count())
    });
    group.bench_function("SOLID: embed", |b| {
        b.iter(|| Carrier::Solid.embed(&host, &mark, &mut ignore))
    });
    group.bench_function("RING: measure", |b| {
        b.iter(|| ring::Measurement::new(&mesh))
    });
    group.bench_function("RING: embed", |b| {
        b.iter(|| Carrier::Ring.embed(&host, &mark, &mut ignore))
    });
    group.bench_function("forecast: smooth", |b| b.iter(|| smooth(&mesh, 0.1, 10)));
    group.bench_function("forecast: simplify", |b| b.iter(|| simplify(&mesh, 0.7)));
    group.finish();
}

/// What one more key costs, for each way of reading that is declared for a surface: a turn of its frame, a pitch and a step.
fn one_more_key(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(60, 90);
    let suspect: solid::Measurement = solid::Surfaces::new(&mesh).take(1).collect();
    let reading = suspect.read(&key(1), &mut ignore).expect("not cancelled");
    let first = reading.hypotheses.first().expect("a way of reading");
    // A third of the probability of a false alarm is shared by the ways of reading the suspect as it is.
    let num_ways = (libm::exp(first.ln_num_tests) / 3.0).round();
    let mut keys = (0..=255).cycle();
    let mut next = move || key(keys.next().expect("endless"));

    let mut group = criterion.benchmark_group("one more key, SOLID, the suspect as it is");
    group
        .throughput(Throughput::Elements(num_ways as u64))
        .sample_size(20);
    group.bench_function("alone", |b| {
        b.iter_batched(
            &mut next,
            |key| suspect.read(&key, &mut ignore),
            BatchSize::SmallInput,
        )
    });
    group.finish();

    let ring = ring::Measurement::new(&mesh);
    let ways = ring.read(&key(1)).hypotheses.len() as u64;
    let mut group = criterion.benchmark_group("one more key, RING");
    group.throughput(Throughput::Elements(ways)).sample_size(20);
    group.bench_function("alone", |b| {
        b.iter_batched(&mut next, |key| ring.read(&key), BatchSize::SmallInput)
    });
    group.finish();

    let mut group = criterion.benchmark_group("a message");
    group.throughput(Throughput::Elements(1)).sample_size(20);
    group.bench_function("the likeliest", |b| b.iter(|| decode(&first.symbols, 1)));
    group.bench_function("the likeliest 64", |b| {
        b.iter(|| decode(&first.symbols, LIST))
    });
    group.finish();
}

criterion_group!(benches, pipeline, stages, one_more_key);
criterion_main!(benches);
