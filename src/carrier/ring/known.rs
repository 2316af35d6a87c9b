//! Reading with the original: the rings whose vertices a suspect kept.
//!
//! Who a ring is, the original says. So a suspect needs no triangle of it: it may have others, and next to nothing around the ring.

use super::address;
use super::embed::Prepared;
use super::feature::Features;
use super::{Ownership, STEP};
use crate::carrier::{Host, Place, Way};
use crate::geometry::Pose;
use crate::key::Key;
use glam::DVec3;

/// How much a ring counts beside a window. A window's response is the likeliest error, so the tilt that makes a sum of weak windows most
/// surprising is about 12, the inverse of an error's variance. At that tilt a ring with this counts as the logarithm of its likelihood where features
/// are off by a sixth of half a step, as they are after an embedding.
const RESPONSE: f64 = 0.5;

/// The rings of an original that may carry symbols.
pub struct Known {
    prepared: Prepared,
    /// Vertices by the addresses of their rings, ascending.
    rings: Vec<(u64, u32)>,
}

impl Known {
    /// Of an original, as an embedder would have it as a host; `None` where RING has too few addresses.
    pub fn new(host: &Host) -> Option<Known> {
        let prepared = Prepared::new(host).ok()?;
        let features = Features::new(&host.mesh.positions, &prepared.neighbourhoods);
        let addresses = prepared.addresses(host.mesh, &features, Pose::of(host.mesh).as_ref());
        let carriers = address::carriers(&addresses, &features.usable, &prepared.instances);
        let carriers = carriers.into_iter();
        let mut rings: Vec<_> = carriers.map(|v| (addresses[v as usize], v)).collect();
        rings.sort_unstable();
        Some(Known { prepared, rings })
    }

    /// What a key reads where the original's V vertices are at `positions` in a suspect that lies on it, in the original's scene units, no numbers for
    /// those that it has not kept: one way, with a place for each address; `None` where no ring of the key's was kept.
    pub fn read(&self, positions: &[DVec3], key: &Key) -> Option<Way> {
        let features = Features::new(positions, &self.prepared.neighbourhoods);
        let ownership = Ownership::of(key);
        let is_kept = |vertex: u32| features.usable.binary_search(&vertex).is_ok();
        let mut kept = self.rings.clone();
        kept.retain(|&(_, vertex)| is_kept(vertex));
        kept.dedup_by_key(|(address, _)| *address);
        let mut radius = 0.0_f64;
        let mut place = |(address, vertex): (u64, u32)| {
            let owned = ownership.get(address)?;
            let vertex = vertex as usize;
            radius = radius.max(features.sizes[vertex]);
            let phase = features.offsets[vertex] / STEP + owned.dither;
            let nearness = |coset: f64| {
                let phase = phase - coset;
                0.5 - 2.0 * (phase - phase.round()).abs()
            };
            Some(Place {
                symbol: owned.symbol,
                response: RESPONSE,
                errors: [nearness(0.5), nearness(0.0)],
                centre: positions[vertex],
            })
        };
        let places: Vec<Place> = kept.into_iter().filter_map(&mut place).collect();
        (!places.is_empty()).then_some(Way {
            places,
            ln_num_tests: 0.0,
            list: 0,
            radius,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::detection::ln_p_of_errors;
    use crate::geometry::{Bounds, Leeway, Parts};
    use crate::mesh::{Admissible, shapes};

    /// docs/SECURITY.md, "With the original", 1.
    #[test]
    fn known_rings_are_uniform_to_wrong_keys() {
        let mesh = shapes::asteroid(40, 60);
        let (parts, admissible) = (Parts::new(&mesh), Admissible::default());
        let known = Known::new(&Host {
            mesh: &mesh,
            leeway: &Leeway::new(&mesh, &parts, Bounds::HIDDEN),
            admissible: &admissible,
            rms_rel: 0.0004,
            hidden: true,
            share: 1.0,
            on_top: None,
        });
        let is_kept = |p: &DVec3| p.x > -0.2;
        let positions = mesh.positions.iter();
        let positions: Vec<DVec3> = positions
            .map(|p| if is_kept(p) { *p } else { DVec3::NAN })
            .collect();
        let (mut errors, mut ln_ps) = (Vec::new(), Vec::new());
        for number in 0..200 {
            let key = Key::from_bytes(&[number; Key::BYTES]).unwrap();
            let way = known.as_ref().unwrap().read(&positions, &key).unwrap();
            assert!(way.places.iter().all(|place| is_kept(&place.centre)));
            let terms = way.places.iter().map(|p| (p.response, p.errors[1]));
            ln_ps.push(ln_p_of_errors(terms));
            errors.extend(way.places.iter().flat_map(|place| place.errors));
        }
        errors.sort_by(f64::total_cmp);
        let num = errors.len() as f64;
        let places = errors.iter().enumerate();
        let off = places.map(|(place, error)| (error + 0.5 - place as f64 / num).abs());
        // Kolmogorov's distance, which chance exceeds once in 3000.
        assert!(off.fold(0.0, f64::max) < 2.0 / num.sqrt(), "of {num}");
        for p in [0.3_f64, 0.1, 0.03] {
            let below = ln_ps.iter().filter(|ln_p| **ln_p <= libm::log(p)).count();
            assert!(below as f64 <= p * ln_ps.len() as f64, "{below} below {p}");
        }
    }
}
