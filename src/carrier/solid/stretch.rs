//! Undoing a scale along one axis. It moves a frame's axes as well as the surface in it, so that no search near the suspect's own frame
//! finds the mark again; but clusters map linearly, and a try takes no new measurement.

use super::cluster::Cluster;
use super::frame::{Axes, axes_of, is_determined};
use crate::carrier::{StoredError, possible, take};
use crate::geometry::Pose;
use glam::{DMat3, DQuat, DVec3};

/// Scales that are tried along each direction, either way, in percent. The search that follows bridges what lies between them: 0.6 % at the
/// balanced strength, 1.5 % at the strong one.
const PERCENT: std::ops::RangeInclusive<u32> = 1..=10;

/// Cells of the clusters that tries are made with are so many times smaller than the pitch: larger ones than those that are read, and
/// tries take half of the time or less.
pub const CELLS_PER_PITCH: f64 = 2.0;

/// Directions nearer to each other than this, by their cosine, are one.
const SAME: f64 = 0.999;

/// What undoing a stretch needs to know of a suspect's frame. In single precision, as evidence keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretchable {
    /// The shares of the axes in the covariance.
    spreads: [f32; 3],
    /// The rotation that takes the scene's axes into the frame, as a quaternion.
    scene: [f32; 4],
}

/// What undoes a stretch.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// From the suspect's frame into the one that it had before.
    pub map: DMat3,
    /// How well the axes of that are told apart.
    pub axes: [Axes; 2],
}

impl Stretchable {
    /// In stored evidence.
    const NUMBERS: usize = 7;

    pub fn of(pose: &Pose) -> Stretchable {
        let scene = DQuat::from_mat3(&pose.axes.transpose());
        Stretchable {
            spreads: pose.spreads.to_array().map(|spread| spread as f32),
            scene: scene.to_array().map(|part| part as f32),
        }
    }

    /// Takes it from the beginning of bytes: 7 numbers of 4 bytes.
    pub fn read(bytes: &mut &[u8]) -> Result<Stretchable, StoredError> {
        let mut numbers = [0.0; Self::NUMBERS];
        for number in &mut numbers {
            *number = f32::from_le_bytes(take(bytes)?);
        }
        let [x, y, z, scene @ ..] = numbers;
        let spreads = [x, y, z];
        let is_share = |spread: &f32| (0.0..=1.0).contains(spread);
        possible(spreads.iter().all(is_share), "a frame with no such spreads")?;
        let square: f32 = scene.iter().map(|part| part * part).sum();
        possible(
            (square - 1.0).abs() < 1e-3,
            "a frame that is not turned but distorted",
        )?;
        Ok(Stretchable { spreads, scene })
    }

    /// Appends the bytes.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        let numbers = self.spreads.iter().chain(&self.scene);
        numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
    }

    /// What is tried: scales along the axes of the frame and of the scene, the smallest first. None that leaves a frame without axes of
    /// its own.
    pub fn tries(&self) -> Vec<Stretch> {
        let directions = self.directions();
        let ratios = PERCENT.flat_map(|percent| {
            let ratio = 1.0 + f64::from(percent) / 100.0;
            [ratio, 1.0 / ratio]
        });
        let along = |ratio: f64| {
            let stretches = directions.iter();
            stretches.filter_map(move |&direction| self.stretch(direction, ratio))
        };
        ratios.flat_map(along).collect()
    }

    /// Unit vectors in the frame.
    fn directions(&self) -> Vec<DVec3> {
        let turn = DQuat::from_array(self.scene.map(f64::from)).normalize();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut directions = axes.to_vec();
        for axis in axes.map(|axis| turn * axis) {
            if directions.iter().all(|other| other.dot(axis).abs() < SAME) {
                directions.push(axis);
            }
        }
        directions
    }

    /// A scale along a direction, and into the frame that its moments give.
    fn stretch(&self, direction: DVec3, ratio: f64) -> Option<Stretch> {
        let outer = DMat3::from_cols(
            direction * direction.x,
            direction * direction.y,
            direction * direction.z,
        );
        let scale = DMat3::IDENTITY + outer * (ratio - 1.0);
        let spreads = DVec3::from_array(self.spreads.map(f64::from));
        let pose = Pose::of_moments(DVec3::ZERO, scale * DMat3::from_diagonal(spreads) * scale)?;
        is_determined(&pose).then(|| Stretch {
            map: pose.axes.transpose() * scale * (1.0 / pose.size),
            axes: axes_of(&pose),
        })
    }
}

/// The half of a surface on one side of its centre: enough to tell which stretch it was, in half of the time.
pub fn half(clusters: &[Cluster]) -> Vec<Cluster> {
    let half = clusters.iter().filter(|cluster| cluster.centre.x > 0.0);
    half.copied().collect()
}

/// Clusters of a surface after a linear map. The weight of each grows as its area vector does.
pub fn mapped(clusters: &[Cluster], map: &DMat3) -> Vec<Cluster> {
    let DMat3 {
        x_axis,
        y_axis,
        z_axis,
    } = *map;
    let areas = DMat3::from_cols(
        y_axis.cross(z_axis),
        z_axis.cross(x_axis),
        x_axis.cross(y_axis),
    );
    let volume = map.determinant();
    let mapped = |cluster: &Cluster| {
        let area = areas * cluster.area;
        let length = cluster.area.length();
        // Where area vectors cancel, they say nothing of how the area grows.
        let growth = if length > 0.1 * cluster.weight {
            area.length() / length
        } else {
            libm::cbrt(volume * volume)
        };
        Cluster {
            centre: *map * cluster.centre,
            area,
            moment: cluster.moment * volume,
            weight: cluster.weight * growth,
        }
    };
    clusters.iter().map(mapped).collect()
}
