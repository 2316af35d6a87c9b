//! Lossless glTF.

mod cases;
mod compressed;
mod examples;
#[cfg(not(target_arch = "wasm32"))]
mod fuzzed;
mod laws;
mod malformed;
#[cfg(not(target_arch = "wasm32"))]
mod models;
mod oracle;
