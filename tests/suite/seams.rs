//! Vertices that a person sees as one: for the embedder, who moves them together, and for the detector.

use crate::portable_test;
use crate::support::fixtures::{key, payload};
use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};
use glam::DVec3;
use meshmark::internals::attack::split;
use meshmark::internals::document::Document;
use meshmark::internals::geometry::seams;
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Model, Strength, Verdict, detect, embed};

fn gathered(built: &Built) -> Scene {
    Scene::gather(&Document::read(&built.bytes, &built.files).unwrap()).unwrap()
}

/// A primitive's positions, corners and mode.
type Drawn = (Vec<[f64; 3]>, Option<Vec<u32>>, u32);

/// A document of primitives with positions of their own, each shown by one node.
fn document(primitives: &[Drawn]) -> Built {
    let mut builder = GltfBuilder::new(Packing::Glb);
    for (points, corners, mode) in primitives {
        let position = builder.positions(0, Layout::F32, points);
        let corners = corners
            .as_ref()
            .map(|corners| builder.indices(0, Component::U16, corners));
        let mesh = builder.mesh(&[primitive(position, corners, *mode)]);
        builder.node(&format!(r#"{{"mesh":{mesh}}}"#));
    }
    builder.build()
}

fn points(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.to_array()).collect()
}

fn surface(mesh: &Mesh) -> Drawn {
    (points(mesh), Some(mesh.triangles.concat()), 4)
}

/// A unit square in the plane of x and y, `x` to the right.
fn square(x: f64) -> Mesh {
    Mesh {
        positions: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[u, v]| DVec3::new(u + x, v, 0.0))
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

#[portable_test]
fn seams_within_a_little_are_closed_and_others_stay_open() {
    let diagonal = 5f64.sqrt();
    for (gap, is_one) in [(1e-7, true), (1e-4, true), (1.9e-4, true), (3e-4, false)] {
        let parted = [square(0.0), square(1.0 + gap * diagonal)];
        let mut built = document(&parted.each_ref().map(surface));
        let scene = gathered(&built);
        let edges = Edges::new(&scene.mesh);
        let seen = (scene.mesh.positions.len(), edges.num_boundary());
        assert_eq!(seen, if is_one { (6, 6) } else { (8, 8) }, "a gap of {gap}");
        if !is_one {
            continue;
        }
        // Both sides of a seam move by the same.
        let lifted = vec![DVec3::Z * 0.125; 6];
        let mut moved = Document::read(&built.bytes, &built.files).unwrap();
        scene.scatter(&mut moved, &lifted).unwrap();
        for accessor in [0, 2] {
            let positions = moved.positions(accessor).unwrap();
            assert!(positions.iter().all(|p| p[2] == 0.125), "{positions:?}");
        }
        built.bytes = moved.write().unwrap().model;
        let after = gathered(&built).mesh.positions;
        assert_eq!(after, scene.positions_in(&moved).unwrap());
    }
}

/// A plate stays a plate, however thin, and a fine part of a large scene keeps its vertices.
#[portable_test]
fn seams_lose_no_triangle() {
    let thin = shapes::cuboid(DVec3::new(1.0, 1.0, 1e-4), [4, 4, 1]);
    assert_eq!(seams(&thin).merged, []);
    let speck = Mesh {
        positions: [1e6, 1.001e6, 1.002e6].map(DVec3::splat).to_vec(),
        triangles: vec![[0, 1, 2]],
    };
    let stray = Mesh::joined([shapes::asteroid(20, 30), speck]);
    assert_eq!(seams(&stray).merged, []);
    // Of a cluster, which is far finer than its reach, no two vertices of a triangle become one.
    let dust = shapes::asteroid(20, 30);
    let dust = dust.with_positions(dust.positions.iter().map(|p| *p * 1e-3).collect());
    let scene = Mesh::joined([shapes::asteroid(20, 30), dust.clone(), dust]);
    let merged = seams(&scene).merged;
    let len = shapes::asteroid(20, 30).positions.len();
    assert_eq!(merged.len(), len, "one of the two becomes the other");
    assert!(
        merged
            .iter()
            .all(|&(vertex, first)| vertex as usize == first as usize + len)
    );
}

/// A fin that grows out of a surface and comes back to it ends in the midst of it, where no vertex has an edge with one triangle.
#[portable_test]
fn seams_close_where_a_fin_ends_in_the_midst_of_its_own_surface() {
    for gap in [1e-4, 1e-7] {
        let across = [0.0, 1.0, 2.0].map(|x| (x, 0.0));
        let back = [(2.0, 1.0), (1.0, 1.0), (1.0, gap)];
        let rows = across.into_iter().chain(back);
        let positions = rows.flat_map(|(x, z)| [0.0, 1.0, 2.0].map(|y| DVec3::new(x, y, z)));
        let quads = (0..5).flat_map(|row| [3 * row, 3 * row + 1]);
        let halves = quads.flat_map(|a| [[a, a + 1, a + 3], [a + 3, a + 1, a + 4]]);
        let fin = Mesh {
            positions: positions.collect(),
            triangles: halves.collect(),
        };
        assert_eq!(seams(&fin).merged, [(15, 3), (16, 4), (17, 5)], "{gap}");
    }
}

/// Two sides of a leaf, as two sheets close to each other, stay two; where they are parted by rounding alone they are one.
#[portable_test]
fn seams_lay_no_sheet_upon_another() {
    for (gap, num) in [(1e-7, 9), (1e-4, 0)] {
        let [mut front, mut back] = [0, 1].map(|_| shapes::terrain(2));
        assert_eq!(front.positions.len(), 9);
        back.positions.iter_mut().for_each(|p| p.z += gap * 1.4);
        back.triangles
            .iter_mut()
            .for_each(|triangle| triangle.swap(1, 2));
        front = Mesh::joined([front, back]);
        assert_eq!(seams(&front).merged.len(), num, "{gap}");
    }
}

/// A codec gives each primitive a grid of its own: copies of a vertex on both sides of a seam part.
#[portable_test]
fn seams_on_grids_of_their_own_keep_the_mark() {
    let pieces = |mesh: &Mesh| -> Vec<Mesh> {
        // By material, each piece with its own copies.
        let split = split(mesh, 5);
        let labels = Edges::new(&split).components();
        let num_pieces = labels.iter().max().unwrap() + 1;
        let of = |piece| {
            let triangles = split.triangles.iter().zip(&labels);
            let own = triangles.filter(|(_, label)| **label == piece);
            split.part(own.map(|(&triangle, _)| triangle))
        };
        (0..num_pieces).map(of).collect()
    };
    let host = to_glb(&shapes::asteroid(30, 40));
    let options = EmbedOptions::default()
        .with_strength(Strength::STRONG)
        .with_carriers([meshmark::Carrier::Solid]);
    let marked = embed(&host, payload(), &key(1), &options).unwrap();
    let before = marked.report.read_back.details().ln_p;
    let mesh = Scene::gather(&Document::read(&marked.model, &Default::default()).unwrap())
        .unwrap()
        .mesh;
    let on_grid = |piece: &Mesh| {
        let low = piece.positions.iter().copied().reduce(DVec3::min).unwrap();
        let high = piece.positions.iter().copied().reduce(DVec3::max).unwrap();
        let pitch = (high - low).max_element() / 16_383.0;
        let positions = piece.positions.iter();
        piece.with_positions(
            positions
                .map(|p| ((*p - low) / pitch).round() * pitch + low)
                .collect(),
        )
    };
    let parted: Vec<Mesh> = pieces(&mesh).iter().map(on_grid).collect();
    assert!(parted.len() > 3);
    assert!(Edges::new(&Mesh::joined(parted.clone()).welded()).num_boundary() > 100);
    let suspect = document(&parted.iter().map(surface).collect::<Vec<_>>());
    assert_eq!(Edges::new(&gathered(&suspect).mesh).num_boundary(), 0);
    let found = detect(&suspect.bytes, &key(1), None).unwrap();
    assert_eq!(found.verdict, Verdict::Found);
    let after = found.details().ln_p;
    assert!(after < 0.9 * before, "{after} of {before}");
}

/// Lines that lie on the surface, on its vertices and between them, move with it; what lies elsewhere stays.
#[portable_test]
fn points_and_lines_move_with_the_surface_below_them() {
    let rock = shapes::asteroid(30, 40);
    let middle = |&[a, b, _]: &[u32; 3]| {
        ((rock.positions[a as usize] + rock.positions[b as usize]) / 2.0).to_array()
    };
    let mut lines = points(&rock);
    lines.extend(rock.triangles.iter().map(middle));
    lines.push([9.0, 0.0, 0.0]);
    let built = document(&[
        surface(&rock),
        (lines.clone(), None, 1),
        (points(&rock), None, 0),
    ]);
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let model = Model::new(&built.bytes).with_files(&built.files);
    let marked = embed(model, payload(), &key(1), &options).unwrap();
    let document = Document::read(&marked.model, &marked.files).unwrap();
    let [after, on_lines, on_points] = [0, 2, 3].map(|accessor| {
        let positions = document.positions(accessor).unwrap();
        positions
            .into_iter()
            .map(DVec3::from_array)
            .collect::<Vec<DVec3>>()
    });
    let num = after.len();
    let largest = |a: &[DVec3], b: &[DVec3]| {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
    };
    let host: Vec<DVec3> = rock
        .positions
        .iter()
        .map(|p| p.as_vec3().as_dvec3())
        .collect();
    assert!(largest(&after, &host) > 1e-3);
    assert!(largest(&after, &on_lines[..num]) < 1e-6);
    assert!(largest(&after, &on_points) < 1e-6);
    let middles: Vec<DVec3> = rock
        .triangles
        .iter()
        .map(|&[a, b, _]| (after[a as usize] + after[b as usize]) / 2.0)
        .collect();
    assert!(largest(&middles, &on_lines[num..]) < 1e-6);
    assert_eq!(on_lines.last(), Some(&DVec3::new(9.0, 0.0, 0.0)));
}
