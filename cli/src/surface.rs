//! Surfaces from files that are no glTF.

use crate::failure::Failure;
use crate::format::{Format, is_binary_stl};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};
use std::path::Path;
use tobj::LoadOptions;

/// Positions, and triangles between them.
#[derive(Debug, Default, PartialEq)]
pub struct Triangles {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Triangles {
    /// Reads a file of a format that was recognized.
    pub fn read(path: &Path, format: Format, bytes: &[u8]) -> Result<Triangles, Failure> {
        let read = match format {
            Format::Obj => obj(bytes),
            Format::Stl if is_binary_stl(bytes) => Ok(binary_stl(bytes)),
            Format::Stl => text_stl(bytes),
            Format::Ply => ply(bytes),
            Format::Gltf => Err("glTF is no bare surface".to_owned()),
        };
        read.map_err(|words| Failure::Damaged {
            path: path.to_owned(),
            words,
        })
    }

    /// Adds a polygon as a fan.
    fn fan(&mut self, corners: &[u32]) {
        if let Some((&hub, rim)) = corners.split_first() {
            let pairs = rim.windows(2);
            self.triangles
                .extend(pairs.map(|pair| [hub, pair[0], pair[1]]));
        }
    }

    /// Adds a strip; -1 ends one and begins another.
    fn strips(&mut self, corners: &[i64]) -> Result<(), String> {
        for strip in corners.split(|&corner| corner < 0) {
            for (place, corners) in strip.windows(3).enumerate() {
                let [a, b, c] = [corners[0], corners[1], corners[2]].map(index);
                let (a, b, c) = (a?, b?, c?);
                self.triangles
                    .push(if place % 2 == 0 { [a, b, c] } else { [a, c, b] });
            }
        }
        Ok(())
    }

    fn corner(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }
}

fn index(number: i64) -> Result<u32, String> {
    u32::try_from(number).map_err(|_| format!("{number} is no vertex"))
}

fn obj(bytes: &[u8]) -> Result<Triangles, String> {
    let options = LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    // Materials say nothing of the shape: none is looked for.
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut &*bytes, &options, no_materials)
        .map_err(|error| error.to_string())?;
    let mut read = Triangles::default();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let first = read.positions.len() as u32;
        read.positions.extend(mesh.positions.as_chunks::<3>().0);
        let triangles = mesh.indices.as_chunks::<3>().0.iter();
        read.triangles
            .extend(triangles.map(|triangle| triangle.map(|corner| first + corner)));
    }
    Ok(read)
}

/// Triangles of 50 bytes each behind a header of 84: a normal, three corners, two bytes of anything. Read here, since the crate for
/// it takes files that begin with "solid" for text, as some exporters' do, and reads only the first solid of a text.
fn binary_stl(bytes: &[u8]) -> Triangles {
    let mut read = Triangles::default();
    for triangle in bytes[84..].as_chunks::<50>().0 {
        let number = |place: usize| {
            let number = triangle[place..].first_chunk().copied();
            f64::from(f32::from_le_bytes(number.unwrap_or_default()))
        };
        let corners = [12, 24, 36].map(|place| [0, 4, 8].map(|axis| number(place + axis)));
        let corners = corners.map(|corner| read.corner(corner));
        read.triangles.push(corners);
    }
    read
}

/// The corners of a text, however many solids it has: three numbers behind each word "vertex".
fn text_stl(bytes: &[u8]) -> Result<Triangles, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = text.split_ascii_whitespace();
    let mut read = Triangles::default();
    while let Some(word) = words.next() {
        if word.eq_ignore_ascii_case("vertex") {
            let mut number = || {
                let word = words.next().unwrap_or_default();
                word.parse::<f64>()
                    .map_err(|_| format!("{word:?} is no number"))
            };
            let position = [number()?, number()?, number()?];
            read.corner(position);
        }
    }
    let corners: Vec<u32> = (0..read.positions.len() as u32).collect();
    read.triangles = corners.as_chunks().0.to_vec();
    Ok(read)
}

/// A vertex, a face or a strip of a PLY file.
#[derive(Default)]
struct Element {
    position: [f64; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Element {
    fn new() -> Element {
        Element::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "x" | "y" | "z" => {
                let axis = usize::from(name.as_bytes()[0] - b'x');
                self.position[axis] = number(&property).unwrap_or(f64::NAN);
            }
            "vertex_indices" | "vertex_index" => self.corners = numbers(property),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(number) => number.into(),
        Property::UChar(number) => number.into(),
        Property::Short(number) => number.into(),
        Property::UShort(number) => number.into(),
        Property::Int(number) => number.into(),
        Property::UInt(number) => number.into(),
        Property::Float(number) => number.into(),
        Property::Double(number) => number,
        _ => return None,
    })
}

fn numbers(property: Property) -> Vec<i64> {
    match property {
        Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
        Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
        Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
        Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
        Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
        Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
        _ => Vec::new(),
    }
}

fn ply(bytes: &[u8]) -> Result<Triangles, String> {
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(bytes);
    let header = parser
        .read_header(&mut reader)
        .map_err(|error| error.to_string())?;
    let mut read = Triangles::default();
    for (name, kind) in &header.elements {
        let elements = parser
            .read_payload_for_element(&mut reader, kind, &header)
            .map_err(|error| error.to_string())?;
        match name.as_str() {
            "vertex" => {
                read.positions = elements.into_iter().map(|vertex| vertex.position).collect()
            }
            "tristrips" => {
                for strip in &elements {
                    read.strips(&strip.corners)?;
                }
            }
            _ => {
                for face in &elements {
                    let corners: Result<Vec<u32>, String> =
                        face.corners.iter().copied().map(index).collect();
                    read.fan(&corners?);
                }
            }
        }
    }
    Ok(read)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;

    const POINTS: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.5],
    ];

    fn read(format: Format, bytes: &[u8]) -> Triangles {
        Triangles::read(Path::new("a"), format, bytes).unwrap()
    }

    #[test]
    fn polygons_of_obj_become_triangles() {
        let text = b"# x\nmtllib lost.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nusemtl m\nf 1/1/1 2//2 3 4\nl 1 2\no b\nf -1 -2 -3\n";
        let read = read(Format::Obj, text);
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| read.positions[corner as usize]);
        let triangles: Vec<_> = read.triangles.iter().map(corners).collect();
        let expected = [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
            .map(|corners| corners.map(|corner: usize| POINTS[corner]));
        assert_eq!(triangles, expected);
    }

    #[test]
    fn stl_is_read_as_text_and_as_bytes() {
        let text = "solid one\n facet normal 0 0 0\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n VERTEX 1e0 1 0\n endloop\n endfacet\nendsolid one\n\
                    solid two\nfacet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 1 0 vertex 0 1 .5 endloop endfacet endsolid two";
        let by_text = read(Format::Stl, text.as_bytes());
        assert_eq!(by_text.triangles, [[0, 1, 2], [3, 4, 5]]);
        // A header that begins as a text does.
        let mut bytes = b"solid by some exporter".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(2_u32.to_le_bytes());
        for triangle in &by_text.triangles {
            bytes.extend([0; 12]);
            for number in triangle
                .iter()
                .flat_map(|&corner| by_text.positions[corner as usize])
            {
                bytes.extend((number as f32).to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        assert_eq!(read(Format::Stl, &bytes), by_text);
        let error = Triangles::read(Path::new("a.stl"), Format::Stl, b"solid x vertex 1 2 three")
            .unwrap_err();
        assert!(error.to_string().contains("three"), "{error}");
    }

    #[test]
    fn ply_is_read_with_faces_and_strips() {
        let vertices = "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0.5 9\n";
        let head = "ply\nformat ascii 1.0\ncomment by nobody\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\n";
        let faces = format!(
            "{head}element face 1\nproperty list uchar int vertex_indices\nend_header\n{vertices}4 0 1 2 3\n"
        );
        let by_faces = read(Format::Ply, faces.as_bytes());
        assert_eq!(by_faces.positions, POINTS);
        assert_eq!(by_faces.triangles, [[0, 1, 2], [0, 2, 3]]);
        let strips = format!(
            "{head}element tristrips 1\nproperty list int int vertex_indices\nend_header\n{vertices}8 0 1 2 3 -1 3 2 1\n"
        );
        assert_eq!(
            read(Format::Ply, strips.as_bytes()).triangles,
            [[0, 1, 2], [1, 3, 2], [3, 2, 1]]
        );
        for (name, order) in [("little", true), ("big", false)] {
            let head = format!(
                "ply\nformat binary_{name}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n"
            );
            let mut bytes = head.into_bytes();
            let mut put = |word: u32| {
                bytes.extend(if order {
                    word.to_le_bytes()
                } else {
                    word.to_be_bytes()
                })
            };
            POINTS
                .iter()
                .flatten()
                .for_each(|&number| put((number as f32).to_bits()));
            bytes.push(3);
            let mut put = |word: u32| {
                bytes.extend(if order {
                    word.to_le_bytes()
                } else {
                    word.to_be_bytes()
                })
            };
            [0, 1, 3].into_iter().for_each(&mut put);
            let read = read(Format::Ply, &bytes);
            assert_eq!(
                (read.positions.as_slice(), read.triangles.as_slice()),
                (&POINTS[..], &[[0, 1, 3]][..])
            );
        }
        assert!(
            Triangles::read(
                Path::new("a"),
                Format::Ply,
                b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n"
            )
            .is_err()
        );
    }
}
