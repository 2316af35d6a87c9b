//! Any mesh: what is marked is found, and what cannot be marked is refused with a code.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::to_glb;
use meshmark::{EmbedOptions, Key, Payload, Verdict, detect, embed};

fuzz_target!(|bytes: &[u8]| {
    let Some(mesh) = mesh(bytes) else {
        return;
    };
    let key = Key::from_bytes(&[7; Key::BYTES]).expect("32 bytes");
    let payload = Payload::from_number(77).expect("a small number");
    match embed(&to_glb(&mesh), payload, &key, &EmbedOptions::default()) {
        Ok(marked) => {
            let found = detect(&marked.model, &key, None).expect("what was marked can be read");
            // Of a small mesh, a mark without a payload.
            let number = (found.verdict == Verdict::Found).then_some(77);
            let is_there = matches!(found.verdict, Verdict::Found | Verdict::Present);
            assert!(is_there && found.number == number, "{found:?}");
            assert_eq!(found.verdict, marked.report.read_back.verdict);
        }
        Err(error) => assert!(error.code().contains('.'), "{error}"),
    }
});

/// A small asteroid with some of its vertices moved and some of its triangles changed, as the bytes say: 4 for each change.
fn mesh(bytes: &[u8]) -> Option<Mesh> {
    let (&[rings, segments], changes) = bytes.split_first_chunk()?;
    let mut mesh = shapes::asteroid(3 + u32::from(rings % 30), 3 + u32::from(segments % 40));
    for change in changes.chunks_exact(4) {
        let place = usize::from(change[0]) << 8 | usize::from(change[1]);
        let by = f64::from(change[3]) / 64.0 - 2.0;
        let vertex = place % mesh.positions.len();
        let triangle = place % mesh.triangles.len();
        match change[2] % 8 {
            axis @ 0..3 => mesh.positions[vertex][usize::from(axis)] += by,
            axis @ 3..6 => mesh.positions[vertex][usize::from(axis - 3)] *= by,
            6 => mesh.triangles[triangle][0] = vertex as u32,
            _ => drop(mesh.triangles.swap_remove(triangle)),
        }
        if mesh.triangles.is_empty() {
            return None;
        }
    }
    Some(mesh)
}
