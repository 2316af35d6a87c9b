//! The study. Its functions take the mesh with every call: a worker that was ended has lost nothing.

use super::options::Options;
use super::{argument, encoded, set, thrown};
use crate::document::Document;
use crate::geometry::diagonal;
use crate::mesh::Mesh;
use crate::paper::figure_5::{self, Case, Hosts};
use crate::paper::{self, Barycentre, HostsOptions, Preparation, Ranking, Smoothing};
use crate::scene::Scene;
use crate::watermark::Error;
use glam::DVec3;
use js_sys::{Float64Array, Object, Reflect, Uint32Array};
use serde::{Deserialize, Serialize};
use wasm_bindgen::prelude::*;

/// Smoothing more often would fill the memory: a subdivision gives four times the faces.
const MAX_ITERATIONS: u32 = 2;

/// The numbers that the study is made with.
#[wasm_bindgen(skip_typescript)]
pub fn parameters() -> Result<JsValue, JsValue> {
    #[derive(Serialize)]
    #[serde(rename_all = "camelCase")]
    struct Parameters {
        num_triangles: usize,
        num_hosts: u32,
        strength: f64,
        strengths: [f64; 5],
    }
    encoded(&Parameters {
        num_triangles: paper::NUM_FACES,
        num_hosts: HostsOptions::default().num_hosts,
        strength: figure_5::STRENGTH,
        strengths: figure_5::STRENGTHS,
    })
}

/// A model as the paper's.
#[wasm_bindgen(skip_typescript)]
pub fn prepare(model: &[u8], preparation: &str, options: JsValue) -> Result<Object, JsValue> {
    let files = Options::new(options, &["files"])?.files("files")?;
    let preparation = Preparation::from_name(preparation)
        .ok_or_else(|| argument(&format!("there is no preparation {preparation:?}")))?;
    let scene = Document::read(model, &files)
        .map_err(Error::from)
        .and_then(|document| Scene::gather(&document).map_err(Error::from))
        .map_err(thrown)?;
    let mesh = preparation.apply(&scene.mesh);
    let result = Object::new();
    let positions: Vec<f64> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
    set(&result, "positions", &reals(&positions))?;
    set(
        &result,
        "triangles",
        &indices(mesh.triangles.as_flattened()),
    )?;
    set(&result, "diagonal", &diagonal(&mesh.positions).into())?;
    let [vertices, triangles] = [scene.mesh.positions.len(), scene.mesh.triangles.len()];
    set(&result, "modelVertices", &(vertices as f64).into())?;
    set(&result, "modelTriangles", &(triangles as f64).into())?;
    Ok(result)
}

/// Vertices, the most stable first.
#[wasm_bindgen(skip_typescript)]
pub fn rank(mesh: JsValue, ranking: &str) -> Result<Uint32Array, JsValue> {
    let stability = paper::rank(&mesh_from(&mesh)?, ranking_from(ranking)?);
    Ok(indices(&stability.order))
}

/// Numbers at every vertex.
#[wasm_bindgen(skip_typescript)]
pub fn fields(mesh: JsValue, ranking: &str) -> Result<Object, JsValue> {
    let fields = paper::fields(&mesh_from(&mesh)?, ranking_from(ranking)?);
    let result = Object::new();
    set(&result, "gaussian", &reals(&fields.gaussian))?;
    set(&result, "mean", &reals(&fields.mean))?;
    set(&result, "stability", &reals(&fields.stability))?;
    Ok(result)
}

/// Smooths a mesh and looks for its hosts.
#[wasm_bindgen(skip_typescript)]
pub fn trace(mesh: JsValue, options: JsValue) -> Result<Object, JsValue> {
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Asked {
        smoothing: Smoothing,
        iterations: u32,
        ranking: Ranking,
        num_hosts: u32,
    }
    let known = ["smoothing", "iterations", "ranking", "numHosts"];
    let asked: Asked = Options::new(options, &known)?.decoded()?;
    let tracing = paper::trace(
        &mesh_from(&mesh)?,
        asked.smoothing,
        iterations_from(asked.iterations)?,
        asked.ranking,
        asked.num_hosts as usize,
    );
    let result = Object::new();
    set(&result, "positions", &reals(&tracing.positions))?;
    set(&result, "triangles", &indices(&tracing.triangles))?;
    set(&result, "deviation", &reals(&tracing.deviation))?;
    set(&result, "hosts", &indices(&tracing.hosts))?;
    set(&result, "found", &encoded(&tracing.found)?)?;
    set(&result, "hostsAfter", &indices(&tracing.hosts_after))?;
    Ok(result)
}

/// A row of Table I.
#[wasm_bindgen(skip_typescript)]
pub fn hosts(mesh: JsValue, options: JsValue) -> Result<JsValue, JsValue> {
    #[derive(Deserialize)]
    struct Asked {
        smoothing: Smoothing,
        iterations: u32,
    }
    let known = [
        "smoothing",
        "iterations",
        "draws",
        "seed",
        "numHosts",
        "tau",
    ];
    let options = Options::new(options, &known)?;
    let asked: Asked = options.decoded()?;
    let counting: HostsOptions = options.decoded()?;
    encoded(&paper::hosts(
        &mesh_from(&mesh)?,
        asked.smoothing,
        iterations_from(asked.iterations)?,
        &counting,
    ))
}

/// A point of Fig. 5, for each way of finding.
#[wasm_bindgen(skip_typescript)]
pub fn errors(mesh: JsValue, options: JsValue) -> Result<JsValue, JsValue> {
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Asked {
        hosts: String,
        smoothing: Smoothing,
        iterations: u32,
        strength: f64,
        keys: u32,
    }
    let known = [
        "hosts",
        "smoothing",
        "iterations",
        "strength",
        "keys",
        "onProgress",
    ];
    let options = Options::new(options, &known)?;
    let (mesh, asked) = (mesh_from(&mesh)?, options.decoded::<Asked>()?);
    let case = Case {
        hosts: Hosts::every()
            .find(|hosts| hosts.name() == asked.hosts)
            .ok_or_else(|| argument(&format!("there are no hosts {:?}", asked.hosts)))?,
        barycentre: Barycentre::Vertices,
        strength: asked.strength,
        smoothing: asked.smoothing,
        iterations: iterations_from(asked.iterations)?,
    };
    let keys = 0..u64::from(asked.keys);
    let errors = figure_5::errors(&mesh, &case, keys, &mut options.listener()?);
    encoded(&errors.map_err(Error::from).map_err(thrown)?)
}

fn mesh_from(value: &JsValue) -> Result<Mesh, JsValue> {
    let wrong = || argument("a mesh has positions and triangles, three numbers each");
    let field = |name: &str| Reflect::get(value, &name.into()).map_err(|_| wrong());
    let positions: Float64Array = field("positions")?.dyn_into().map_err(|_| wrong())?;
    let triangles: Uint32Array = field("triangles")?.dyn_into().map_err(|_| wrong())?;
    let (positions, triangles) = (positions.to_vec(), triangles.to_vec());
    let (points, left) = positions.as_chunks::<3>();
    let (triangles, over) = triangles.as_chunks::<3>();
    let is_whole = left.is_empty() && over.is_empty();
    let is_finite = positions.iter().all(|x| x.is_finite());
    let is_inside = |&vertex: &u32| (vertex as usize) < points.len();
    if !(is_whole && is_finite && triangles.as_flattened().iter().all(is_inside)) {
        return Err(wrong());
    }
    Ok(Mesh {
        positions: points.iter().map(|&point| DVec3::from(point)).collect(),
        triangles: triangles.to_vec(),
    })
}

fn ranking_from(name: &str) -> Result<Ranking, JsValue> {
    Ranking::from_name(name).ok_or_else(|| argument(&format!("there is no ranking {name:?}")))
}

fn iterations_from(iterations: u32) -> Result<u32, JsValue> {
    if iterations > MAX_ITERATIONS {
        let most = format!("a mesh is smoothed at most {MAX_ITERATIONS} times");
        return Err(argument(&most));
    }
    Ok(iterations)
}

fn reals(numbers: &[f64]) -> Float64Array {
    Float64Array::from(numbers)
}

fn indices(vertices: &[u32]) -> Uint32Array {
    Uint32Array::from(vertices)
}
