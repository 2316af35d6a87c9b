//! Rankings of vertices by stability.

use crate::portable_test;
use glam::DVec3;
use meshmark::internals::attack::{reorder, similarity};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::paper::{Ranking, Stability, rank};

fn is_decreasing(found: &Stability) -> bool {
    found.order.len() == found.stability.len()
        && found
            .stability
            .windows(2)
            .zip(found.order.windows(2))
            .all(|(s, v)| s[0] > s[1] || s[0] == s[1] && v[0] < v[1])
}

#[portable_test]
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
#[portable_test]
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

#[portable_test]
fn osveta_prefers_a_spike_to_the_plane_and_the_plane_to_its_border() {
    let mut sheet = shapes::terrain(10);
    sheet.positions.iter_mut().for_each(|p| p.z = 0.0);
    sheet.positions[60].z = 0.1;
    let mut border: Vec<u32> = Edges::new(&sheet)
        .boundary(&sheet.triangles)
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

#[portable_test]
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

/// A dent is concave, a bump is not; together they are all that was ranked, each in its order.
#[portable_test]
fn osveta_splits_concave_from_convex() {
    let mut sheet = shapes::terrain(12);
    for p in &mut sheet.positions {
        let hill = |x: f64| libm::exp(-60.0 * ((p.x - x) * (p.x - x) + (p.y - 0.5) * (p.y - 0.5)));
        p.z = 0.2 * (hill(0.25) - hill(0.75));
    }
    let found = rank(&sheet, Ranking::Integrated);
    let [concave, convex] = found.split(&sheet);
    assert_eq!(concave.order.len() + convex.order.len(), found.order.len());
    assert!(is_decreasing(&concave) && is_decreasing(&convex));
    assert_eq!(concave.order[0], 9 * 13 + 6);
    assert_eq!(convex.order[0], 3 * 13 + 6);
}

#[portable_test]
fn osveta_does_not_mind_winding() {
    let mesh = shapes::asteroid(20, 30);
    let mut mixed = mesh.clone();
    mixed
        .triangles
        .iter_mut()
        .step_by(3)
        .for_each(|triangle| triangle.swap(1, 2));
    for ranking in Ranking::ALL {
        assert_eq!(
            rank(&mixed, ranking).order,
            rank(&mesh, ranking).order,
            "{}",
            ranking.name()
        );
    }
}
