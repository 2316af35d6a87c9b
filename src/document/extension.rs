//! Which glTF extensions can be accepted: those that leave the meaning of positions alone.
//!
//! An extension that is only used, not required, is accepted: the file must make sense without it.

use std::fmt;

use super::DocumentError;
use super::schema::Root;

/// Extensions that store geometry in compressed form. Where no codec has taken them out, they are refused, even if a plain copy of
/// the data accompanies the compressed one, since a mark in one of two copies would be wrong.
const COMPRESSION: &[&str] = &[
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MESHOPT_compression",
];

/// How the names of required extensions begin that are accepted, with the reason. What is not here may change the geometry: morphing
/// by features, splats, voxels, implicit surfaces, primitive restart, timed or wider numbers.
const ACCEPTED: &[&str] = &[
    // Read here: integer positions, and copies of a mesh.
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    // How a surface looks: it shades, and never moves.
    "ADOBE_materials_",
    "EXT_materials_",
    "KHR_materials_",
    "KHR_techniques_webgl",
    "NV_materials_",
    "VRMC_materials_",
    // Image formats, and where images lie on the surface.
    "ASOBO_normal_map_convention",
    "EXT_texture_",
    "KHR_texture_",
    "MSFT_packing_",
    "MSFT_texture_",
    // Lights and surroundings.
    "EXT_lights_",
    "KHR_environment_map",
    "KHR_lights_",
    // Sounds.
    "KHR_audio",
    "MSFT_audio_emitter",
    // Bodies that collide: shapes of their own, beside the meshes.
    "KHR_collision_shapes",
    "KHR_implicit_shapes",
    "KHR_physics_rigid_bodies",
    "KHR_rigid_bodies",
    // What can be done with the scene, and what can happen in it: no geometry is made.
    "AGI_articulations",
    "KHR_animation_pointer",
    "KHR_interactivity",
    "KHR_node_",
    // Names and numbers for vertices, meshes and files; lines to draw along edges; other lists of the same triangles.
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_mesh_primitive_edge_visibility",
    "EXT_structural_metadata",
    "FB_geometry_metadata",
    "FB_ngon_encoding",
    "GODOT_single_root",
    "KHR_xmp",
    // Levels of detail: each is a mesh of the file.
    "MSFT_lod",
    // Who a figure is and how it moves: bones, springs, expressions, seats, names.
    "OMI_",
    "VRM",
    // Where on the globe the whole lies.
    "CESIUM_RTC",
];

/// Refuses required extensions that are not known to be harmless. What [`check_compression`] is for passes.
pub(super) fn check_required(root: &Root) -> Result<(), DocumentError> {
    for (index, name) in root.extensions_required.iter().enumerate() {
        let is_accepted = ACCEPTED.iter().any(|accepted| name.starts_with(accepted));
        if !is_accepted && !COMPRESSION.contains(&name.as_str()) {
            return Err(DocumentError::ExtensionUnsupported {
                pointer: format!("/extensionsRequired/{index}"),
                name: name.clone(),
            });
        }
    }
    Ok(())
}

/// Refuses compressed geometry.
pub(super) fn check_compression(root: &Root) -> Result<(), DocumentError> {
    for (index, name) in root.extensions_required.iter().enumerate() {
        refuse_compression(name, format_args!("/extensionsRequired/{index}"))?;
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
