//! Triangles in perspective, lit from over the left shoulder, the nearer before the farther.

use super::colour::Colour;
use glam::{DMat3, DVec3};
use png::{ColorType, Encoder};

/// Each pixel is the mean of so many by so many.
const FINER: usize = 2;
/// The eye is so many radii from the middle of what it sees.
const EYE: f64 = 3.6;
/// The share of a view that a sphere about the model takes.
const FILLED: f64 = 0.96;
/// What is nearer to the eye than the middle is seen larger: so much less may the middle fill.
const NEARER: f64 = 0.9;
/// Of the light: what comes from everywhere, and what from one side.
const AMBIENT: f64 = 0.42;
const DIRECT: f64 = 0.62;

/// Where an eye stands.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// From where to look: a direction of unit length, not the vertical one.
    pub from: DVec3,
    /// The middle of what is seen.
    pub centre: DVec3,
    /// Of a sphere about it.
    pub radius: f64,
    /// How many times larger it is seen than that the sphere would be seen whole.
    pub zoom: f64,
}

impl View {
    /// All points seen from a direction.
    pub fn of(positions: &[[f32; 3]], from: DVec3) -> View {
        let turn = turned_to(from);
        let own = positions
            .iter()
            .map(|p| turn * DVec3::from_array(p.map(f64::from)));
        let low = own.clone().reduce(DVec3::min).unwrap_or_default();
        let high = own.clone().reduce(DVec3::max).unwrap_or_default();
        let middle = (low + high) / 2.0;
        let radius = own.map(|p| p.distance(middle)).fold(0.0, f64::max);
        let half = (high - low) / 2.0;
        View {
            from,
            centre: turn.transpose() * middle,
            radius,
            zoom: NEARER * radius / half.x.max(half.y).max(f64::MIN_POSITIVE),
        }
    }
}

/// From the scene's axes to those of an eye: right, up, and towards it.
fn turned_to(from: DVec3) -> DMat3 {
    let right = DVec3::Y.cross(from).normalize_or(DVec3::X);
    DMat3::from_cols(right, from.cross(right), from).transpose()
}

/// Triangles with a colour at each vertex.
pub struct Painted<'a> {
    /// Of the vertices.
    pub positions: &'a [[f32; 3]],
    /// By index.
    pub triangles: &'a [[u32; 3]],
    /// Of a vertex.
    pub colour: &'a dyn Fn(usize) -> Colour,
    /// How much nearer they are drawn than they are, in radii: what lies on another surface shall be seen whole.
    pub lifted: f64,
}

/// A picture of panels from left to right.
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<Colour>,
    depths: Vec<f64>,
}

impl Picture {
    /// An empty one on white, in pixels.
    pub fn new(width: usize, height: usize) -> Picture {
        let (width, height) = (FINER * width, FINER * height);
        Picture {
            width,
            height,
            pixels: vec![[1.0; 3]; width * height],
            depths: vec![0.0; width * height],
        }
    }

    /// Draws triangles into one of `panels` equal panels.
    pub fn draw(&mut self, (panel, panels): (usize, usize), view: &View, painted: &Painted) {
        let width = self.width / panels;
        let eye = Eye::new(view, width, self.height);
        let corners: Vec<Seen> = painted
            .positions
            .iter()
            .map(|p| eye.of(DVec3::from_array(p.map(f64::from)), painted.lifted))
            .collect();
        for triangle in painted.triangles {
            let corners = triangle.map(|v| corners[v as usize]);
            let colours = triangle.map(|v| (painted.colour)(v as usize));
            self.fill(panel * width, width, &corners, colours);
        }
    }

    fn fill(&mut self, left: usize, width: usize, corners: &[Seen; 3], colours: [Colour; 3]) {
        let [a, b, c] = corners;
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        let plane = (b.at - a.at).cross(c.at - a.at).normalize_or_zero();
        if area == 0.0 || plane == DVec3::ZERO {
            return;
        }
        // Files have triangles that face inwards: both sides are lit.
        let facing = if plane.dot(-a.at) < 0.0 {
            -plane
        } else {
            plane
        };
        let light = DVec3::new(-0.45, 0.6, 0.66);
        let light = (AMBIENT + DIRECT * facing.dot(light).max(0.0)) as f32;
        let range = |values: [f64; 3], most: usize| {
            let low = values.into_iter().fold(f64::INFINITY, f64::min);
            let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let high = (high.ceil().max(0.0) as usize).min(most);
            (low.floor().max(0.0) as usize).min(high)..high
        };
        for y in range([a.y, b.y, c.y], self.height) {
            for x in range([a.x, b.x, c.x], width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let part = |p: &Seen, q: &Seen| (p.x - px) * (q.y - py) - (p.y - py) * (q.x - px);
                let weights = [part(b, c) / area, part(c, a) / area, part(a, b) / area];
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let nearness: f64 = (0..3).map(|i| weights[i] * corners[i].nearness).sum();
                let place = y * self.width + left + x;
                if nearness > self.depths[place] {
                    self.depths[place] = nearness;
                    self.pixels[place] = std::array::from_fn(|channel| {
                        let mixed = (0..3).map(|i| weights[i] as f32 * colours[i][channel]);
                        (mixed.sum::<f32>() * light).min(1.0)
                    });
                }
            }
        }
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        let (width, height) = (self.width / FINER, self.height / FINER);
        let pixel = |place: usize| {
            let (x, y) = (FINER * (place % width), FINER * (place / width));
            let mut sum = [0.0; 3];
            for (dx, dy) in (0..FINER * FINER).map(|i| (i % FINER, i / FINER)) {
                let own = self.pixels[(y + dy) * self.width + x + dx];
                (0..3).for_each(|c| sum[c] += own[c]);
            }
            sum.map(|c| (c * 255.0 / (FINER * FINER) as f32).round() as u8)
        };
        let pixels: Vec<u8> = (0..width * height).flat_map(pixel).collect();
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, width as u32, height as u32);
        encoder.set_color(ColorType::Rgb);
        let written = encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&pixels));
        written.expect("a vector takes what is written, and the rows are as many as was said");
        file
    }
}

/// A point as an eye sees it: where, in the eye's coordinates and in pixels, and the inverse of its distance.
#[derive(Clone, Copy)]
struct Seen {
    at: DVec3,
    x: f64,
    y: f64,
    nearness: f64,
}

struct Eye {
    turn: DMat3,
    centre: DVec3,
    radius: f64,
    scale: f64,
    middle: [f64; 2],
}

impl Eye {
    fn new(view: &View, width: usize, height: usize) -> Eye {
        // A sphere's outline is seen farther out than its radius.
        let outline = EYE / (EYE * EYE - 1.0).sqrt();
        Eye {
            turn: turned_to(view.from),
            centre: view.centre,
            radius: view.radius.max(f64::MIN_POSITIVE),
            scale: view.zoom * FILLED * 0.5 * width.min(height) as f64 * EYE / outline / EYE,
            middle: [width as f64 / 2.0, height as f64 / 2.0],
        }
    }

    fn of(&self, point: DVec3, lifted: f64) -> Seen {
        let own = self.turn * (point - self.centre) / self.radius;
        let at = own - DVec3::new(0.0, 0.0, EYE);
        let distance = (-at.z).max(0.1);
        let scale = self.scale * EYE / distance;
        Seen {
            at,
            x: self.middle[0] + scale * own.x,
            y: self.middle[1] - scale * own.y,
            nearness: 1.0 / (distance - lifted).max(0.05),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_triangle_is_seen_whatever_is_drawn_first() {
        let square = |z: f32| {
            [
                [-1.0, -1.0, z],
                [1.0, -1.0, z],
                [1.0, 1.0, z],
                [-1.0, 1.0, z],
            ]
        };
        let (near, far) = (square(0.5), square(-0.5));
        let view = View::of(&[near, far].concat(), DVec3::Z);
        let painted = |positions, colour| Painted {
            positions,
            triangles: &[[0, 1, 2], [0, 2, 3]],
            colour,
            lifted: 0.0,
        };
        let (red, blue) = (|_| [1.0, 0.0, 0.0], |_| [0.0, 0.0, 1.0]);
        let (front, back) = (painted(&near, &red), painted(&far, &blue));
        for order in [[&front, &back], [&back, &front]] {
            let mut picture = Picture::new(20, 10);
            order
                .into_iter()
                .for_each(|painted| picture.draw((1, 2), &view, painted));
            let middle = picture.height / 2 * picture.width;
            let [r, _, b] = picture.pixels[middle + picture.width * 3 / 4];
            assert!(r > 0.5 && b == 0.0, "{r} {b}");
            let left = picture.pixels[middle + picture.width / 4];
            assert_eq!(left, [1.0; 3], "it is drawn into the other panel");
        }
    }
}
