//! The paper's chain: message -> LDPC -> runs -> sparse QIM -> mesh, and back.

use super::run_length::{self, Channel};
use super::sparse_qim::SparseQim;
use super::spherical::{Barycentre, Spherical};
use crate::carrier::CarrierError;
use crate::code::{Block, Decoded};
use crate::geometry::diagonal;
use crate::key::Key;
use crate::mesh::Mesh;
use glam::DVec3;

/// L, the elements of a symbol: with three, the shortest block needs about the 1000 hosts of the paper.
const ELEMENTS: usize = 3;

/// Moving hosts moves the barycentre and the scale that their distances are measured by: after so many rounds no more.
const ROUNDS: usize = 5;

/// What embedder and detector agree on.
#[derive(Clone, Copy)]
pub struct Chain<'a> {
    /// Whose mark it is.
    pub key: &'a Key,
    /// The code.
    pub block: Block,
    /// What distances are measured from, and in.
    pub barycentre: Barycentre,
}

/// A mesh after embedding, and what a detector has to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Embedded {
    /// The marked mesh.
    pub mesh: Mesh,
    /// Step of the quantizers, in units of the scale.
    pub step: f64,
    /// The symbols that were written, in the order of the hosts: [`Chain::ELEMENTS`] hosts each.
    pub symbols: Vec<bool>,
}

/// What came out of a suspect.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// Evidence `ln P(0) / P(1)` of each symbol; `None` where one of its hosts is lost.
    pub symbols: Vec<Option<f64>>,
    /// What the codes made of it.
    pub decoded: Decoded,
}

impl Chain<'_> {
    /// Hosts of one symbol.
    pub const ELEMENTS: usize = ELEMENTS;

    /// Hosts that a message may need: where all of its code bits are 1.
    pub fn num_hosts(block: Block) -> usize {
        3 * block.code_bits() * ELEMENTS
    }

    /// The longest block for which a number of hosts is enough.
    pub fn capacity(num_hosts: usize) -> Option<Block> {
        let fits = |block: &Block| Chain::num_hosts(*block) <= num_hosts;
        Block::ALL.into_iter().rev().find(fits)
    }

    /// Writes a message into hosts, the most stable first, so that the RMS displacement over all vertices is the given fraction
    /// of the diagonal. Hosts are vertices of the mesh, each named once.
    pub fn embed(
        &self,
        mesh: &Mesh,
        hosts: &[u32],
        message: &[u8],
        rms_rel: f64,
    ) -> Result<Embedded, CarrierError> {
        let needed = Chain::num_hosts(self.block);
        let too_few = CarrierError::TooFewHosts {
            needed,
            available: hosts.len(),
        };
        let Some(spherical) = Spherical::of(mesh, self.barycentre) else {
            return Err(too_few);
        };
        if hosts.len() < needed {
            return Err(too_few);
        }
        let symbols = run_length::encode(&self.block.encode(message));
        // A symbol moves its hosts by an error that is uniform over a step, along a unit vector.
        let share = mesh.positions.len() as f64 / symbols.len() as f64;
        let length = rms_rel * diagonal(&mesh.positions) / spherical.scale;
        let step = length * (12.0 * share).sqrt();
        let qim = SparseQim::new(self.key, ELEMENTS, step);
        let mut marked = mesh.clone();
        for _ in 0..ROUNDS {
            let Some(spherical) = Spherical::of(&marked, self.barycentre) else {
                break;
            };
            let (groups, _) = hosts.as_chunks::<ELEMENTS>();
            for (number, (group, &symbol)) in groups.iter().zip(&symbols).enumerate() {
                let points = group.map(|host| marked.positions[host as usize]);
                let radii = points.map(|point| spherical.radius(point));
                let moved = qim.embed(&radii, number, symbol);
                for ((&host, point), radius) in group.iter().zip(points).zip(moved) {
                    marked.positions[host as usize] = spherical.at_radius(point, radius);
                }
            }
        }
        Ok(Embedded {
            mesh: marked,
            step,
            symbols,
        })
    }

    /// Reads a message from where the hosts are now, in the order of embedding; `None` for those that are lost, which are erasures
    /// of their symbols. The channel says what else may have happened to the order. Hosts beyond the message's do no harm.
    pub fn read(
        &self,
        spherical: &Spherical,
        hosts: impl Iterator<Item = Option<DVec3>>,
        step: f64,
        channel: Channel,
    ) -> Received {
        let qim = SparseQim::new(self.key, ELEMENTS, step);
        let radii: Vec<Option<f64>> = hosts
            .take(Chain::num_hosts(self.block))
            .map(|host| host.map(|point| spherical.radius(point)))
            .collect();
        let (groups, _) = radii.as_chunks::<ELEMENTS>();
        let evidence = |(number, group): (usize, &[Option<f64>; ELEMENTS])| {
            let group: Option<Vec<f64>> = group.iter().copied().collect();
            group.map(|radii| qim.evidence(&radii, number))
        };
        let symbols: Vec<Option<f64>> = groups.iter().enumerate().map(evidence).collect();
        let soft: Vec<f64> = symbols.iter().map(|soft| soft.unwrap_or(0.0)).collect();
        let bits = run_length::decode(&soft, self.block.code_bits(), channel);
        Received {
            symbols,
            decoded: self.block.decode(&bits),
        }
    }
}

impl Received {
    /// Share of the symbols that arrived with the wrong sign, 0 to 1, and share of those that were lost.
    pub fn symbol_errors(&self, sent: &[bool]) -> (f64, f64) {
        let pairs = sent.iter().zip(&self.symbols);
        let arrived = pairs.filter_map(|(sent, got)| Some((*sent, got.as_ref()?)));
        let (count, wrong) = arrived.fold((0, 0), |(count, wrong), (sent, got)| {
            (count + 1, wrong + usize::from((*got < 0.0) != sent))
        });
        let lost = 1.0 - f64::from(count) / sent.len().max(1) as f64;
        (wrong as f64 / f64::from(count.max(1)), lost)
    }
}
