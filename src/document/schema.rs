//! The part of the glTF 2.0 JSON schema that concerns geometry, borrowed from the original text.
//!
//! The enumerations are the `gltf` crate's. Its objects are not used: they round transforms to f32,
//! wrap indices to 32 bits, merge all application-specific attributes into one, refuse a scene
//! without nodes, and forget where in the text a value stood, which lossless writing needs. They
//! would also bring materials, textures, cameras and animations, none of which is of use here,
//! into the WebAssembly module.

use std::collections::BTreeMap;
use std::ops::Range;

use gltf::json::accessor::{GenericComponentType, IndexComponentType, Type};
use gltf::json::mesh::Mode;
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::DocumentError;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Envelope<'a> {
    asset: Asset,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(borrow)]
    accessors: Option<&'a RawValue>,
    animations: Option<&'a RawValue>,
    buffers: Option<&'a RawValue>,
    buffer_views: Option<&'a RawValue>,
    images: Option<&'a RawValue>,
    meshes: Option<&'a RawValue>,
    nodes: Option<&'a RawValue>,
    scenes: Option<&'a RawValue>,
    skins: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

pub(super) struct Root<'a> {
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    pub accessors: Vec<Accessor<'a>>,
    pub animations: Vec<Animation>,
    pub buffers: Vec<Buffer<'a>>,
    pub buffer_views: Vec<BufferView>,
    pub images: Vec<Image>,
    pub meshes: Vec<Mesh>,
    pub nodes: Vec<Node>,
    pub scenes: Vec<Scene>,
    pub skins: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor<'a> {
    pub buffer_view: Option<u64>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: Checked<GenericComponentType>,
    #[serde(default)]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: Checked<Type>,
    #[serde(borrow)]
    pub min: Option<&'a RawValue>,
    #[serde(borrow)]
    pub max: Option<&'a RawValue>,
    pub sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub buffer_view: u64,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: Checked<IndexComponentType>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub buffer_view: u64,
    #[serde(default)]
    pub byte_offset: u64,
}

#[derive(Deserialize)]
pub(super) struct Animation {
    #[serde(default)]
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Deserialize)]
pub(super) struct AnimationSampler {
    pub input: u64,
    pub output: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer<'a> {
    pub byte_length: u64,
    #[serde(borrow)]
    pub uri: Option<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: u64,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    #[serde(default)]
    pub extensions: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub buffer_view: Option<u64>,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: BTreeMap<String, u64>,
    pub indices: Option<u64>,
    #[serde(default)]
    pub mode: Checked<Mode>,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, u64>>,
    #[serde(default)]
    pub extensions: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub children: Vec<u64>,
    pub mesh: Option<u64>,
    pub skin: Option<u64>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    #[serde(default)]
    pub extensions: NodeExtensions,
}

#[derive(Default, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
}

#[derive(Deserialize)]
pub(super) struct Instancing {
    #[serde(default)]
    pub attributes: BTreeMap<String, u64>,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<u64>,
}

impl<'a> Root<'a> {
    pub fn parse(text: &'a str) -> Result<Self, DocumentError> {
        let json = text.strip_prefix('\u{feff}').unwrap_or(text);
        let envelope: Envelope =
            serde_json::from_str(json).map_err(|error| DocumentError::BadJson {
                detail: error.to_string(),
                pointer: None,
            })?;
        let version = envelope.asset.version;
        if version.split('.').next() != Some("2") {
            return Err(DocumentError::VersionUnsupported { version });
        }
        Ok(Root {
            extensions_used: envelope.extensions_used,
            extensions_required: envelope.extensions_required,
            accessors: list(envelope.accessors, "/accessors")?,
            animations: list(envelope.animations, "/animations")?,
            buffers: list(envelope.buffers, "/buffers")?,
            buffer_views: list(envelope.buffer_views, "/bufferViews")?,
            images: list(envelope.images, "/images")?,
            meshes: list(envelope.meshes, "/meshes")?,
            nodes: list(envelope.nodes, "/nodes")?,
            scenes: list(envelope.scenes, "/scenes")?,
            skins: list(envelope.skins, "/skins")?,
        })
    }
}

/// The items of a top-level list, each parsed alone so that an error can point to it.
fn list<'a, T: Deserialize<'a>>(
    raw: Option<&'a RawValue>,
    name: &str,
) -> Result<Vec<T>, DocumentError> {
    let Some(raw) = raw else {
        return Ok(Vec::new());
    };
    let items: Vec<&RawValue> = parse(raw, || name.to_owned())?;
    items
        .into_iter()
        .enumerate()
        .map(|(index, item)| parse(item, || format!("{name}/{index}")))
        .collect()
}

/// Parses one value of the text that is known to be well-formed JSON.
pub(super) fn parse<'a, T: Deserialize<'a>>(
    raw: &'a RawValue,
    pointer: impl Fn() -> String,
) -> Result<T, DocumentError> {
    serde_json::from_str(raw.get()).map_err(|error| {
        // The parser's position counts from the start of the value; the pointer says it better.
        let message = error.to_string();
        let detail = message
            .rsplit_once(" at line ")
            .map_or(&*message, |(detail, _)| detail);
        DocumentError::BadJson {
            detail: detail.to_owned(),
            pointer: Some(pointer()),
        }
    })
}

/// Where in `text` the value `part`, which was borrowed from it, stands.
pub(super) fn span(text: &str, part: &str) -> Option<Range<usize>> {
    let start = part.as_ptr().addr().checked_sub(text.as_ptr().addr())?;
    let end = start.checked_add(part.len())?;
    text.get(start..end).is_some().then_some(start..end)
}
