//! Documents of every kind that the laws are tested with.

use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};

/// How the positions of a case are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// One accessor, one view.
    Plain,
    /// A sparse accessor over stored elements.
    SparseOverBase,
    /// A sparse accessor over zeros that are stored nowhere.
    SparseOverNothing,
    /// One accessor that several primitives use.
    Shared,
    /// A second accessor, of another view, on all but the first position.
    Overlapping,
    /// A second accessor, of another buffer, with positions of its own.
    TwoBuffers,
}

/// One document.
#[derive(Clone, Debug)]
pub struct Case {
    pub packing: Packing,
    pub odd: bool,
    pub storage: Storage,
    pub component: Component,
    pub normalized: bool,
    pub bounds: bool,
    /// Whether a colour is interleaved with the positions.
    pub interleaved: bool,
    pub indices: Option<Component>,
    pub mode: u32,
    pub num_points: usize,
    pub seed: u64,
}

/// The number formats a position can have.
pub const FORMATS: [(Component, bool); 9] = [
    (Component::F32, false),
    (Component::I8, false),
    (Component::I8, true),
    (Component::U8, false),
    (Component::U8, true),
    (Component::I16, false),
    (Component::I16, true),
    (Component::U16, false),
    (Component::U16, true),
];

pub const PACKINGS: [Packing; 3] = [Packing::Glb, Packing::DataUri, Packing::External];

pub const STORAGES: [Storage; 6] = [
    Storage::Plain,
    Storage::SparseOverBase,
    Storage::SparseOverNothing,
    Storage::Shared,
    Storage::Overlapping,
    Storage::TwoBuffers,
];

pub const INDICES: [Option<Component>; 4] = [
    None,
    Some(Component::U8),
    Some(Component::U16),
    Some(Component::U32),
];

/// Every format in every packing and storage, with the other properties taking turns.
pub fn all() -> Vec<Case> {
    let mut cases = Vec::new();
    for (component, normalized) in FORMATS {
        for packing in PACKINGS {
            for storage in STORAGES {
                let turn = cases.len();
                cases.push(Case {
                    packing,
                    odd: turn % 2 == 1,
                    storage,
                    component,
                    normalized,
                    bounds: turn % 5 != 4,
                    interleaved: turn / 2 % 2 == 1,
                    indices: INDICES[turn % 4],
                    mode: [4, 5, 6, 4, 0, 1][turn / 4 % 6],
                    num_points: 5 + turn % 7,
                    seed: turn as u64,
                });
            }
        }
    }
    cases
}

impl Case {
    /// The files of the case.
    pub fn build(&self) -> Built {
        let mut noise = Noise(self.seed);
        let mut builder = GltfBuilder::new(self.packing);
        builder.odd = self.odd;
        // Elements start at multiples of four.
        let pad = 3 * self.component.size() % 4;
        let gap = (4 - pad) % 4 + if self.interleaved { 4 } else { 0 };
        let layout = Layout {
            component: self.component,
            normalized: self.normalized,
            gap,
            bounds: self.bounds,
        };
        let points = self.points(&mut noise);
        let replaced: Vec<usize> = (1..self.num_points).step_by(2).collect();

        builder.push(0, &[7; 5]);
        let mut positions = Vec::new();
        match self.storage {
            Storage::SparseOverBase => {
                positions.push(builder.sparse_positions(0, layout, &points, &replaced, true))
            }
            Storage::SparseOverNothing => {
                positions.push(builder.sparse_positions(0, layout, &points, &replaced, false))
            }
            Storage::Plain | Storage::Shared => {
                positions.push(builder.positions(0, layout, &points))
            }
            Storage::Overlapping => {
                let first = builder.positions(0, layout, &points);
                positions.push(first);
                let stride = 3 * self.component.size() + gap;
                let start = builder.buffers[0].len() - stride * self.num_points + stride;
                let view = builder.view(
                    0,
                    start,
                    stride * (self.num_points - 1),
                    (gap > 0).then_some(stride),
                );
                positions.push(builder.positions_at(view, 0, layout, &points[1..]));
            }
            Storage::TwoBuffers => {
                positions.push(builder.positions(0, layout, &points));
                let others = self.points(&mut noise);
                positions.push(builder.positions(1, layout, &others));
            }
        }
        let is_dense = !matches!(
            self.storage,
            Storage::SparseOverBase | Storage::SparseOverNothing
        );
        if self.interleaved && is_dense {
            let json = format!(
                r#"{{"bufferView":0,"byteOffset":{},"componentType":5121,"normalized":true,"count":{},"type":"VEC4"}}"#,
                3 * self.component.size() + gap - 4,
                self.num_points
            );
            builder.accessor(json);
        }

        let corners: Vec<u32> = (0..self.num_points as u32 - 1)
            .flat_map(|index| [index, index + 1, 0])
            .take(3 * (self.num_points - 2))
            .collect();
        let mut primitives = Vec::new();
        for &accessor in &positions {
            let corners: Vec<u32> = corners
                .iter()
                .map(|&corner| corner.min(self.num_points as u32 - 2))
                .collect();
            let indices = self
                .indices
                .map(|component| builder.indices(0, component, &corners));
            primitives.push(primitive(accessor, indices, self.mode));
        }
        if self.storage == Storage::Shared {
            primitives.push(primitive(positions[0], None, 0));
        }
        builder.mesh(&primitives);
        builder.node(r#"{"mesh":0,"translation":[1,2.50,-3e0]}"#);
        builder.node(r#"{"mesh":0,"extras":[{"max":[1.0]}]}"#);
        builder
            .members
            .push(r#""scenes":[{"nodes":[1,0]}],"scene":0"#.into());
        let quantization = r#"["VENDOR_unknown","KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]"#;
        let extensions = if self.component == Component::F32 {
            r#"["VENDOR_unknown"]"#
        } else {
            quantization
        };
        builder
            .members
            .push(format!(r#""extensionsUsed":{extensions}"#));
        builder
            .members
            .push(r#""extensions":{"VENDOR_unknown":{"b":1.50e+2,"a":[-0.0,1E3]}}"#.into());
        builder.members.push(
            r#""extras":{"min":[9],"text":"\u00e9\/\\\"","z":null,"a":12345678901234567890}"#
                .into(),
        );
        builder.chunks.push((*b"XTRA", vec![1, 2, 3, 4]));
        builder.build()
    }

    /// Raw positions, some at the ends of the range.
    fn points(&self, noise: &mut Noise) -> Vec<[f64; 3]> {
        let (low, high) = self.component.range();
        let number = |noise: &mut Noise| {
            let unit = noise.next();
            if self.component == Component::F32 {
                f64::from((4.0 * unit - 2.0) as f32)
            } else {
                (low + ((high - low) * 1.2 * unit - 0.1 * (high - low)))
                    .round()
                    .clamp(low, high)
            }
        };
        (0..self.num_points)
            .map(|_| [(); 3].map(|()| number(noise)))
            .collect()
    }
}

/// Reproducible numbers in [0, 1).
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as f64) / f64::from(1_u32 << 31)
    }
}
