//! A second, naive reader of well-formed documents, to compare with.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use meshmark::internals::document::Files;
use serde_json::Value;

use crate::support::gltf_builder::{Built, Component};

/// A taken-apart document.
pub struct Oracle {
    pub json: Value,
    /// The JSON text without the payloads of data URIs.
    pub text: String,
    pub buffers: Vec<Vec<u8>>,
    /// The GLB bytes after the JSON and binary chunks.
    pub rest: Vec<u8>,
}

/// A buffer and an offset in it.
pub type Place = (usize, usize);

impl Oracle {
    pub fn read(model: &Built) -> Self {
        Self::read_parts(&model.bytes, &model.files)
    }

    pub fn read_parts(bytes: &[u8], files: &Files) -> Self {
        let (text, chunk, rest) = if bytes.starts_with(b"glTF") {
            let word = |at: usize| {
                u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
            };
            assert_eq!(word(8), bytes.len(), "the GLB length");
            let binary = 20 + word(12);
            let end = binary + 8 + word(binary);
            (
                &bytes[20..binary],
                Some(&bytes[binary + 8..end]),
                &bytes[end..],
            )
        } else {
            (bytes, None, &[][..])
        };
        let text = std::str::from_utf8(text).expect("UTF-8");
        let json: Value = serde_json::from_str(text.trim_start_matches('\u{feff}')).expect("JSON");
        let buffers = json["buffers"]
            .as_array()
            .map_or(&[][..], Vec::as_slice)
            .iter()
            .map(|buffer| match buffer["uri"].as_str() {
                None => chunk.expect("a binary chunk").to_vec(),
                Some(uri) => match uri.split_once(";base64,") {
                    Some((_, payload)) => STANDARD.decode(payload).expect("base64"),
                    None => files[&uri.replace("%20", " ")].clone(),
                },
            });
        Self {
            buffers: buffers.collect(),
            text: without_payloads(text),
            rest: rest.to_vec(),
            json,
        }
    }

    /// The accessors that are positions of some primitive.
    pub fn position_accessors(&self) -> Vec<usize> {
        let meshes = self.json["meshes"].as_array().into_iter().flatten();
        let primitives =
            meshes.flat_map(|mesh| mesh["primitives"].as_array().into_iter().flatten());
        let mut accessors: Vec<usize> = primitives
            .filter_map(|primitive| Some(number(primitive["attributes"].get("POSITION")?)))
            .collect();
        accessors.sort_unstable();
        accessors.dedup();
        accessors
    }

    pub fn component(&self, accessor: usize) -> Component {
        let code = number(&self.json["accessors"][accessor]["componentType"]) as u32;
        let all = [
            Component::I8,
            Component::U8,
            Component::I16,
            Component::U16,
            Component::U32,
            Component::F32,
        ];
        all.into_iter()
            .find(|component| component.code() == code)
            .expect("a component type")
    }

    /// Where each position of an accessor is stored.
    pub fn places(&self, accessor: usize) -> Vec<Option<Place>> {
        let size = 3 * self.component(accessor).size();
        let accessor = &self.json["accessors"][accessor];
        let count = number(&accessor["count"]);
        let start = |view: &Value, part: &Value| {
            let view = &self.json["bufferViews"][number(view)];
            let stride = view["byteStride"]
                .as_u64()
                .map_or(size, |stride| stride as usize);
            (
                number(&view["buffer"]),
                number(&view["byteOffset"]) + number(&part["byteOffset"]),
                stride,
            )
        };
        let mut places = vec![None; count];
        if accessor["bufferView"].is_u64() {
            let (buffer, offset, stride) = start(&accessor["bufferView"], accessor);
            places = (0..count)
                .map(|index| Some((buffer, offset + index * stride)))
                .collect();
        }
        let sparse = &accessor["sparse"];
        if sparse.is_object() {
            let (index_buffer, index_offset, _) =
                start(&sparse["indices"]["bufferView"], &sparse["indices"]);
            let (buffer, offset, _) = start(&sparse["values"]["bufferView"], &sparse["values"]);
            assert_eq!(
                number(&sparse["indices"]["componentType"]),
                5123,
                "only u16 sparse indices are made here"
            );
            for place in 0..number(&sparse["count"]) {
                let at = index_offset + 2 * place;
                let index = u16::from_le_bytes([
                    self.buffers[index_buffer][at],
                    self.buffers[index_buffer][at + 1],
                ]);
                places[usize::from(index)] = Some((buffer, offset + place * size));
            }
        }
        places
    }

    /// The numbers of each position as they are stored.
    pub fn raw(&self, accessor: usize) -> Vec<[f64; 3]> {
        let component = self.component(accessor);
        let read = |place: Option<Place>| {
            [0, 1, 2].map(|axis| {
                place.map_or(0.0, |(buffer, offset)| {
                    let at = &self.buffers[buffer][offset + axis * component.size()..];
                    match component {
                        Component::I8 => f64::from(at[0] as i8),
                        Component::U8 => f64::from(at[0]),
                        Component::I16 => f64::from(i16::from_le_bytes([at[0], at[1]])),
                        Component::U16 => f64::from(u16::from_le_bytes([at[0], at[1]])),
                        Component::U32 => {
                            f64::from(u32::from_le_bytes([at[0], at[1], at[2], at[3]]))
                        }
                        Component::F32 => {
                            f64::from(f32::from_le_bytes([at[0], at[1], at[2], at[3]]))
                        }
                    }
                })
            })
        };
        self.places(accessor).into_iter().map(read).collect()
    }

    /// The JSON without `min` and `max` of these accessors and without the payloads of data URIs.
    pub fn json_without_bounds(&self, accessors: &[usize]) -> Value {
        let mut json = self.json.clone();
        for &accessor in accessors {
            let accessor = json["accessors"][accessor]
                .as_object_mut()
                .expect("an accessor");
            accessor.remove("min");
            accessor.remove("max");
        }
        for buffer in json["buffers"].as_array_mut().into_iter().flatten() {
            if let Some((header, _)) = buffer["uri"]
                .as_str()
                .and_then(|uri| uri.split_once(";base64,"))
            {
                buffer["uri"] = Value::from(header);
            }
        }
        json
    }

    /// The JSON text without numbers in any `"min"` or `"max"` list, and without padding at its end.
    pub fn text_without_bounds(&self) -> String {
        let mut output = String::new();
        let mut rest = self.text.trim_end_matches(' ');
        while let Some(start) = [r#""min""#, r#""max""#]
            .iter()
            .filter_map(|key| rest.find(key))
            .min()
        {
            let open = start + rest[start..].find('[').expect("a list");
            let close = open + rest[open..].find(']').expect("the list's end");
            output.push_str(&rest[..open]);
            output.extend(
                rest[open..close]
                    .chars()
                    .filter(|character| !"+-.0123456789eE".contains(*character)),
            );
            rest = &rest[close..];
        }
        output + rest
    }
}

/// An index, size or offset; 0 if it is not stated.
fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or(0) as usize
}

fn without_payloads(text: &str) -> String {
    let mut output = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(";base64,") {
        output.push_str(&rest[..start]);
        let end = rest[start..].find('"').expect("the string's end");
        rest = &rest[start + end..];
    }
    output + rest
}
