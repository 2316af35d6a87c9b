//! A stream encoded once more, with other positions.
//!
//! The bitstream tells its method, and not with what effort or how many bits it was made; both show in what comes of trying.

use draco_core::{
    DecoderBuffer, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshDecoder,
    MeshEncoder, PointAttribute, PointIndex,
};
use serde_json::Value;

/// The most bits that a grid is looked for with: the numbers of finer ones are too few for 32-bit floats to tell.
const MOST_BITS: i32 = 20;

/// Draco's number of the method that writes vertices and triangles in their order.
const SEQUENTIAL: u8 = 0;

/// The bits of normals that exporters use, the usual ones first.
const NORMAL_BITS: [i32; 12] = [8, 10, 12, 7, 9, 11, 6, 13, 14, 15, 16, 5];

/// A stream to encode again.
pub(super) struct Job<'a> {
    stream: &'a [u8],
    mesh: Mesh,
    positions: &'a [u8],
    position: i32,
    pub position_bits: i32,
    /// The host's, or the one that keeps the order of vertices and triangles.
    method: u8,
}

impl<'a> Job<'a> {
    /// A stream, its extension, and the bytes of the positions of its points now.
    pub fn new(stream: &'a [u8], extension: &Value, positions: &'a [u8]) -> Option<Self> {
        let mesh = decoded(stream)?;
        let number = extension.get("attributes")?.get("POSITION")?.as_u64()?;
        let position = mesh.attribute_id_by_unique_id(u32::try_from(number).ok()?);
        let attribute = mesh.try_attribute(position).ok()?;
        let position_bits = grid_bits(&values(attribute)?, 3);
        Some(Self {
            stream,
            position,
            position_bits,
            mesh,
            positions,
            method: *stream.get(8)?,
        })
    }

    /// The same, of which vertices and triangles have to stay in order.
    pub fn in_order(mut self, has_to: bool) -> Self {
        if has_to {
            self.method = SEQUENTIAL;
        }
        self
    }

    /// The stream with the new positions, in so many bits.
    pub fn encoded(mut self, position_bits: i32) -> Option<Vec<u8>> {
        let mut options = EncoderOptions::new();
        options.set_encoding_method(i32::from(self.method));
        for id in 0..self.mesh.num_attributes() {
            let attribute = self.mesh.try_attribute(id).ok()?;
            if attribute.data_type() != draco_core::DataType::Float32 {
                continue;
            }
            let bits = match attribute.attribute_type() {
                _ if id == self.position => position_bits,
                GeometryAttributeType::Normal => self.normal_bits(id)?,
                _ => grid_bits(&values(attribute)?, usize::from(attribute.num_components())),
            };
            if bits > 0 {
                options.set_attribute_quantization(id, bits);
            }
        }
        self.place()?;
        let speed = self.speed(&options)?;
        set_speed(&mut options, speed);
        let (num_points, num_faces) = (self.mesh.num_points(), self.mesh.num_faces());
        let encoded = encoded(self.mesh, &options)?;
        let again = decoded(&encoded)?;
        // The file states these numbers.
        (again.num_points() == num_points && again.num_faces() == num_faces).then_some(encoded)
    }

    /// The effort that gives a stream of a length nearest to the host's: what pays on a surface as it was need not pay on one that was moved.
    fn speed(&self, options: &EncoderOptions) -> Option<i32> {
        let candidates: &[i32] = if self.method == SEQUENTIAL {
            &[10]
        } else {
            &[5, 7, 3, 0, 9]
        };
        if let [only] = candidates {
            return Some(*only);
        }
        let length = |&speed: &i32| {
            let mut options = options.clone();
            set_speed(&mut options, speed);
            let length =
                encoded(self.mesh.clone(), &options).map_or(usize::MAX, |stream| stream.len());
            length.abs_diff(self.stream.len())
        };
        candidates.iter().copied().min_by_key(length)
    }

    /// The bits that normals come back the same with. A sequential stream keeps the order of points, so that they can be compared.
    fn normal_bits(&self, id: i32) -> Option<i32> {
        let before = values_by_point(&self.mesh, id)?;
        NORMAL_BITS.into_iter().find(|&bits| {
            let mut options = EncoderOptions::new();
            options.set_encoding_method(i32::from(SEQUENTIAL));
            set_speed(&mut options, 10);
            options.set_attribute_quantization(id, bits);
            let again = encoded(self.mesh.clone(), &options).and_then(|stream| decoded(&stream));
            again
                .and_then(|mesh| values_by_point(&mesh, id))
                .is_some_and(|after| after == before)
        })
    }

    /// Moves the positions. Points that share one have to agree about it.
    fn place(&mut self) -> Option<()> {
        let num_points = self.mesh.num_points();
        let attribute = self.mesh.try_attribute_mut(self.position).ok()?;
        let mut placed = vec![None; attribute.size()];
        for point in 0..num_points {
            let to = attribute
                .mapped_index(PointIndex(u32::try_from(point).ok()?))
                .0 as usize;
            let from = point.checked_mul(12)?;
            let value = self.positions.get(from..from.checked_add(12)?)?;
            let slot = placed.get_mut(to)?;
            match slot {
                Some(known) if *known != value => return None,
                _ => *slot = Some(value),
            }
        }
        let data = attribute.buffer_mut().data_mut();
        for (value, place) in placed.into_iter().zip(data.chunks_exact_mut(12)) {
            if let Some(value) = value {
                place.copy_from_slice(value);
            }
        }
        Some(())
    }
}

fn set_speed(options: &mut EncoderOptions, speed: i32) {
    options.set_global_int("encoding_speed", speed);
    options.set_global_int("decoding_speed", speed);
}

fn decoded(stream: &[u8]) -> Option<Mesh> {
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(stream), &mut mesh)
        .ok()?;
    Some(mesh)
}

fn encoded(mesh: Mesh, options: &EncoderOptions) -> Option<Vec<u8>> {
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(options, &mut buffer).ok()?;
    Some(buffer.data().to_vec())
}

/// The floats of an attribute's distinct values.
fn values(attribute: &PointAttribute) -> Option<Vec<f32>> {
    let size = attribute
        .size()
        .checked_mul(usize::from(attribute.num_components()))?;
    let numbers = attribute
        .buffer()
        .data()
        .as_chunks()
        .0
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes));
    Some(numbers.take(size).collect())
}

fn values_by_point(mesh: &Mesh, id: i32) -> Option<Vec<f32>> {
    let attribute = mesh.try_attribute(id).ok()?;
    Some(attribute.read_f32s(mesh.num_points(), usize::from(attribute.num_components())))
}

/// The bits of the grid that values lie on; 0 if they lie on none. Draco's grid has its origin at the smallest of each component, and one step
/// for all, which the widest component is so many of.
fn grid_bits(values: &[f32], num_components: usize) -> i32 {
    let component = |axis: usize| {
        values
            .iter()
            .skip(axis)
            .step_by(num_components.max(1))
            .map(|&value| f64::from(value))
    };
    let lows: Vec<f64> = (0..num_components)
        .map(|axis| component(axis).fold(f64::INFINITY, f64::min))
        .collect();
    let widths = lows
        .iter()
        .enumerate()
        .map(|(axis, low)| component(axis).fold(0.0, |width: f64, value| width.max(value - low)));
    let width = widths.fold(0.0, f64::max);
    let largest = values.iter().fold(0.0, |largest: f64, &value| {
        largest.max(f64::from(value).abs())
    });
    if width == 0.0 || !width.is_finite() {
        return if values.is_empty() { 0 } else { 1 };
    }
    let fits = |bits: &i32| {
        let steps = f64::from((1_u32 << bits).saturating_sub(1));
        // What 32-bit floats round, in steps.
        let tolerance = 4.0 * largest * f64::from(f32::EPSILON) / width * steps + 1e-3;
        tolerance < 0.25
            && (0..num_components).all(|axis| {
                let low = lows.get(axis).copied().unwrap_or_default();
                component(axis).all(|value| {
                    let place = (value - low) / width * steps;
                    (place - place.round()).abs() <= tolerance
                })
            })
    };
    (1..=MOST_BITS).find(fits).unwrap_or(0)
}
