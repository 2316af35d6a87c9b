//! Where a mark's symbols live in geometry. Knows meshes and keys; knows nothing of files, attacks or verdicts.
//!
//! [`Carrier`] is the door to all of them, for embedding and for reading: `embed` finds the displacement that gives symbols the
//! signs of a codeword, `measure` takes from a mesh all that needs no key, and a [`Measurement`] and a key make soft symbols, one
//! list for each hypothesis that was declared in advance. Nobody outside this room names a carrier by hand.

pub mod direction;
mod error;
pub mod local;
pub mod qim;
mod reading;
pub mod ring;
pub mod solid;

pub use error::{CarrierError, StoredError};
pub(crate) use error::{possible, take};
pub use reading::{Hypothesis, Place, Reading, Way};
pub use ring::Known; // reading with the original
pub use solid::{Choice, Chosen};
pub use solid::{Frames, Recorded, Seen}; // reading with the original, or with a record

use crate::code::Codeword;
use crate::geometry::{Leeway, Piece};
use crate::key::Key;
use crate::mesh::{Admissible, Mesh};
use crate::progress::{Cancelled, Progress, ignore};
use glam::DVec3;

/// A carrier: a place in geometry where a mark can live.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Carrier {
    /// In the shape, whatever its triangles are: flux through windows of a keyed lattice.
    Solid,
    /// In how vertices are connected: their offsets from their one-rings.
    Ring,
    /// In the shape about salient places, which are still there in a piece that was cut out and remeshed. It is used where it is asked for,
    /// beside SOLID, and holds no payload.
    #[cfg(feature = "local")]
    Local,
}

impl Carrier {
    /// Every carrier, in the order of embedding: RING comes last, for it takes least.
    #[cfg(feature = "local")]
    pub const ALL: [Carrier; 3] = [Carrier::Solid, Carrier::Local, Carrier::Ring];
    /// Every carrier, in the order of embedding.
    #[cfg(not(feature = "local"))]
    pub const ALL: [Carrier; 2] = Carrier::STANDARD;

    /// Those that mark and are read unless others are asked for.
    pub const STANDARD: [Carrier; 2] = [Carrier::Solid, Carrier::Ring];

    /// The same, in the order of measuring and of stored evidence: what takes little time comes first.
    pub(crate) const QUICKEST_FIRST: [Carrier; 2] = [Carrier::Ring, Carrier::Solid];

    /// The share of the RMS limit that a carrier may take on top of another one: RING's step is a fraction of an edge, so dense
    /// meshes need no more, and on coarse ones more would drown what SOLID wrote.
    pub(crate) const SHARE_ON_TOP: f64 = 0.25;

    /// The share of the RMS limit that SOLID and LOCAL take, each, where both are in a model: what they move is not alike, so together they
    /// take the root of the sum of the squares, which is the whole.
    pub(crate) const SHARE_BESIDE: f64 = std::f64::consts::FRAC_1_SQRT_2;

    /// The name that scripts and pages use: `solid`, `ring` or `local`.
    pub fn name(self) -> &'static str {
        match self {
            Carrier::Solid => "solid",
            Carrier::Ring => "ring",
            #[cfg(feature = "local")]
            Carrier::Local => "local",
        }
    }

    /// The carrier of a name.
    pub fn from_name(name: &str) -> Option<Carrier> {
        Self::ALL.into_iter().find(|carrier| carrier.name() == name)
    }

    /// The displacement of all V vertices that gives the host the mark, whatever it then holds.
    #[doc(hidden)]
    pub fn embed(
        self,
        host: &Host,
        mark: &Mark,
        progress: &mut dyn Progress,
    ) -> Result<Embedded, CarrierError> {
        self.embed_above(host, mark, &[], progress)
    }

    /// The same in a host where SOLID chose so: LOCAL leaves those windows as they are, nearly.
    #[cfg_attr(not(feature = "local"), allow(unused_variables))] // LOCAL alone looks at that
    pub(crate) fn embed_above(
        self,
        host: &Host,
        mark: &Mark,
        chosen: &[solid::Chosen],
        progress: &mut dyn Progress,
    ) -> Result<Embedded, CarrierError> {
        match self {
            Carrier::Solid => solid::embed(host, mark, progress),
            Carrier::Ring => ring::embed(host, mark, progress),
            #[cfg(feature = "local")]
            Carrier::Local => local::embed_above(host, mark.key, chosen, progress),
        }
    }

    /// Whether a mesh has what it takes beside SOLID.
    #[cfg_attr(not(feature = "local"), allow(unused_variables))] // LOCAL alone looks at that
    pub(crate) fn is_beside_solid(self, mesh: &Mesh) -> bool {
        match self {
            Carrier::Solid | Carrier::Ring => false,
            #[cfg(feature = "local")]
            Carrier::Local => local::suits(mesh),
        }
    }

    /// Whether it can say a payload; else it says whose a model is, and nothing else.
    pub(crate) fn holds_payload(self) -> bool {
        Carrier::STANDARD.contains(&self)
    }

    /// Its share in the probability of a false alarm (docs/SECURITY.md, 7). LOCAL has one whether it is read or not, and is compiled or not:
    /// so it may be read after the others have said nothing.
    pub(crate) fn share(self) -> f64 {
        const LOCAL: f64 = 1.0 / 16.0;
        if self.holds_payload() {
            0.5 * (1.0 - LOCAL)
        } else {
            LOCAL
        }
    }

    /// A host, ready for any message under a key, as an embedding chose; none where it cannot hold one. RING's is ready whatever SOLID
    /// does below it.
    pub(crate) fn prepare(
        self,
        host: &Host,
        key: &Key,
        chosen: &[solid::Chosen],
    ) -> Option<Prepared> {
        match self {
            Carrier::Solid => Some(Prepared::Solid(solid::Prepared::new(host, key, chosen))),
            Carrier::Ring => ring::Prepared::new(host).ok().map(Prepared::Ring),
            #[cfg(feature = "local")]
            Carrier::Local => None,
        }
    }

    /// Measures and reads in one go, measuring no more than it takes to find a mark: nothing beyond the suspect as it is where that
    /// `is_settled`.
    pub(crate) fn read_until(
        self,
        mesh: &Mesh,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        match self {
            Carrier::Solid => solid::Suspect::new(mesh).read_until(key, is_settled, progress),
            Carrier::Ring => Ok(ring::Measurement::new(mesh).read(key)),
            #[cfg(feature = "local")]
            Carrier::Local => local::Measurement::new(mesh).read(key, progress),
        }
    }

    /// The same of a mesh to which nothing was done but to turn it: nothing is undone.
    pub(crate) fn read_untouched(
        self,
        mesh: &Mesh,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        match self {
            Carrier::Solid => solid::Suspect::new(mesh)
                .with(solid::Surfaces::untouched)
                .read_until(key, is_settled, progress),
            _ => self.read_until(mesh, key, is_settled, progress),
        }
    }

    /// The same of a mesh that lies on a host, and was read there: how it was turned and stretched is known, if the host has axes that say so.
    pub(crate) fn read_beside(
        self,
        mesh: &Mesh,
        host: &Mesh,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        match self {
            Carrier::Solid if solid::has_axes(host) => solid::Suspect::new(mesh)
                .known_to_lie()
                .read_until(key, is_settled, progress),
            _ => self.read_until(mesh, key, is_settled, progress),
        }
    }

    /// The same of a mesh as it is, in its own frame.
    pub(crate) fn read_at_once(
        self,
        mesh: &Mesh,
        key: &Key,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        match self {
            Carrier::Solid => solid::Suspect::as_it_is(mesh).read_until(key, &|_| true, progress),
            Carrier::Ring => Ok(ring::Measurement::new(mesh).read(key)),
            #[cfg(feature = "local")]
            Carrier::Local => local::Measurement::new(mesh).read(key, progress),
        }
    }

    /// The same of a copy of a host that is at hand, with less patience: for nobody has turned it, and whether it was smoothed is known.
    pub(crate) fn read_copy(
        self,
        copy: &Mesh,
        host: &KnownHost,
        is_smoothed: bool,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        match self {
            Carrier::Solid => {
                let suspect = solid::Suspect::copied(copy, &host.surfaces, host.in_pieces);
                let suspect = suspect.with(|surfaces| match is_smoothed {
                    true => surfaces.first_kind(),
                    false => surfaces.plain(),
                });
                suspect.read_until(key, is_settled, progress)
            }
            Carrier::Ring => Ok(ring::Measurement::new(copy).read(key)),
            #[cfg(feature = "local")]
            Carrier::Local => local::Measurement::new(copy).read(key, progress),
        }
    }

    /// Whether a shape has axes of its own, by which a mark in it is found at once.
    pub(crate) fn has_axes(mesh: &Mesh) -> bool {
        solid::has_axes(mesh)
    }

    /// The triangles of a piece of a mesh, by its number in readings.
    pub(crate) fn piece(mesh: &Mesh, number: usize) -> Option<Piece> {
        solid::piece(mesh, number)
    }

    /// The exponent that is to be hoped for where so many addresses can be read, whichever are a key's: a verdict must not say that.
    pub(crate) fn most_exponent(self, num_addresses: usize) -> f64 {
        match self {
            // A surface is read at a pitch or not at all, which no key has a part in; one that is read has 680 squared pitches or
            // more, and a window for each: some hundreds of nats, where a mark that can be found needs 70.
            Carrier::Solid if num_addresses > 0 => f64::INFINITY,
            Carrier::Solid => 0.0,
            // A key owns a share of them, and n of equal weight that agree give ln p = -n.
            Carrier::Ring => num_addresses as f64 / ring::SHARE as f64,
            // It speaks where it is found: that a suspect has few places is no reason to say that it cannot be checked.
            #[cfg(feature = "local")]
            Carrier::Local => 0.0,
        }
    }

    /// Whether somebody who has a marked copy, and no key, can carry its mark over to a model of another shape: how each vertex sits
    /// among its neighbours can be given to vertices that have such neighbours elsewhere.
    pub(crate) fn can_be_carried_over(self) -> bool {
        self == Carrier::Ring
    }
}

/// A carrier whose measurement evidence keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stored {
    Ring,
    Solid,
}

impl Stored {
    /// In the order of [`Carrier::QUICKEST_FIRST`].
    pub(crate) const ALL: [Stored; 2] = [Stored::Ring, Stored::Solid];

    /// The carrier.
    pub(crate) fn carrier(self) -> Carrier {
        match self {
            Stored::Solid => Carrier::Solid,
            Stored::Ring => Carrier::Ring,
        }
    }

    /// What a mesh shows without a key.
    pub(crate) fn measure(self, mesh: &Mesh) -> Measurement {
        match self {
            Stored::Solid => Measurement::Solid(solid::Measurement::new(mesh)),
            Stored::Ring => Measurement::Ring(ring::Measurement::new(mesh)),
        }
    }

    /// The tag of its section in stored evidence.
    pub(crate) fn section(self) -> &'static [u8; 4] {
        match self {
            Stored::Solid => b"SOLI",
            Stored::Ring => b"RING",
        }
    }

    /// A measurement from its bytes; of none, one that shows nothing.
    pub(crate) fn measurement_from(self, bytes: &[u8]) -> Result<Measurement, StoredError> {
        Ok(match self {
            Stored::Solid => Measurement::Solid(solid::Measurement::from_bytes(bytes)?),
            Stored::Ring => Measurement::Ring(ring::Measurement::from_bytes(bytes)?),
        })
    }
}

/// What a carrier measures of a mesh, and evidence keeps.
#[derive(Clone, Debug, PartialEq)]
pub enum Measurement {
    /// SOLID's.
    Solid(solid::Measurement),
    /// RING's.
    Ring(ring::Measurement),
}

impl Measurement {
    /// Whose measurement it is.
    pub fn carrier(&self) -> Carrier {
        match self {
            Measurement::Solid(_) => Carrier::Solid,
            Measurement::Ring(_) => Carrier::Ring,
        }
    }

    /// The soft symbols of a key; those of the suspect as it is where they settle all.
    pub fn read_until(&self, key: &Key, is_settled: &dyn Fn(&Reading) -> bool) -> Reading {
        match self {
            Measurement::Solid(solid) => solid
                .read_until(key, is_settled, &mut ignore)
                .unwrap_or_default(),
            Measurement::Ring(ring) => ring.read(key),
        }
    }

    /// The measurement as bytes: the content of its section in stored evidence.
    pub fn to_bytes(&self) -> Vec<u8> {
        match self {
            Measurement::Solid(solid) => solid.to_bytes(),
            Measurement::Ring(ring) => ring.to_bytes(),
        }
    }
}

/// An unmarked host that is at hand when its copies are read.
pub(crate) struct KnownHost {
    surfaces: solid::Surfaces,
    in_pieces: bool,
}

impl KnownHost {
    /// `in_pieces`: whether its pieces were marked, each in its own frame.
    pub(crate) fn new(host: &Mesh, in_pieces: bool) -> KnownHost {
        let surfaces = solid::Surfaces::new(host);
        KnownHost {
            surfaces,
            in_pieces,
        }
    }
}

/// What is to be marked.
pub struct Host<'a> {
    /// The mesh, in scene units.
    pub mesh: &'a Mesh,
    /// How far its vertices may go from where they were before any carrier moved them.
    pub leeway: &'a Leeway<'a>,
    /// Which displacements can be written back.
    pub admissible: &'a Admissible,
    /// Limit of the RMS displacement over all vertices, as a fraction of the diagonal.
    pub rms_rel: f64,
    /// The share of that limit, and of what stays unseen, that this carrier may take: 1 where no other comes beside it.
    pub share: f64,
    /// Whether to stay below that limit where the surface is too smooth to hide it.
    pub hidden: bool,
    /// Where another carrier's mark is in the mesh already: the limit of the RMS displacement about each vertex, in scene units. It follows
    /// the size of what that mark lies in, object by object.
    pub on_top: Option<&'a [f64]>,
}

/// A mark in a host.
#[derive(Debug)]
pub struct Embedded {
    /// The displacement of all V vertices.
    pub displacement: Vec<DVec3>,
    /// Which carrier holds it.
    pub carrier: Carrier,
    /// The exponent of the bound: of SOLID's, what is left when a web pipeline has rounded the positions.
    pub exponent: f64,
    /// What that has to be.
    pub needs: Needs,
    /// What was chosen for each frame, of SOLID's: with that another message is embedded more quickly.
    pub chosen: Vec<solid::Chosen>,
}

/// Exponents that a mark needs, in nats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needs {
    /// To hold a payload, and to stand what else happens to models.
    pub sturdy: f64,
    /// To hold a payload at all.
    pub payload: f64,
    /// To say whose a model is.
    pub presence: f64,
}

impl Embedded {
    /// How much of what a payload needs it reaches.
    pub fn share(&self) -> f64 {
        self.exponent / self.needs.payload
    }

    /// That it cannot hold a payload.
    pub fn without_payload(&self) -> CarrierError {
        CarrierError::NoPayload {
            carrier: self.carrier,
            reached: self.exponent,
            needed: self.needs.payload,
        }
    }

    /// Whether it holds a payload, and stands what else happens to models.
    pub fn is_sturdy(&self) -> bool {
        self.exponent >= self.needs.sturdy
    }
}

/// A host that is ready for further messages.
pub(crate) enum Prepared {
    /// SOLID's.
    Solid(solid::Prepared),
    /// RING's.
    Ring(ring::Prepared),
}

impl Prepared {
    /// Whose it is.
    pub fn carrier(&self) -> Carrier {
        match self {
            Prepared::Solid(_) => Carrier::Solid,
            Prepared::Ring(_) => Carrier::Ring,
        }
    }

    /// Whether the mark is in objects of a scene, each in its own frame.
    pub fn is_in_objects(&self) -> bool {
        match self {
            Prepared::Solid(solid) => solid.is_in_objects(),
            Prepared::Ring(_) => false,
        }
    }

    /// What a key reads of a marked copy as it is, where a detector finds the mark at once.
    pub fn read(&self, copy: &Mesh, key: &Key) -> Reading {
        match self {
            Prepared::Solid(_) => Carrier::Solid
                .read_at_once(copy, key, &mut ignore)
                .unwrap_or_default(),
            Prepared::Ring(ring) => ring.read(copy, key),
        }
    }

    /// The displacement of all V vertices of that host that gives it a mark, whatever it then holds: in few rounds, or in as many as an
    /// embedding takes.
    pub fn again(&self, host: &Host, mark: &Mark, is_thorough: bool) -> Vec<DVec3> {
        match self {
            Prepared::Solid(solid) => solid.again(host, mark, is_thorough),
            Prepared::Ring(ring) => ring.again(host, mark, is_thorough),
        }
    }
}

/// What is to be embedded.
pub struct Mark<'a> {
    /// Whose mark it is.
    pub key: &'a Key,
    /// The encoded message.
    pub codeword: &'a Codeword,
}
