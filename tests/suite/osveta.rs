//! Rankings of vertices by stability.

use glam::DVec3;
use meshmark::attack::{reorder, similarity};
use meshmark::carrier::osveta::{Ranking, Stability, rank};
use meshmark::mesh::{Edges, Mesh, shapes};
use wasm_bindgen_test::wasm_bindgen_test;

fn is_decreasing(found: &Stability) -> bool {
    found.order.len() == found.stability.len()
        && found
            .stability
            .windows(2)
            .zip(found.order.windows(2))
            .all(|(s, v)| s[0] > s[1] || s[0] == s[1] && v[0] < v[1])
}

#[wasm_bindgen_test(unsupported = test)]
fn osveta_gives_both_vectors_in_decreasing_order() {
    let mesh = shapes::asteroid(20, 30);
    for ranking in Ranking::ALL {
        let found = rank(&mesh, ranking);
        assert!(is_decreasing(&found), "{}", ranking.name());
        let mut vertices = found.order.clone();
        vertices.sort_unstable();
        assert!(vertices.into_iter().eq(0..mesh.positions.len() as u32));
        assert!(found.stability.iter().all(|s| (0.0..=1.0).contains(s)));
        assert_eq!(found, rank(&mesh, ranking));
        assert_eq!(Ranking::from_name(ranking.name()), Some(ranking));
        assert_eq!(rank(&Mesh::default(), ranking), Stability::default());
    }
}

/// A similarity changes no order, but of vertices that are equal to the last bits; a new numbering changes names alone.
#[wasm_bindgen_test(unsupported = test)]
fn osveta_ranks_the_shape_and_not_its_place() {
    let mesh = shapes::torus_knot(60, 20);
    for ranking in Ranking::ALL {
        let found = rank(&mesh, ranking);
        let moved = rank(&similarity(&mesh, 4), ranking);
        let same = found.order.iter().zip(&moved.order).filter(|(a, b)| a == b);
        assert!(
            same.count() * 10 > 9 * found.order.len(),
            "{}",
            ranking.name()
        );
        let renamed = reorder(&mesh, 4);
        let places = |mesh: &Mesh| -> Vec<DVec3> {
            let found = rank(mesh, ranking);
            found
                .order
                .iter()
                .map(|&v| mesh.positions[v as usize])
                .collect()
        };
        let same = places(&mesh)
            .into_iter()
            .zip(places(&renamed))
            .filter(|(a, b)| a == b);
        assert!(
            same.count() * 10 > 9 * found.order.len(),
            "{}",
            ranking.name()
        );
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn osveta_prefers_a_spike_to_the_plane_and_the_plane_to_its_border() {
    let mut sheet = shapes::terrain(10);
    sheet.positions.iter_mut().for_each(|p| p.z = 0.0);
    sheet.positions[60].z = 0.1;
    let mut border: Vec<u32> = Edges::new(&sheet)
        .boundary()
        .map(|(from, _)| from)
        .collect();
    border.sort_unstable();
    for ranking in Ranking::ALL {
        let found = rank(&sheet, ranking);
        assert_eq!(found.order[0], 60, "{}", ranking.name());
        let (inside, mut last) = (found.order.len() - border.len(), border.clone());
        last.sort_unstable();
        let mut tail = found.order[inside..].to_vec();
        tail.sort_unstable();
        assert_eq!(tail, border, "{}", ranking.name());
        assert!(found.stability[inside - 1] >= 0.0 && found.stability[inside] <= 0.0);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn osveta_rejects_errors_of_topology() {
    let mut mesh = shapes::asteroid(20, 30);
    let num_vertices = mesh.positions.len() as u32;
    // A vertex without a face, and one that hangs on the mesh by long edges alone.
    mesh.positions.extend([DVec3::ZERO, DVec3::splat(9.0)]);
    mesh.triangles.push([0, 1, num_vertices + 1]);
    for ranking in Ranking::ALL {
        let found = rank(&mesh, ranking);
        assert_eq!(found.order.len(), num_vertices as usize);
        assert!(
            found.order.iter().all(|&v| v < num_vertices),
            "{}",
            ranking.name()
        );
    }
}
