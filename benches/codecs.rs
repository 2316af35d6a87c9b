//! Speed of the codecs of compressed geometry: decoding, and encoding what a mark has changed.
#![allow(missing_docs)] // criterion's macros write undocumented functions
#![allow(clippy::unwrap_used)] // a benchmark of what fails measures nothing

#[path = "../tests/suite/support"]
mod support {
    pub mod compress;
    pub mod glb;
}

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use meshmark::internals::document::{Document, Files};
use meshmark::internals::mesh::shapes;
use support::compress::{by_draco, by_meshopt};

fn codecs(criterion: &mut Criterion) {
    let mesh = shapes::asteroid(250, 400);
    let num_vertices = mesh.positions.len();
    let files = Files::new();
    let models = [
        ("Draco, 14 bits", by_draco(&mesh, 7, 14)),
        (
            "meshopt",
            by_meshopt(&mesh, "EXT_meshopt_compression", 0, None),
        ),
    ];
    let mut group = criterion.benchmark_group(format!("codecs, {num_vertices} vertices"));
    group
        .throughput(Throughput::Elements(num_vertices as u64))
        .sample_size(10);
    for (name, model) in models {
        group.bench_function(format!("{name}: decode"), |b| {
            b.iter(|| {
                Document::read(&model, &files)
                    .unwrap()
                    .positions(0)
                    .unwrap()
            })
        });
        let mut document = Document::read(&model, &files).unwrap();
        let mut positions = document.positions(0).unwrap();
        positions
            .iter_mut()
            .for_each(|position| position[0] *= 1.001);
        document.set_positions(0, &positions).unwrap();
        group.bench_function(format!("{name}: encode"), |b| {
            b.iter_batched(|| (), |()| document.write().unwrap(), BatchSize::LargeInput)
        });
    }
    group.finish();
}

criterion_group!(benches, codecs);
criterion_main!(benches);
