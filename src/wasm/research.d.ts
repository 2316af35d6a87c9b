/** Bytes of files that a `.gltf` names by URI, keyed by that URI (percent-decoded). */
export type Files = Record<string, Uint8Array>;

/** What is thrown: a stable `code`, words for people, and for documents a JSON pointer. */
export interface MeshmarkErrorObject {
  code: string;
  message: string;
  path: string | null;
}

/** What stability is judged by: all that the paper names, the same integrated over cells, or the cost of the cheapest collapse. */
export type Ranking = "literal" | "integrated" | "collapse";

/** Of each, vertices keep their indices. `meshSmooth` is the paper's: Catmull and Clark's subdivision. */
export type Smoothing =
  | "meshSmooth"
  | "loop"
  | "sqrt3"
  | "midpoint"
  | "laplacian"
  | "bilaplacian"
  | "meanCurvatureFlow"
  | "taubin"
  | "meanFilter";

/** How a model is brought to the paper's size: by a face threshold, as there, or by quadric error metrics. */
export type Preparation = "optimize" | "simplify";

export interface PrepareOptions {
  /** What the model names by URI. Default: none. */
  files?: Files | undefined;
}

/** Three coordinates a vertex, in scene units, and three vertices a triangle. */
export interface StudyMesh {
  positions: Float64Array;
  triangles: Uint32Array;
}

/** The numbers that the study is made with. */
export interface Parameters {
  /** Triangles that a model is brought to, at most. */
  numTriangles: number;
  /** Hosts of the paper. */
  numHosts: number;
  /** The strength at which smoothings are compared, and those of Fig. 5: RMS displacements as fractions of the diagonal. */
  strength: number;
  strengths: number[];
}

/** A model's mesh, with at most as many faces as the paper's. */
export interface Prepared extends StudyMesh {
  /** Bounding-box diagonal in scene units. */
  diagonal: number;
  /** What the model has itself, instances counted each, welded. */
  modelVertices: number;
  modelTriangles: number;
}

/** Numbers at every vertex. */
export interface Fields {
  /** Curvatures by quadrics: inverse squared, and inverse, scene units; the mean one is positive where the surface bulges. */
  gaussian: Float64Array;
  mean: Float64Array;
  /** Place in the ranking: 1 for the most stable vertex, down to 0; 0 too for those that were rejected. */
  stability: Float64Array;
}

export interface TraceOptions {
  smoothing: Smoothing;
  /** How often it is done: 0 to 2. */
  iterations: number;
  ranking: Ranking;
  numHosts: number;
}

/** Hosts before and after smoothing. The mesh is the smoothed one. */
export interface Tracing extends StudyMesh {
  /** How far each vertex that was there before has moved, as a fraction of the diagonal. */
  deviation: Float64Array;
  /** The hosts, the most stable first, and whether each is among as many best vertices of the smoothed mesh. */
  hosts: Uint32Array;
  found: boolean[];
  /** Those best vertices, the most stable first. */
  hostsAfter: Uint32Array;
}

/** Mean, standard deviation, least and greatest of several draws. */
export interface Spread {
  mean: number;
  deviation: number;
  least: number;
  most: number;
}

/**
 * What counts as found again, for a mesh of N vertices that has N' after smoothing.
 * `index`: of the best N of all N', those that were there before.
 * `region`: vertices that have one of those best N near where they were.
 * `overlap`: of the best hosts before, those that are among as many best ones after.
 */
export type Rule = "index" | "region" | "overlap";

export interface HostsOptions {
  smoothing: Smoothing;
  /** How often it is done: 0 to 2. */
  iterations: number;
  /** Draws of random hosts. Default: 20. */
  draws?: number | undefined;
  /** What they are drawn with. Default: 1. */
  seed?: number | undefined;
  /** Hosts of the overlap rule. Default: 1000. */
  numHosts?: number | undefined;
  /** How near is near for the region rule, in mean edges. Default: 0.2. */
  tau?: number | undefined;
}

/** A row of Table I. */
export interface HostsRow {
  smoothing: Smoothing;
  iterations: number;
  numVerticesBefore: number;
  numVertices: number;
  rules: RuleCounts[];
}

export interface RuleCounts {
  rule: Rule;
  /** What random hosts come to by arithmetic; `null` for the region rule, which depends on the shape. */
  chance: number | null;
  random: Spread;
  /** Of each ranking its count, and that over the mean of random ones; `null` where those are never found. */
  ranked: { ranking: Ranking; count: number; ratio: number | null }[];
}

/** Which vertices hold the message: any, the best of a ranking, or all of them. */
export type Hosts = "random" | Ranking | "all";

/** How hosts are found again: indices known, ranked again, the original known, or by their direction. */
export type Finding = "traced" | "ranked" | "original" | "cells";

export interface ErrorsOptions {
  hosts: Hosts;
  smoothing: Smoothing;
  /** How often it is done: 0 to 2. */
  iterations: number;
  /** RMS displacement over all vertices, as a fraction of the diagonal. */
  strength: number;
  /** How many keys are tried, each with a message of its own. */
  keys: number;
  /** Hears how far the keys are: `fraction` from 0 to 1. */
  onProgress?: ((stage: string, fraction: number) => void) | undefined;
}

/** The errors of a case and one way of finding, over all keys. */
export interface Errors {
  hosts: Hosts;
  finding: Finding;
  /** What distances were measured from. */
  barycentre: "vertices";
  strength: number;
  smoothing: Smoothing;
  iterations: number;
  /** Share of wrong symbols before any code, and of wrong bits after decoding; 0.5 is chance. */
  raw: Spread;
  payload: Spread;
  /** Share of the keys whose text was read. */
  read: number;
}

/** The numbers that the study is made with. */
export function parameters(): Parameters;

/** A model as the paper's. */
export function prepare(model: Uint8Array, preparation: Preparation, options?: PrepareOptions): Prepared;

/** Vertices, the most stable first; those that were rejected as errors of topology are not among them. */
export function rank(mesh: StudyMesh, ranking: Ranking): Uint32Array;

/** Curvature and stability. */
export function fields(mesh: StudyMesh, ranking: Ranking): Fields;

/** Smooths a mesh and looks for its hosts. */
export function trace(mesh: StudyMesh, options: TraceOptions): Tracing;

/** A row of Table I. */
export function hosts(mesh: StudyMesh, options: HostsOptions): HostsRow;

/** A point of Fig. 5, for each way of finding. */
export function errors(mesh: StudyMesh, options: ErrorsOptions): Errors[];

/**
 * Where an attack comes from: the LIRIS benchmark, other smoothings, other triangles for the same surface, what happens to files
 * that nobody means harm, what somebody does who knows that there is a mark and has no key.
 */
export type Family = "benchmark" | "smoothing" | "retessellation" | "wild" | "deliberate";

/** An attack with all its levels. */
export interface Attack {
  name: string;
  family: Family;
  /** What follows a level: `" %"`, `" bits"`; empty where the level is a count. */
  unit: string;
  /** Weakest first; empty where there is nothing to choose. */
  levels: number[];
  /** What `attack` calls it at each level; one name where there are none. */
  steps: string[];
}

/** What an attack cost and left; `null` where there is nothing to compare. */
export interface Quality {
  /** RMS and largest distance of the surfaces, as fractions of the reference's diagonal. What was cut off or put beside costs nothing. */
  rmsRel: number | null;
  hausdorffRel: number | null;
  /** How visible the difference is, 0 to 1: mesh structural distortion. */
  msdm: number | null;
  /** Of the copy's scene, instances counted each, welded. */
  vertices: number;
  triangles: number;
}

export interface AttackOptions {
  /** What the model names by URI. Default: none. */
  files?: Files | undefined;
  /** What is random is drawn with: a whole number below 2^32. Equal seeds give equal copies. Default: 1. */
  seed?: number | undefined;
}

export interface QualityOptions {
  /** What the reference names by URI, and what the copy does. Default: none. */
  referenceFiles?: Files | undefined;
  files?: Files | undefined;
}

/** Every attack, in the order of tables. */
export function catalogue(): Attack[];

/**
 * A model after some steps, one upon the other, as a .glb of its triangles alone. Fails with code `attack.nothing-left` where no
 * triangle is left.
 */
export function attack(model: Uint8Array, steps: string[], options?: AttackOptions): Uint8Array;

/** How a copy differs from a reference. One that has the reference's triangles is put back first, if it was moved as a whole. */
export function quality(reference: Uint8Array, model: Uint8Array, options?: QualityOptions): Quality;
