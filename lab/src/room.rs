//! A room with furniture: objects that stand on a floor and on each other.

use glam::DVec3;
use meshmark::internals::mesh::{Mesh, shapes};

/// Objects by their names, the room itself first. y is up, the unit a metre.
pub fn objects() -> Vec<(String, Mesh)> {
    let objects = [
        ("walls", walls()),
        ("table", placed(&table(), DVec3::new(-0.6, 0.0, 0.4))),
        ("chair", placed(&chair(), DVec3::new(-0.6, 0.0, 1.45))),
        ("sofa", placed(&sofa(), DVec3::new(1.2, 0.0, -1.3))),
        ("shelf", placed(&shelf(), DVec3::new(-2.1, 0.0, -1.7))),
        ("vase", placed(&vase(), DVec3::new(-0.3, 0.76, 0.3))),
        ("stone", placed(&stone(), DVec3::new(1.9, 0.3, 1.4))),
    ];
    let named = objects
        .into_iter()
        .map(|(name, mesh)| (name.to_owned(), mesh));
    named.collect()
}

fn placed(mesh: &Mesh, by: DVec3) -> Mesh {
    mesh.with_positions(mesh.positions.iter().map(|p| *p + by).collect())
}

/// A box of a size, its middle somewhere; its sides divided to about 4 cm.
fn board(size: DVec3, middle: DVec3) -> Mesh {
    let cells = size
        .to_array()
        .map(|side| (side / 0.04).round().max(1.0) as u32);
    placed(&shapes::cuboid(size, cells), middle)
}

/// Seen from within, of twelve triangles.
fn walls() -> Mesh {
    let mut walls = placed(
        &shapes::cuboid(DVec3::new(5.0, 2.6, 4.2), [1; 3]),
        DVec3::Y * 1.3,
    );
    walls.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    walls
}

fn legs(half_width: f64, half_depth: f64, height: f64, thick: f64) -> impl Iterator<Item = Mesh> {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    corners.into_iter().map(move |(x, z)| {
        board(
            DVec3::new(thick, height, thick),
            DVec3::new(x * half_width, height / 2.0, z * half_depth),
        )
    })
}

fn table() -> Mesh {
    let top = board(DVec3::new(1.4, 0.04, 0.8), DVec3::Y * 0.74);
    Mesh::joined(legs(0.62, 0.33, 0.72, 0.07).chain([top]))
}

fn chair() -> Mesh {
    let seat = board(DVec3::new(0.44, 0.05, 0.44), DVec3::Y * 0.45);
    let back = board(DVec3::new(0.42, 0.5, 0.04), DVec3::new(0.0, 0.72, 0.2));
    Mesh::joined(legs(0.19, 0.19, 0.43, 0.05).chain([seat, back]))
}

fn sofa() -> Mesh {
    let cushion = |size: DVec3, middle: DVec3| {
        let ball = shapes::icosphere(4); // of radius 1
        // A box with round edges: the ball drawn out to a power.
        let drawn = |p: &DVec3| {
            let out = |x: f64| x.signum() * x.abs().sqrt().sqrt();
            DVec3::new(out(p.x), out(p.y), out(p.z)) * size / 2.0 + middle
        };
        ball.with_positions(ball.positions.iter().map(drawn).collect())
    };
    Mesh::joined([
        cushion(DVec3::new(1.8, 0.35, 0.8), DVec3::Y * 0.25),
        cushion(DVec3::new(1.8, 0.6, 0.25), DVec3::new(0.0, 0.6, -0.35)),
        cushion(DVec3::new(0.25, 0.5, 0.8), DVec3::new(-0.85, 0.4, 0.05)),
        cushion(DVec3::new(0.25, 0.5, 0.8), DVec3::new(0.85, 0.4, 0.05)),
    ])
}

fn shelf() -> Mesh {
    let side = |x: f64| board(DVec3::new(0.03, 1.8, 0.3), DVec3::new(x, 0.9, 0.0));
    let shelves = (0..5).map(|number| {
        let height = 0.1 + 0.4 * f64::from(number);
        board(DVec3::new(0.74, 0.03, 0.28), DVec3::Y * height)
    });
    Mesh::joined(shelves.chain([side(-0.4), side(0.4)]))
}

/// With a stalk in it that leans: it has axes.
fn vase() -> Mesh {
    let vase = shapes::vase(40, 56);
    let (low, high) = vase
        .positions
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), p| {
            (low.min(p.z), high.max(p.z))
        });
    let size = 0.35 / (high - low);
    let upright = |p: &DVec3| DVec3::new(p.x, p.z - low, -p.y) * size;
    let leaf = shapes::leaf(20, 28);
    let stalk = |p: &DVec3| DVec3::new(0.1 * p.x + 0.05, 0.45 + 0.2 * p.z, 0.16 * p.y);
    Mesh::joined([
        vase.with_positions(vase.positions.iter().map(upright).collect()),
        leaf.with_positions(leaf.positions.iter().map(stalk).collect()),
    ])
}

fn stone() -> Mesh {
    let stone = shapes::asteroid(40, 60);
    stone.with_positions(stone.positions.iter().map(|p| *p * 0.28).collect())
}
