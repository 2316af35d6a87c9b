pub mod compress;
pub mod fixtures;
pub mod glb;
pub mod gltf_builder;
