pub mod fixtures;
pub mod gltf_builder;
