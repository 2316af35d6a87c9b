//! The part of the glTF 2.0 JSON schema that concerns geometry, borrowed from the original text.
//!
//! The enumerations are the `gltf` crate's. Its objects are not used: they round transforms to f32,
//! wrap indices to 32 bits, merge all application-specific attributes into one, refuse a scene
//! without nodes, and forget where in the text a value stood, which lossless writing needs. They
//! would also bring materials, textures and cameras, none of which is of use here, into the
//! WebAssembly module.

use std::collections::BTreeMap;

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Mode;
use serde_json::value::RawValue;

use super::DocumentError;
use super::json::{FromJson, Object, Place, wrong};

/// The most nodes. The shortest, `{},`, has 3 bytes and takes 530 of memory, with what is made of it: 530 MiB of address space
/// natively, 130 MiB in a browser tab.
pub(super) const MAX_NODES: usize = if cfg!(target_pointer_width = "32") {
    1 << 18
} else {
    1 << 20
};

pub(super) struct Root<'a> {
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    pub accessors: Vec<Accessor<'a>>,
    pub animations: Vec<Animation>,
    pub buffers: Vec<Buffer<'a>>,
    pub buffer_views: Vec<BufferView<'a>>,
    pub images: Vec<Image>,
    pub meshes: Vec<Mesh<'a>>,
    pub nodes: Vec<Node>,
    pub scenes: Vec<Scene>,
    pub skins: Vec<&'a RawValue>,
}

pub(super) struct Accessor<'a> {
    pub buffer_view: Option<u64>,
    pub byte_offset: u64,
    pub component_type: ComponentType,
    pub normalized: bool,
    pub count: u64,
    pub kind: Type,
    pub min: Option<&'a RawValue>,
    pub max: Option<&'a RawValue>,
    pub sparse: Option<Sparse>,
}

pub(super) struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

pub(super) struct SparseIndices {
    pub buffer_view: u64,
    pub byte_offset: u64,
    pub component_type: ComponentType,
}

pub(super) struct SparseValues {
    pub buffer_view: u64,
    pub byte_offset: u64,
}

pub(super) struct Animation {
    pub samplers: Vec<AnimationSampler>,
}

pub(super) struct AnimationSampler {
    pub input: u64,
    pub output: u64,
}

pub(super) struct Buffer<'a> {
    pub byte_length: u64,
    /// A JSON string, with its quotes.
    pub uri: Option<&'a RawValue>,
}

pub(super) struct BufferView<'a> {
    pub buffer: u64,
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    pub extensions: BTreeMap<String, &'a RawValue>,
}

pub(super) struct Image {
    pub buffer_view: Option<u64>,
}

pub(super) struct Mesh<'a> {
    pub primitives: Vec<Primitive<'a>>,
}

pub(super) struct Primitive<'a> {
    pub attributes: BTreeMap<String, u64>,
    pub indices: Option<u64>,
    pub mode: Mode,
    pub targets: Vec<BTreeMap<String, u64>>,
    pub extensions: BTreeMap<String, &'a RawValue>,
}

pub(super) struct Node {
    pub name: Option<String>,
    pub children: Vec<u64>,
    pub mesh: Option<u64>,
    pub skin: Option<u64>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    /// The attributes of `EXT_mesh_gpu_instancing`.
    pub instances: BTreeMap<String, u64>,
}

pub(super) struct Scene {
    pub nodes: Vec<u64>,
}

impl<'a> Root<'a> {
    pub fn parse(text: &'a str) -> Result<Self, DocumentError> {
        let root = Object::root(text.strip_prefix('\u{feff}').unwrap_or(text))?;
        let version: String =
            Object::new(root.required("asset")?, Place::Field(&Place::Root, "asset"))?
                .required("version")?;
        if version.split('.').next() != Some("2") {
            return Err(DocumentError::VersionUnsupported { version });
        }
        Ok(Root {
            extensions_used: root.or_default("extensionsUsed")?,
            extensions_required: root.or_default("extensionsRequired")?,
            accessors: root.or_default("accessors")?,
            animations: root.or_default("animations")?,
            buffers: root.or_default("buffers")?,
            buffer_views: root.or_default("bufferViews")?,
            images: root.or_default("images")?,
            meshes: root.or_default("meshes")?,
            nodes: root.at_most("nodes", MAX_NODES, "the number of nodes")?,
            scenes: root.or_default("scenes")?,
            skins: root.or_default("skins")?,
        })
    }
}

/// Implements [`FromJson`] for a struct: each field with the way its member is read.
macro_rules! from_json {
    ($name:ty { $($field:ident: $how:ident $member:literal),* $(,)? }) => {
        impl<'a> FromJson<'a> for $name {
            fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError> {
                let object = Object::new(raw, place)?;
                Ok(Self { $($field: object.$how($member)?),* })
            }
        }
    };
}

from_json!(Accessor<'a> {
    buffer_view: optional "bufferView",
    byte_offset: or_default "byteOffset",
    component_type: required "componentType",
    normalized: or_default "normalized",
    count: required "count",
    kind: required "type",
    min: optional "min",
    max: optional "max",
    sparse: optional "sparse",
});
from_json!(Sparse {
    count: required "count",
    indices: required "indices",
    values: required "values",
});
from_json!(SparseIndices {
    buffer_view: required "bufferView",
    byte_offset: or_default "byteOffset",
    component_type: required "componentType",
});
from_json!(SparseValues {
    buffer_view: required "bufferView",
    byte_offset: or_default "byteOffset",
});
from_json!(Animation { samplers: or_default "samplers" });
from_json!(AnimationSampler {
    input: required "input",
    output: required "output",
});
from_json!(Buffer<'a> {
    byte_length: required "byteLength",
    uri: optional "uri",
});
from_json!(BufferView<'a> {
    buffer: required "buffer",
    byte_offset: or_default "byteOffset",
    byte_length: required "byteLength",
    byte_stride: optional "byteStride",
    extensions: or_default "extensions",
});
from_json!(Image { buffer_view: optional "bufferView" });
from_json!(Mesh<'a> { primitives: required "primitives" });
from_json!(Primitive<'a> {
    attributes: required "attributes",
    indices: optional "indices",
    mode: or_default "mode",
    targets: or_default "targets",
    extensions: or_default "extensions",
});
from_json!(Scene { nodes: or_default "nodes" });

impl<'a> FromJson<'a> for Node {
    fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError> {
        let object = Object::new(raw, place)?;
        Ok(Self {
            // A name says nothing of geometry: what is none is let pass.
            name: object.optional("name").unwrap_or_default(),
            children: object.or_default("children")?,
            mesh: object.optional("mesh")?,
            skin: object.optional("skin")?,
            matrix: object.optional("matrix")?,
            translation: object.optional("translation")?,
            rotation: object.optional("rotation")?,
            scale: object.optional("scale")?,
            instances: instances(&object, place)?,
        })
    }
}

fn instances(node: &Object, place: Place) -> Result<BTreeMap<String, u64>, DocumentError> {
    const NAME: &str = "EXT_mesh_gpu_instancing";
    let place = Place::Field(&place, "extensions");
    let Some(extensions) = node.optional("extensions")? else {
        return Ok(BTreeMap::new());
    };
    let Some(instancing) = Object::new(extensions, place)?.optional(NAME)? else {
        return Ok(BTreeMap::new());
    };
    Object::new(instancing, Place::Field(&place, NAME))?.or_default("attributes")
}

impl FromJson<'_> for ComponentType {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        let all = [
            Self::I8,
            Self::U8,
            Self::I16,
            Self::U16,
            Self::U32,
            Self::F32,
        ];
        let code = u64::from_json(raw, place)?;
        let component = all
            .into_iter()
            .find(|component| u64::from(component.as_gl_enum()) == code);
        component.ok_or_else(|| wrong("the number type is not one of glTF's", place))
    }
}

impl FromJson<'_> for Mode {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        let all = [
            Self::Points,
            Self::Lines,
            Self::LineLoop,
            Self::LineStrip,
            Self::Triangles,
            Self::TriangleStrip,
            Self::TriangleFan,
        ];
        let code = u64::from_json(raw, place)?;
        let mode = all
            .into_iter()
            .find(|mode| u64::from(mode.as_gl_enum()) == code);
        mode.ok_or_else(|| wrong("the primitive mode is not one of glTF's", place))
    }
}

impl FromJson<'_> for Type {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        Ok(match String::from_json(raw, place)?.as_str() {
            "SCALAR" => Self::Scalar,
            "VEC2" => Self::Vec2,
            "VEC3" => Self::Vec3,
            "VEC4" => Self::Vec4,
            "MAT2" => Self::Mat2,
            "MAT3" => Self::Mat3,
            "MAT4" => Self::Mat4,
            _ => return Err(wrong("the element type is not one of glTF's", place)),
        })
    }
}
