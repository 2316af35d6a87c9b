//! Which glTF extensions can be accepted: those that leave the meaning of positions alone.
//!
//! An extension that is only used, not required, is accepted: the file must make sense without it.

use std::fmt;

use super::DocumentError;
use super::schema::Root;

/// Extensions that store geometry in compressed form. They are refused even where a plain copy of
/// the data accompanies the compressed one, since a mark in one of two copies would be wrong.
const COMPRESSION: &[&str] = &[
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MESHOPT_compression",
];

/// Required extensions that are accepted, with the reason.
const ACCEPTED: &[&str] = &[
    // Read here: integer positions.
    "KHR_mesh_quantization",
    // Places copies of a mesh; its accessors are kept from being changed.
    "EXT_mesh_gpu_instancing",
    // Lights, animation targets, visibility, metadata: no vertex data.
    "EXT_instance_features",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_node_visibility",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    // Image formats and texture coordinates.
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "MSFT_texture_dds",
];

/// Materials shade a surface and never move it.
const ACCEPTED_PREFIX: &str = "KHR_materials_";

/// Refuses compressed geometry and required extensions that are not known to be harmless.
pub(super) fn check(root: &Root) -> Result<(), DocumentError> {
    for (index, name) in root.extensions_required.iter().enumerate() {
        let pointer = format_args!("/extensionsRequired/{index}");
        refuse_compression(name, pointer)?;
        if !ACCEPTED.contains(&name.as_str()) && !name.starts_with(ACCEPTED_PREFIX) {
            return Err(DocumentError::ExtensionUnsupported {
                pointer: pointer.to_string(),
                name: name.clone(),
            });
        }
    }
    for (index, view) in root.buffer_views.iter().enumerate() {
        for name in view.extensions.keys() {
            refuse_compression(name, format_args!("/bufferViews/{index}/extensions/{name}"))?;
        }
    }
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (part, primitive) in mesh.primitives.iter().enumerate() {
            for name in primitive.extensions.keys() {
                refuse_compression(
                    name,
                    format_args!("/meshes/{index}/primitives/{part}/extensions/{name}"),
                )?;
            }
        }
    }
    Ok(())
}

fn refuse_compression(name: &str, pointer: fmt::Arguments) -> Result<(), DocumentError> {
    if COMPRESSION.contains(&name) {
        return Err(DocumentError::CompressionUnsupported {
            pointer: pointer.to_string(),
            name: name.to_owned(),
        });
    }
    Ok(())
}
