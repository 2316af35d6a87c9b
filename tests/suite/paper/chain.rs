//! The paper's system: runs, sparse QIM, spherical coordinates, hosts. Sections and equations are those of Vasic 2012.

use crate::portable_test;
use crate::support::fixtures::{asteroid, key, random};
use glam::DVec3;
use meshmark::internals::attack::{catmull_clark, noise, reorder, similarity, simplify};
use meshmark::internals::carrier::qim::quantize;
use meshmark::internals::code::Block;
use meshmark::internals::geometry::Distortion;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::paper::run_length::{self, Channel};
use meshmark::internals::paper::{
    Barycentre, Chain, Embedded, Ranking, SparseQim, Spherical, rank,
};

const CLEAN: Channel = Channel {
    insertion: 0.0,
    deletion: 0.0,
};

fn bits(text: &str) -> Vec<bool> {
    text.bytes()
        .filter(|byte| *byte != b' ')
        .map(|byte| byte == b'1')
        .collect()
}

/// Evidence of symbols that arrived for sure.
fn sure(symbols: &[bool]) -> Vec<f64> {
    let soft = |&symbol: &bool| if symbol { -20.0 } else { 20.0 };
    symbols.iter().map(soft).collect()
}

fn signs(evidence: &[f64]) -> Vec<bool> {
    evidence.iter().map(|&value| value < 0.0).collect()
}

#[portable_test]
fn section_3b_maps_bits_to_runs() {
    assert_eq!(
        run_length::encode(&bits("011011")),
        bits("11 000 111 00 111 000")
    );
    assert!(run_length::encode(&[]).is_empty());
}

#[portable_test]
fn section_3b_runs_are_cut_again() {
    let sent = bits("0110100011101");
    let symbols = sure(&run_length::encode(&sent));
    assert_eq!(
        signs(&run_length::decode(&symbols, sent.len(), CLEAN)),
        sent
    );
    let longer = [symbols, vec![20.0, -20.0, 20.0]].concat();
    assert_eq!(
        signs(&run_length::decode(&longer, sent.len(), CLEAN)),
        sent,
        "symbols after the last run say nothing"
    );
}

/// A run that lost a symbol or gained one leaves all the others in their places.
#[portable_test]
fn section_3b_losses_and_gains_cost_a_run_at_most() {
    let channel = Channel {
        insertion: 0.02,
        deletion: 0.02,
    };
    let sent = bits("01101000111010010110");
    let symbols = run_length::encode(&sent);
    for place in 0..symbols.len() {
        let (mut lost, mut gained) = (symbols.clone(), symbols.clone());
        lost.remove(place);
        gained.insert(place, symbols[place]);
        for received in [lost, gained] {
            let read = signs(&run_length::decode(&sure(&received), sent.len(), channel));
            let wrong = read.iter().zip(&sent).filter(|(a, b)| a != b).count();
            assert!(wrong <= 2, "{wrong} wrong at {place}");
        }
    }
}

/// Forward-backward against the sum over all bits and all ways of cutting.
#[portable_test]
fn section_3b_decoder_is_exact() {
    const BITS: usize = 3;
    for (case, &(insertion, deletion)) in [(0.0, 0.0), (0.1, 0.2), (0.3, 0.05)].iter().enumerate() {
        let channel = Channel {
            insertion,
            deletion,
        };
        let soft: Vec<f64> = (0..8)
            .map(|place| 4.0 * random(100 * case as u64 + place) - 2.0)
            .collect();
        let decoded = run_length::decode(&soft, BITS, channel);
        for (bit, decoded) in decoded.iter().enumerate() {
            let mut totals = [0.0; 2];
            for word in 0..1usize << BITS {
                let sent: Vec<bool> = (0..BITS).map(|bit| word >> bit & 1 == 1).collect();
                totals[usize::from(sent[bit])] += likelihood(&soft, &sent, true, channel);
            }
            let expected = libm::log(totals[0] / totals[1]);
            assert!((decoded - expected).abs() < 1e-9, "{decoded} {expected}");
        }
    }
}

/// Likelihood of received symbols for what is left to send, every way of cutting them in turn.
fn likelihood(soft: &[f64], sent: &[bool], level: bool, channel: Channel) -> f64 {
    let Some((&bit, rest)) = sent.split_first() else {
        return 1.0;
    };
    let mut total = 0.0;
    let mut run = 1.0;
    for arrived in 0..=soft.len().min(7) {
        if arrived > 0 {
            let one = 2.0 / (1.0 + libm::exp(soft[arrived - 1]));
            run *= if level { one } else { 2.0 - one };
        }
        let length = if bit { 3 } else { 2 };
        let arrives = arrivals(length, arrived, channel);
        total += run * arrives * likelihood(&soft[arrived..], rest, !level, channel);
    }
    total
}

/// Probability that `sent` symbols arrive as `arrived`: the first as any number of them.
fn arrivals(sent: usize, arrived: usize, channel: Channel) -> f64 {
    if sent == 0 {
        return if arrived == 0 { 1.0 } else { 0.0 };
    }
    let first = |copies: usize| match copies {
        0 => channel.deletion,
        _ => {
            let further = libm::pow(channel.insertion, (copies - 1) as f64);
            (1.0 - channel.deletion) * (1.0 - channel.insertion) * further
        }
    };
    (0..=arrived)
        .map(|copies| first(copies) * arrivals(sent - 1, arrived - copies, channel))
        .sum()
}

/// A likelihood of so many symbols is smaller than any number.
#[portable_test]
fn run_length_survives_length() {
    let sent: Vec<bool> = (0..2000).map(|place| random(place) < 0.5).collect();
    let soft: Vec<f64> = sure(&run_length::encode(&sent))
        .iter()
        .map(|v| 0.2 * v)
        .collect();
    assert_eq!(signs(&run_length::decode(&soft, sent.len(), CLEAN)), sent);
}

#[portable_test]
fn run_length_survives_nothing_and_nonsense() {
    assert_eq!(run_length::decode(&[], 3, CLEAN), [0.0; 3]);
    let nonsense = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0];
    let decoded = run_length::decode(&nonsense, 2, CLEAN);
    assert!(decoded.iter().all(|value| value.is_finite()), "{decoded:?}");
}

/// Q_u(x) = D [(x - (-1)^(u+1) D/4) / D] + (-1)^(u+1) D/4.
#[portable_test]
fn equation_5_quantizes_to_a_quarter_above_or_below() {
    let step = 0.8;
    for place in 0..200 {
        let x = 10.0 * random(place) - 5.0;
        for (bit, offset) in [(false, -0.2), (true, 0.2)] {
            let y = quantize(x, bit, step);
            assert!((y - x).abs() <= 0.4 + 1e-12, "no farther than half a step");
            let level = (y - offset) / step;
            assert!((level - level.round()).abs() < 1e-9, "{y} for {bit}");
            assert_eq!(quantize(y, bit, step), y);
        }
    }
    assert_eq!(quantize(0.0, true, 1.0), 0.25, "up for a 1");
    assert_eq!(quantize(0.0, false, 1.0), -0.25, "down for a 0");
}

/// y = x + (Q_u(x.p) - x.p) p.
#[portable_test]
fn equation_6_moves_along_a_keyed_unit_vector() {
    let qim = SparseQim::new(&key(3), 3, 0.1);
    let mut moves = Vec::new();
    for symbol in 0..50 {
        let x: Vec<f64> = (0..3).map(|i| random(3 * symbol + i)).collect();
        let [zero, one] = [false, true].map(|bit| {
            let y = qim.embed(&x, symbol as usize, bit);
            let again = qim.embed(&y, symbol as usize, bit);
            assert!(y.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-12));
            DVec3::from_slice(&y) - DVec3::from_slice(&x)
        });
        assert!(zero.length() <= 0.05 + 1e-12 && one.length() <= 0.05 + 1e-12);
        assert!(
            zero.cross(one).length() < 1e-12,
            "both along p: {zero} {one}"
        );
        let apart = (zero - one).length() / 0.05;
        assert!((apart - apart.round()).abs() < 1e-9 && apart.round() % 2.0 == 1.0);
        moves.push((zero - one).normalize());
    }
    let mean: DVec3 = moves.iter().sum::<DVec3>() / 50.0;
    assert!(mean.length() < 0.4, "p is another for every symbol: {mean}");
}

/// u = argmin |r.p - Q_u(r.p)|.
#[portable_test]
fn equation_7_recovers_the_bit() {
    let (qim, other) = (
        SparseQim::new(&key(3), 3, 0.1),
        SparseQim::new(&key(4), 3, 0.1),
    );
    let mut strangers = 0;
    for symbol in 0..200 {
        let bit = random(9000 + symbol) < 0.5;
        let x: Vec<f64> = (0..3).map(|i| random(3 * symbol + i)).collect();
        let y = qim.embed(&x, symbol as usize, bit);
        let evidence = qim.evidence(&y, symbol as usize);
        assert_eq!(evidence < 0.0, bit, "the offsets of eq. 5 agree in both");
        assert!((evidence.abs() - 3.125).abs() < 1e-6, "{evidence}");
        // Disturbed by less than a quarter of a step, along whatever direction.
        let disturbed: Vec<f64> = y.iter().map(|y| y + 0.024 / 3f64.sqrt()).collect();
        let evidence = qim.evidence(&disturbed, symbol as usize);
        assert_eq!(evidence < 0.0, bit);
        strangers += usize::from((other.evidence(&y, symbol as usize) < 0.0) == bit);
    }
    assert!((70..130).contains(&strangers), "{strangers}");
}

#[portable_test]
fn spherical_coordinates_follow_a_similarity() {
    let mesh = asteroid();
    let turned = similarity(&mesh, 5);
    for barycentre in [Barycentre::Vertices, Barycentre::Area, Barycentre::Volume] {
        let [a, b] = [&mesh, &turned].map(|mesh| Spherical::of(mesh, barycentre).unwrap());
        for (p, q) in mesh.positions.iter().zip(&turned.positions) {
            assert!((a.radius(*p) - b.radius(*q)).abs() < 1e-9, "{barycentre:?}");
            assert!(a.at_radius(*p, a.radius(*p)).distance(*p) < 1e-12);
        }
    }
    assert_eq!(Spherical::of(&Mesh::default(), Barycentre::Vertices), None);
}

/// The mean of the vertices follows the tessellation; those of area and volume do not.
#[portable_test]
fn spherical_barycentres_and_tessellation() {
    let mesh = shapes::asteroid(60, 80);
    let coarse = simplify(&mesh, 0.5);
    let change = |barycentre| {
        let [a, b] = [&mesh, &coarse].map(|mesh| Spherical::of(mesh, barycentre).unwrap());
        let points = mesh.positions.iter();
        let changes = points.map(|&p| (a.radius(p) - b.radius(p)).abs());
        changes.fold(0.0, f64::max)
    };
    let [vertices, area, volume] =
        [Barycentre::Vertices, Barycentre::Area, Barycentre::Volume].map(change);
    assert!(
        vertices > 5.0 * area && vertices > 5.0 * volume,
        "{vertices} {area} {volume}"
    );
}

const MESSAGE: [u8; 8] = *b"Bata Vas";

/// 5 002 vertices, all hosts, the most stable first.
fn marked(rms_rel: f64) -> (Mesh, Vec<u32>, Embedded) {
    let mesh = shapes::asteroid(50, 100);
    let hosts = rank(&mesh, Ranking::Collapse).order;
    let embedded = chain(&key(1))
        .embed(&mesh, &hosts, &MESSAGE, rms_rel)
        .unwrap();
    (mesh, hosts, embedded)
}

fn chain(key: &meshmark::Key) -> Chain<'_> {
    Chain {
        key,
        block: Block::Tc128,
        barycentre: Barycentre::Vertices,
    }
}

fn known(hosts: &[u32]) -> Vec<Option<u32>> {
    hosts.iter().map(|&host| Some(host)).collect()
}

#[portable_test]
fn chain_is_read_where_the_indices_are_known() {
    let (mesh, hosts, embedded) = marked(8e-4);
    let moved = Distortion::between(&mesh.positions, &embedded.mesh.positions);
    assert!((moved.rms_rel / 8e-4 - 1.0).abs() < 0.05, "{moved:?}");
    assert_eq!(moved.num_moved, 3 * embedded.symbols.len());
    let key = key(1);
    for suspect in [
        embedded.mesh.clone(),
        similarity(&embedded.mesh, 1),
        noise(&embedded.mesh, 0.001, 1),
        catmull_clark(&embedded.mesh, 1),
    ] {
        let read = chain(&key).read_traced(&suspect, &known(&hosts), embedded.step);
        let read = read.unwrap();
        assert!(read.decoded.is_codeword);
        assert_eq!(read.decoded.message, MESSAGE);
        let (wrong, lost) = read.symbol_errors(&embedded.symbols);
        assert!(wrong < 0.05 && lost == 0.0, "{wrong}");
    }
    let mut some = known(&hosts);
    some.iter_mut().step_by(17).for_each(|host| *host = None);
    let read = chain(&key).read_traced(&embedded.mesh, &some, embedded.step);
    let read = read.unwrap();
    let (wrong, lost) = read.symbol_errors(&embedded.symbols);
    assert!(wrong == 0.0 && (0.1..0.25).contains(&lost), "{lost}");
    assert_eq!(read.decoded.message, MESSAGE, "lost hosts are erasures");
}

/// The paper's assumption is what it stands on: with nothing but the suspect's own ranking half of the bits are wrong, though
/// nothing has happened to the mesh but the mark.
#[portable_test]
fn chain_is_lost_where_hosts_are_ranked_again() {
    let (_, _, embedded) = marked(8e-4);
    let key = key(1);
    let read = chain(&key).read_ranked(&embedded.mesh, Ranking::Collapse, embedded.step);
    let read = read.unwrap();
    assert!(!read.decoded.is_codeword);
    let wrong: u32 = read
        .decoded
        .message
        .iter()
        .zip(MESSAGE)
        .map(|(a, b)| (a ^ b).count_ones())
        .sum();
    assert!((16..48).contains(&wrong), "{wrong} of 64 bits");
}

#[portable_test]
fn chain_says_nothing_to_another_key() {
    let (_, hosts, embedded) = marked(8e-4);
    let key = key(2);
    let read = chain(&key).read_traced(&embedded.mesh, &known(&hosts), embedded.step);
    let read = read.unwrap();
    assert!(!read.decoded.is_codeword);
    let (wrong, _) = read.symbol_errors(&embedded.symbols);
    assert!((0.35..0.65).contains(&wrong), "{wrong}");
}

/// Eq. 1: whoever has the original needs no indices.
#[portable_test]
fn equation_1_reads_with_the_original() {
    let (mesh, hosts, embedded) = marked(8e-4);
    let suspect = similarity(&reorder(&embedded.mesh, 3), 4);
    let key = key(1);
    let read = chain(&key).read_with_original(&suspect, &mesh, &hosts, embedded.step);
    let read = read.unwrap();
    assert_eq!(read.decoded.message, MESSAGE);
    let (wrong, lost) = read.symbol_errors(&embedded.symbols);
    assert!(wrong < 0.1 && lost == 0.0, "{wrong}");
}

#[portable_test]
fn chain_refuses_too_few_hosts() {
    let mesh = asteroid();
    let hosts: Vec<u32> = (0..1151).collect();
    let key = key(1);
    let error = chain(&key).embed(&mesh, &hosts, &MESSAGE, 8e-4);
    assert_eq!(error.unwrap_err().code(), "carrier.too-few-hosts");
    assert_eq!(Chain::num_hosts(Block::Tc128), 1152);
    assert_eq!(Chain::capacity(1151), None);
    assert_eq!(Chain::capacity(5000), Some(Block::Tc512));
}
