//! The test suite: the same tests natively, in node and in a browser, over the same generated fixtures.

#![allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should

// The attribute of a test for every target. Natively it is the compiler's own, and no crate for it has to be compiled.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use core::prelude::v1::test as portable_test;
#[cfg(target_arch = "wasm32")]
pub(crate) use wasm_bindgen_test::wasm_bindgen_test as portable_test;

mod architecture;
#[cfg(not(target_arch = "wasm32"))]
// the modules for JavaScript are without LOCAL, and embedding it takes a minute there
mod asked;
mod attack;
#[cfg(not(target_arch = "wasm32"))]
// a hundred thousand keys, and nothing that differs between targets
mod bound;
mod c2pa;
mod code;
mod copies;
mod curvature;
mod detection;
mod direction;
mod document;
mod evidence;
mod examples;
mod floors;
mod geometry;
mod golden;
mod informed;
mod key;
mod layers;
mod leeway;
mod levels;
#[cfg(not(target_arch = "wasm32"))]
// no module for JavaScript has LOCAL
mod local;
mod mesh;
mod models;
mod note;
mod paper;
mod payload;
mod pieces;
mod places;
mod quality;
mod reports;
mod ring;
mod robustness;
mod scene;
mod seams;
mod smoothing;
mod solid;
mod support;
mod suspects;
mod text;
mod trace;
mod vectors;
mod watermark;
mod wild;
