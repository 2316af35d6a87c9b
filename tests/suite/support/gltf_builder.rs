//! Builds small glTF documents of every kind, independently of the code under test.
//!
//! Numbers are given as they are stored; JSON fragments are given as text. Everything is put
//! together in the order of the calls, so the same calls give the same bytes.

use super::glb::glb;
use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use meshmark::internals::document::Files;

/// A component type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// glTF's number of the type.
    pub fn code(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    /// Bytes of a component.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The smallest and largest number that can be stored.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::I8 => (-128.0, 127.0),
            Self::U8 => (0.0, 255.0),
            Self::I16 => (-32768.0, 32767.0),
            Self::U16 => (0.0, 65535.0),
            Self::U32 => (0.0, 4294967295.0),
            Self::F32 => (f64::from(f32::MIN), f64::from(f32::MAX)),
        }
    }

    /// The stored bytes of a number that the type can hold.
    pub fn bytes(self, number: f64) -> Vec<u8> {
        match self {
            Self::I8 => vec![(number as i8) as u8],
            Self::U8 => vec![number as u8],
            Self::I16 => (number as i16).to_le_bytes().to_vec(),
            Self::U16 => (number as u16).to_le_bytes().to_vec(),
            Self::U32 => (number as u32).to_le_bytes().to_vec(),
            Self::F32 => (number as f32).to_le_bytes().to_vec(),
        }
    }

    /// The bytes of three numbers.
    fn triple(self, numbers: [f64; 3]) -> Vec<u8> {
        numbers
            .into_iter()
            .flat_map(|number| self.bytes(number))
            .collect()
    }
}

/// Where the buffers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// `.glb`; the first buffer is the binary chunk, others are data URIs.
    Glb,
    /// `.gltf` with data URIs.
    DataUri,
    /// `.gltf` with external buffers `part 0.bin`, `part 1.bin` ...
    External,
}

/// How positions are stored.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// The number type.
    pub component: Component,
    /// The accessor's `normalized`.
    pub normalized: bool,
    /// Bytes of other data between elements.
    pub gap: usize,
    /// Whether the accessor states `min` and `max`.
    pub bounds: bool,
}

impl Layout {
    /// Tightly packed f32 with bounds.
    pub const F32: Self = Self {
        component: Component::F32,
        normalized: false,
        gap: 0,
        bounds: true,
    };
}

/// A model file with its external buffers.
#[derive(Clone, Debug)]
pub struct Built {
    pub bytes: Vec<u8>,
    pub files: Files,
}

/// A document under construction. The lists hold the JSON text of their items.
#[derive(Clone, Debug)]
pub struct GltfBuilder {
    pub packing: Packing,
    /// Odd but legal white space and escapes throughout.
    pub odd: bool,
    /// GLB chunks after the binary one: type and content.
    pub chunks: Vec<([u8; 4], Vec<u8>)>,
    pub buffers: Vec<Vec<u8>>,
    pub views: Vec<String>,
    pub accessors: Vec<String>,
    pub meshes: Vec<String>,
    pub nodes: Vec<String>,
    /// Further top-level members, such as `"scenes":[...]`.
    pub members: Vec<String>,
}

impl GltfBuilder {
    pub fn new(packing: Packing) -> Self {
        Self {
            packing,
            odd: false,
            chunks: Vec::new(),
            buffers: vec![Vec::new()],
            views: Vec::new(),
            accessors: Vec::new(),
            meshes: Vec::new(),
            nodes: Vec::new(),
            members: Vec::new(),
        }
    }

    /// Appends bytes to a buffer, aligned to four, and gives their offset.
    pub fn push(&mut self, buffer: usize, bytes: &[u8]) -> usize {
        while self.buffers.len() <= buffer {
            self.buffers.push(Vec::new());
        }
        let target = &mut self.buffers[buffer];
        target.resize(target.len().next_multiple_of(4), 0);
        let offset = target.len();
        target.extend_from_slice(bytes);
        offset
    }

    /// Adds a buffer view.
    pub fn view(
        &mut self,
        buffer: usize,
        offset: usize,
        length: usize,
        stride: Option<usize>,
    ) -> usize {
        let stride = stride.map_or(String::new(), |stride| format!(r#","byteStride":{stride}"#));
        self.views.push(format!(
            r#"{{"buffer":{buffer},"byteOffset":{offset},"byteLength":{length}{stride}}}"#
        ));
        self.views.len() - 1
    }

    /// Adds an accessor given as JSON text.
    pub fn accessor(&mut self, json: String) -> usize {
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    /// Adds positions in a view of their own, gaps filled with a pattern.
    pub fn positions(&mut self, buffer: usize, layout: Layout, points: &[[f64; 3]]) -> usize {
        let element = 3 * layout.component.size();
        let mut bytes = Vec::new();
        for (index, point) in points.iter().enumerate() {
            bytes.extend(layout.component.triple(*point));
            bytes.extend((0..layout.gap).map(|place| (index * 31 + place * 7 + 1) as u8));
        }
        let offset = self.push(buffer, &bytes);
        let stride = (layout.gap > 0).then_some(element + layout.gap);
        let view = self.view(buffer, offset, bytes.len(), stride);
        self.positions_at(view, 0, layout, points)
    }

    /// Adds an accessor of positions that are stored already, at `offset` in a view.
    pub fn positions_at(
        &mut self,
        view: usize,
        offset: usize,
        layout: Layout,
        points: &[[f64; 3]],
    ) -> usize {
        let json = position_accessor(
            layout,
            points,
            &format!(r#""bufferView":{view},"byteOffset":{offset},"#),
            "",
        );
        self.accessor(json)
    }

    /// Adds sparse positions: `points` are the final ones, of which those in `replaced` (ascending)
    /// are stored as sparse values; the others are in a base view, or zero if there is none.
    pub fn sparse_positions(
        &mut self,
        buffer: usize,
        layout: Layout,
        points: &[[f64; 3]],
        replaced: &[usize],
        has_base: bool,
    ) -> usize {
        let component = layout.component;
        let base = has_base.then(|| {
            let mut base = points.to_vec();
            replaced.iter().for_each(|&index| base[index] = [1.0; 3]);
            let bytes: Vec<u8> = base
                .iter()
                .flat_map(|point| component.triple(*point))
                .collect();
            let offset = self.push(buffer, &bytes);
            self.view(buffer, offset, bytes.len(), None)
        });
        let indices: Vec<u8> = replaced
            .iter()
            .flat_map(|&index| (index as u16).to_le_bytes())
            .collect();
        let offset = self.push(buffer, &indices);
        let index_view = self.view(buffer, offset, indices.len(), None);
        let values: Vec<u8> = replaced
            .iter()
            .flat_map(|&index| component.triple(points[index]))
            .collect();
        let offset = self.push(buffer, &values);
        let value_view = self.view(buffer, offset, values.len(), None);

        let mut finals = points.to_vec();
        if !has_base {
            finals
                .iter_mut()
                .enumerate()
                .filter(|(index, _)| !replaced.contains(index))
                .for_each(|(_, p)| *p = [0.0; 3]);
        }
        let base = base.map_or(String::new(), |view| format!(r#""bufferView":{view},"#));
        let sparse = format!(
            r#","sparse":{{"count":{},"indices":{{"bufferView":{index_view},"componentType":5123}},"values":{{"bufferView":{value_view}}}}}"#,
            replaced.len()
        );
        let json = position_accessor(layout, &finals, &base, &sparse);
        self.accessor(json)
    }

    /// Adds vertex indices.
    pub fn indices(&mut self, buffer: usize, component: Component, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices
            .iter()
            .flat_map(|&index| component.bytes(f64::from(index)))
            .collect();
        let offset = self.push(buffer, &bytes);
        let view = self.view(buffer, offset, bytes.len(), None);
        self.accessor(format!(
            r#"{{"bufferView":{view},"componentType":{},"count":{},"type":"SCALAR"}}"#,
            component.code(),
            indices.len()
        ))
    }

    /// Adds a mesh of primitives given as JSON text.
    pub fn mesh(&mut self, primitives: &[String]) -> usize {
        self.meshes
            .push(format!(r#"{{"primitives":[{}]}}"#, primitives.join(",")));
        self.meshes.len() - 1
    }

    /// Adds a node given as JSON text.
    pub fn node(&mut self, json: &str) -> usize {
        self.nodes.push(json.to_owned());
        self.nodes.len() - 1
    }

    /// The JSON text as it goes into the file, without padding.
    pub fn json(&self) -> String {
        let buffers: Vec<String> = self
            .buffers
            .iter()
            .enumerate()
            .map(|(index, bytes)| self.buffer(index, bytes))
            .collect();
        let mut members = vec![r#""asset":{"version":"2.0"}"#.to_owned()];
        for (name, items) in [
            ("buffers", &buffers),
            ("bufferViews", &self.views),
            ("accessors", &self.accessors),
            ("meshes", &self.meshes),
            ("nodes", &self.nodes),
        ] {
            if !items.is_empty() {
                members.push(format!(r#""{name}":[{}]"#, items.join(",")));
            }
        }
        members.extend(self.members.iter().cloned());
        let text = format!("{{{}}}", members.join(","));
        if self.odd { spread(&text) } else { text }
    }

    /// The finished files.
    pub fn build(&self) -> Built {
        let text = self.json();
        let files = match self.packing {
            Packing::External => {
                let names = (0..self.buffers.len()).map(|index| format!("part {index}.bin"));
                names.zip(self.buffers.iter().cloned()).collect()
            }
            Packing::Glb | Packing::DataUri => Files::new(),
        };
        let bytes = match self.packing {
            Packing::Glb => {
                let mut binary = self.buffers[0].clone();
                binary.resize(binary.len().next_multiple_of(4), 0);
                let mut json = text.into_bytes();
                json.resize(json.len().next_multiple_of(4), b' ');
                let mut chunks = vec![(*b"JSON", json), (*b"BIN\0", binary)];
                chunks.extend(self.chunks.iter().cloned());
                glb(&chunks)
            }
            Packing::DataUri | Packing::External => text.into_bytes(),
        };
        Built { bytes, files }
    }

    fn buffer(&self, index: usize, bytes: &[u8]) -> String {
        let length = bytes.len();
        let slash = if self.odd { r"\/" } else { "/" };
        let uri = match self.packing {
            Packing::Glb if index == 0 => return format!(r#"{{"byteLength":{length}}}"#),
            Packing::External => format!("part%20{index}.bin"),
            Packing::Glb | Packing::DataUri => {
                let payload = STANDARD.encode(bytes).replace('/', slash);
                format!("data:application{slash}octet-stream;base64,{payload}")
            }
        };
        format!(r#"{{"byteLength":{length},"uri":"{uri}"}}"#)
    }
}

/// A primitive as JSON text.
pub fn primitive(position: usize, indices: Option<usize>, mode: u32) -> String {
    let indices = indices.map_or(String::new(), |indices| format!(r#","indices":{indices}"#));
    format!(r#"{{"attributes":{{"POSITION":{position}}}{indices},"mode":{mode}}}"#)
}

fn position_accessor(layout: Layout, points: &[[f64; 3]], base: &str, sparse: &str) -> String {
    let bound = |pick: fn(f64, f64) -> f64| {
        let numbers = [0, 1, 2].map(|axis| {
            points
                .iter()
                .map(|point| point[axis])
                .reduce(pick)
                .unwrap_or(0.0)
        });
        numbers.map(|number| format!("{}", number as f32)).join(",")
    };
    let mut json = format!(
        r#"{{{base}"componentType":{},"count":{},"type":"VEC3""#,
        layout.component.code(),
        points.len()
    );
    if layout.normalized {
        json.push_str(r#","normalized":true"#);
    }
    if layout.bounds {
        let (min, max) = (bound(f64::min), bound(f64::max));
        write!(json, r#","min":[{min}],"max":[{max}]"#).expect("writing to a string");
    }
    json.push_str(sparse);
    json.push('}');
    json
}

/// Puts white space of changing kind around structural characters, and some after the end.
fn spread(text: &str) -> String {
    let mut output = String::from("\t");
    let (mut in_string, mut escaped) = (false, false);
    for (position, character) in text.chars().enumerate() {
        output.push(character);
        if in_string {
            in_string = escaped || character != '"';
            escaped = !escaped && character == '\\';
        } else if character == '"' {
            in_string = true;
        } else if "{}[]:,".contains(character) {
            output.push_str(["", " ", "\n", "\t  ", "\r\n"][position % 5]);
        }
    }
    output.push_str(" \n  ");
    output
}
