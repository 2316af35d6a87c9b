//! The bound against suspects that were made to break it: each would if two terms of a test shared a dither, or if a number of the
//! suspect could swallow one. Every test of every way of reading is held against its own bound, at every decade.

use glam::DVec3;
use meshmark::internals::attack::{both_sides, bridged_hull};
use meshmark::internals::carrier::direction::Cells;
use meshmark::internals::carrier::direction::NUM_TESTS;
use meshmark::internals::carrier::{Measurement, Reading, ring, solid};
use meshmark::internals::code::{Block, Checked, Codeword, SoftSymbol, Symbol};
use meshmark::internals::detection::{Statistic, union};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::Pieces;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Evidence, Files, Key, Payload, extract, verify};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::f64::consts::LN_10;

const DECADES: usize = 6;

/// Keys without an end.
fn random_key(number: u64) -> Key {
    Key::from_bytes(&Sha256::digest(number.to_le_bytes())).unwrap()
}

/// Of the tests of one kind, how many there were, and how many of them had a bound below that of each decade.
#[derive(Default)]
struct Tail {
    tests: u64,
    below: [u64; DECADES],
}

impl Tail {
    fn add(&mut self, ln_p: f64) {
        self.tests += 1;
        for (decade, below) in self.below.iter_mut().enumerate() {
            *below += u64::from(ln_p <= -LN_10 * (decade + 1) as f64);
        }
    }

    /// No more tests below a bound than it says, but for chance: four standard deviations, and one.
    fn hold(&self, name: &str) {
        let mut expected = self.tests as f64;
        for (below, decade) in self.below.iter().zip(1..) {
            expected /= 10.0;
            assert!(
                *below as f64 <= expected + 4.0 * expected.sqrt() + 1.0,
                "{name}: {below} of {} tests below 1e-{decade}, bound {expected}",
                self.tests
            );
        }
    }
}

/// The tails of all ways of reading, by what they are charged, their place among those, and which symbols testify: all together
/// would hide one that fails.
#[derive(Default)]
struct Tails(BTreeMap<(u64, usize, &'static str), Tail>);

impl Tails {
    /// Counts what each way of reading gives: the symbols that are no pilots against a payload and, where no choice has seen them,
    /// the pilots and all symbols.
    fn count(&mut self, reading: &Reading, key: &Key, with_pilots: bool) {
        let payload = Payload::from_number(123_456_789).unwrap();
        let codeword = Codeword::new(Checked::new(key).message(payload));
        let mut places = BTreeMap::new();
        for hypothesis in &reading.hypotheses {
            let ways = libm::exp(hypothesis.ln_num_tests).round() as u64;
            let place = places.entry(ways).or_insert(0);
            *place += 1;
            let mut add = |name, chosen: fn(&SoftSymbol) -> bool| {
                let chosen = hypothesis.symbols.iter().filter(|soft| chosen(soft));
                let sign = |symbol| codeword.sign(symbol);
                let terms = chosen.map(|soft| (soft.value * sign(soft.symbol), soft.weight));
                let tail = self.0.entry((ways, *place, name)).or_default();
                tail.add(Statistic::new(terms).ln_p());
            };
            add("no pilots", |soft| soft.symbol != Symbol::Pilot);
            if with_pilots {
                add("pilots", |soft| soft.symbol == Symbol::Pilot);
                add("all", |_| true);
            }
        }
    }

    fn hold(&self, name: &str) {
        for ((ways, place, symbols), tail) in &self.0 {
            tail.hold(&format!("{name}, {symbols} of way {place} charged {ways}"));
        }
        let has_any = self.0.values().any(|tail| tail.below[0] > 0);
        assert!(has_any, "{name}: nothing was tested");
    }
}

/// A ring as evidence has it.
fn ring(connectivity: u64, geometry: u64, cell: [i16; 3], offset: f32) -> Vec<u8> {
    let cell = cell.map(i16::to_le_bytes).concat();
    [
        &connectivity.to_le_bytes()[..],
        &geometry.to_le_bytes(),
        &cell,
        &offset.to_le_bytes(),
    ]
    .concat()
}

/// Keys against rings.
fn hold_rings(name: &str, rings: &Rings, keys: u64) {
    let bytes = rings.concat();
    let measurement = ring::Measurement::from_bytes(&bytes).unwrap();
    let mut tails = Tails::default();
    for number in 0..keys {
        let key = random_key(number);
        let reading = measurement.read(&key);
        for hypothesis in &reading.hypotheses {
            let largest = |soft: &SoftSymbol| soft.value.abs() - soft.weight;
            assert!(hypothesis.symbols.iter().all(|soft| largest(soft) < 1e-12));
        }
        tails.count(&reading, &key, true);
    }
    tails.hold(name);
}

type Rings = Vec<Vec<u8>>;

/// Cells whose addresses are equal: the hash of the first two numbers differs by 229 between the two columns, and the third number
/// is added to it.
fn colliding_cells() -> Rings {
    let pairs = (0..100i16).flat_map(|z| {
        let offset = 0.04 * f32::from(z) / 37.0;
        let own = u64::from(z.unsigned_abs());
        [
            ring(own, own, [1825, 4489, z + 229], offset),
            ring(own, own, [-3170, -4529, z], offset),
        ]
    });
    pairs.collect()
}

/// Each cell also as it is seen in the other turns of the frame, as a mirrored model has it.
fn mirrored_halves() -> Rings {
    let mirrored = (0..30i16).flat_map(|i| {
        let (cell, offset) = ([i % 5, i / 5 % 5, i / 25], 0.003 * f32::from(i));
        (0..8).map(move |side| {
            let seen = |axis: usize| match side >> axis & 1 {
                0 => cell[axis],
                _ => !cell[axis],
            };
            let own = i.unsigned_abs().into();
            ring(own, own, [seen(0), seen(1), seen(2)], offset)
        })
    });
    mirrored.collect()
}

/// Each neighbourhood many times, in one cell and in several.
fn repeated_parts() -> Rings {
    let repeated = (0..60i16).flat_map(|i| {
        (0..12i16).map(move |copy| {
            let own = i.unsigned_abs().into();
            ring(own, own / 3, [i, copy % 3, 0], 0.001 * f32::from(copy % 7))
        })
    });
    repeated.collect()
}

/// Rings that cancel each other, but for some that do hardly; and offsets of every size.
fn extreme_offsets() -> Rings {
    let extreme = (0..80i16).flat_map(|i| {
        let (own, cell) = (u64::from(i.unsigned_abs()), [i % 20, i / 20, 32_000]);
        let rest = if i % 8 == 0 { 1e-4 } else { 0.0 };
        let large = [f32::MAX, 1e20, 16_777_216.0, f32::MIN_POSITIVE][i as usize % 4];
        [
            ring(own, own, cell, 0.01),
            ring(own, own, cell, 0.03 + rest),
            ring(own + 1000, own, [i, 1, -32_000], large),
        ]
    });
    extreme.collect()
}

#[test]
fn bound_holds_for_crafted_rings() {
    hold_crafted_rings(RING_KEYS);
}

fn hold_crafted_rings(keys: u64) {
    hold_rings("colliding cells", &colliding_cells(), keys);
    hold_rings("mirrored halves", &mirrored_halves(), keys);
    hold_rings("repeated parts", &repeated_parts(), keys);
    hold_rings("extreme offsets", &extreme_offsets(), keys);
}

/// A rectangle of n x n squares on one side of a box, that faces along the axis.
fn sheet(n: u32, place: impl Fn([f64; 2]) -> DVec3) -> Mesh {
    let steps = || (0..=n).flat_map(|i| (0..=n).map(move |j| [i, j]));
    let across = |step: u32| 2.0 * f64::from(step) / f64::from(n) - 1.0;
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let squares = steps().filter(|step| step.iter().all(|step| *step < n));
    let halves = squares.flat_map(|[i, j]| {
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    });
    Mesh {
        positions: steps().map(|step| place(step.map(across))).collect(),
        triangles: halves.collect(),
    }
}

fn turned(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|face| face.swap(1, 2));
    mesh
}

/// The axes and the sides of a box.
fn sides() -> impl Iterator<Item = (usize, f64)> {
    (0..3).flat_map(|axis| [-1.0, 1.0].map(|side| (axis, side)))
}

fn on_axis(axis: usize, height: f64, [u, v]: [f64; 2]) -> DVec3 {
    let mut point = [0.0; 3];
    point[axis] = height;
    point[(axis + 1) % 3] = u;
    point[(axis + 2) % 3] = v;
    DVec3::from_array(point)
}

fn box_shape(n: u32, half: DVec3) -> Mesh {
    let sheets = sides().map(|(axis, side)| {
        let sheet = sheet(n, |across| on_axis(axis, side, across) * half);
        if side < 0.0 { turned(sheet) } else { sheet }
    });
    Mesh::joined(sheets).welded()
}

fn moved(mesh: &Mesh, by: DVec3) -> Mesh {
    mesh.with_positions(mesh.positions.iter().map(|p| *p + by).collect())
}

/// Six sides of a box, each two sheets a little apart that face away from each other: hardly any flux.
fn doubled_sheets(apart: f64) -> Mesh {
    let half = [1.0, 0.9, 0.8];
    let layers = sides().flat_map(|side| [-1.0, 1.0].map(|layer| (side, layer)));
    let sheets = layers.map(|((axis, side), layer)| {
        let height = side * half[axis] + layer * apart * 0.5;
        let [u, v] = [1, 2].map(|next| half[(axis + next) % 3]);
        let sheet = sheet(3, |[x, y]| {
            on_axis(axis, height, [x * 0.9 * u, y * 0.9 * v])
        });
        if layer < 0.0 { turned(sheet) } else { sheet }
    });
    Mesh::joined(sheets).welded()
}

/// Keys against surfaces. The choice among declared ways has seen their pilots, so the others testify.
fn hold_surfaces(name: &str, surfaces: &solid::Measurement, keys: u64) {
    let mut tails = Tails::default();
    for number in 0..keys {
        let key = random_key(number);
        let reading = surfaces.read(&key, &mut ignore).unwrap();
        tails.count(&reading, &key, false);
    }
    tails.hold(name);
}

/// Keys against a mesh as it is.
fn hold_mesh(name: &str, mesh: &Mesh, keys: u64) {
    let plain: solid::Measurement = solid::Surfaces::new(mesh).plain().collect();
    hold_surfaces(name, &plain, keys);
}

/// Keys against a mesh and each of its pieces alone, as they are.
fn hold_pieces(name: &str, mesh: &Mesh, keys: u64) {
    let found = Pieces::of(mesh);
    assert!(!found.patches.is_empty(), "{name}");
    let pieces = found.in_order().map(|piece| mesh.part(piece));
    let all = std::iter::once(mesh.clone()).chain(pieces);
    let plain = all.flat_map(|piece| solid::Surfaces::new(&piece).plain());
    hold_surfaces(name, &plain.collect(), keys);
}

/// A commit tries so many keys on each surface, which give each a test below one tenth; `cargo xtask test --all` tries more, and suspects
/// that take a scan for each key.
const KEYS: u64 = 200;
const ALL_KEYS: u64 = 1_000;
/// The same of rings, which take little time each.
const RING_KEYS: u64 = 20_000;
const ALL_RING_KEYS: u64 = 100_000;

fn a_box() -> Mesh {
    box_shape(16, DVec3::new(1.0, 0.8, 0.6))
}

fn identical_boxes() -> Mesh {
    let part = box_shape(2, DVec3::new(0.05, 0.04, 0.03));
    let places = (0..64).map(|i| DVec3::new((i % 4).into(), (i / 4 % 4).into(), (i / 16).into()));
    Mesh::joined(places.map(|place| moved(&part, place * DVec3::new(0.2, 0.16, 0.12))))
}

fn mirrored_pair() -> Mesh {
    let half = shapes::asteroid(20, 30);
    let mirrored = half
        .positions
        .iter()
        .map(|p| DVec3::new(3.0 - p.x, p.y, p.z));
    let other = turned(half.with_positions(mirrored.collect()));
    Mesh::joined([half, other])
}

/// The same rock four times, one of them mirrored and one with a stone on it: pieces that share every address.
fn repeated_rocks() -> Mesh {
    let rock = shapes::asteroid(12, 18);
    let stone = rock.positions.iter().map(|p| *p * 0.4 + DVec3::Z);
    let stone = rock.with_positions(stone.collect());
    let others = [DVec3::X, DVec3::Y].map(|axis| moved(&rock, axis * 4.0));
    let both = others
        .into_iter()
        .chain([stone, moved(&mirrored_pair(), DVec3::Z * -6.0)]);
    Mesh::joined(std::iter::once(rock.clone()).chain(both))
}

#[test]
fn bound_holds_for_pieces() {
    hold_pieces("repeated rocks", &repeated_rocks(), KEYS / 10);
}

/// A rock whose surface is written in both directions, with a shell about it on a bridge: pieces that are nearly alike.
fn layered_rock() -> Mesh {
    let hulled = bridged_hull(&shapes::asteroid(12, 18), 0.005);
    let document = Document::read(&to_glb(&both_sides(&hulled)), &Files::new()).unwrap();
    Scene::gather(&document).unwrap().mesh
}

#[test]
fn bound_holds_for_layers() {
    hold_pieces("a layered rock", &layered_rock(), KEYS / 10);
}

#[test]
fn bound_holds_for_regular_grids() {
    hold_mesh("a box", &a_box(), KEYS);
}

/// What undoes something too: the symbols that are no pilots are tested where the pilots agree best among thousands of ways.
fn hold_what_is_undone(keys: u64) {
    let rock = shapes::asteroid(24, 36);
    let undone = solid::Surfaces::new(&rock).first_kind().collect();
    hold_surfaces("what is undone", &undone, keys);
}

#[test]
fn bound_holds_where_something_is_undone() {
    hold_what_is_undone(KEYS / 10);
}

#[test]
#[ignore = "takes minutes: cargo xtask test --all"]
fn bound_holds_for_all_keys() {
    hold_crafted_rings(ALL_RING_KEYS);
    hold_mesh("a box", &a_box(), ALL_KEYS);
    hold_mesh("identical boxes", &identical_boxes(), ALL_KEYS);
    hold_mesh("mirrored pair", &mirrored_pair(), ALL_KEYS);
    hold_mesh("doubled sheets", &doubled_sheets(5e-4), ALL_KEYS);
    hold_pieces("repeated rocks", &repeated_rocks(), ALL_KEYS);
    hold_pieces("a layered rock", &layered_rock(), ALL_KEYS);
    hold_what_is_undone(ALL_KEYS / 10);
    hold_cells(ALL_KEYS);
    hold_charges(60);
}

/// Every charge is one that docs/SECURITY.md declares; and where a search of which nothing was declared has found a place, no pilot
/// testifies.
fn hold_charges(keys: u64) {
    let rings = ring::Measurement::new(&shapes::asteroid(24, 36));
    let surfaces: solid::Measurement = solid::Surfaces::new(&shapes::asteroid(24, 36)).collect();
    let ways = |pitches: f64, turns: f64| [6.0 * pitches * turns, 649.0 * 12.0 * turns];
    let of_kind = |ways: f64| libm::log(3.0 * ways);
    let declared: Vec<f64> = [(1.0, 4.0), (2.0, 4.0), (1.0, 24.0), (2.0, 24.0)]
        .into_iter()
        .flat_map(|(pitches, turns)| ways(pitches, turns))
        .map(of_kind)
        .collect();
    let mut num_split = 0;
    for number in 0..keys {
        let key = random_key(number);
        let own = rings.read(&key);
        assert_eq!(own.hypotheses.len(), 10);
        let is_a_tenth = |charge: f64| (charge - libm::log(10.0)).abs() < 1e-12;
        assert!(own.hypotheses.iter().all(|h| is_a_tenth(h.ln_num_tests)));
        for hypothesis in surfaces.read(&key, &mut ignore).unwrap().hypotheses {
            let charge = hypothesis.ln_num_tests;
            let is_declared = declared
                .iter()
                .any(|of_kind| (charge - of_kind).abs() < 1e-9);
            let is_split = (charge - of_kind(4.0)).abs() < 1e-9;
            assert!(is_declared || is_split, "{}", libm::exp(charge));
            let pilots = hypothesis.symbols.iter();
            let has_pilots = pilots.clone().any(|soft| soft.symbol == Symbol::Pilot);
            assert_eq!(has_pilots, is_declared);
            num_split += u32::from(is_split);
        }
    }
    assert!(num_split > 0, "no search was begun");
}

#[test]
fn charges_are_those_that_are_declared() {
    hold_charges(KEYS / 10);
}

/// A whole and its pieces share the probability: the whole has half, each of n pieces 1 / 2n.
#[test]
fn shares_of_pieces_add_up_to_one() {
    let rocks = repeated_rocks();
    let whole = || solid::Surfaces::new(&rocks).plain();
    let read =
        |measurement: solid::Measurement| measurement.read(&random_key(1), &mut ignore).unwrap();
    let first = |reading: &Reading, piece| {
        let ways = reading.hypotheses.iter();
        let of_piece = ways
            .filter(|way| way.piece == piece)
            .map(|way| way.ln_num_tests);
        of_piece.reduce(f64::max)
    };
    let alone = first(&read(whole().collect()), 0).unwrap();
    for num in 1..=3 {
        let all = (0..=num).flat_map(|_| whole()).collect();
        let reading = read(all);
        let share = |piece| libm::exp(alone - first(&reading, piece).unwrap());
        assert!((share(0) - 0.5).abs() < 1e-9);
        for piece in 1..=num {
            assert!(
                (share(piece) - 0.5 / num as f64).abs() < 1e-9,
                "{piece} of {num}"
            );
        }
    }
}

#[test]
fn bound_holds_for_cells_of_notes() {
    hold_cells(KEYS);
}

/// Cells of a note share nothing either: one direction, equal distances, and distances far beyond the frame.
fn hold_cells(keys: u64) {
    let rock = shapes::asteroid(20, 30);
    let sphere = shapes::icosphere(3);
    let mut far = rock.clone();
    far.positions[0] *= 1e9;
    for (name, mesh) in [("a rock", rock), ("a ball", sphere), ("far", far)] {
        let block = Block::Tc128;
        let word = block.encode(&vec![0x5a; block.message_bytes()]);
        let mut tail = Tail::default();
        for number in 0..keys {
            // Which ways are read depends on all cells' dithers: what is tested is charged for all of them.
            let readings = Cells::new(&random_key(number), block, 0.0125).read(&mesh);
            let ln_ps = readings
                .iter()
                .map(|reading| reading.statistic(&word).ln_p());
            let least = ln_ps.fold(0.0, f64::min);
            tail.add(union(least, libm::log(f64::from(NUM_TESTS))));
        }
        tail.hold(name);
    }
}

/// Verdicts, and what a bound is reported as, of keys that had no part in the rings.
#[test]
fn reported_bounds_hold_for_ten_thousand_keys() {
    let rings: Vec<u8> = (0..400u64)
        .flat_map(|i| {
            ring(
                i,
                i / 2,
                [i as i16 % 20, i as i16 / 20, 0],
                0.001 * (i % 40) as f32,
            )
        })
        .collect();
    let evidence = Evidence::from_iter([Measurement::Ring(
        ring::Measurement::from_bytes(&rings).unwrap(),
    )]);
    let expected = Payload::from_number(99).unwrap();
    let [mut blind, mut informed] = [Tail::default(), Tail::default()];
    for number in 0..10_000 {
        let key = random_key(number);
        blind.add(extract(&evidence, &key).details().ln_p);
        informed.add(verify(&evidence, &key, expected).details().ln_p);
    }
    blind.hold("extract");
    informed.hold("verify");
}

/// Sheets so near each other that fluxes hardly change as a lattice moves: what is sought by their slopes is sought far away. A pitch
/// of nearly nothing ended the detector with this key.
#[test]
fn detector_ends_where_nothing_holds_it() {
    let surfaces = solid::Surfaces::new(&doubled_sheets(1e-5));
    let measurement: solid::Measurement = surfaces.plain().collect();
    assert!(measurement.read(&random_key(162), &mut ignore).is_ok());
}
