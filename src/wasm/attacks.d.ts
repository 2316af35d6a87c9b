/** Bytes of files that a `.gltf` names by URI, keyed by that URI (percent-decoded). */
export type Files = Record<string, Uint8Array>;

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

/** What is thrown: a stable `code`, words for people, and for documents a JSON pointer. */
export interface MeshmarkErrorObject {
  code: string;
  message: string;
  path: string | null;
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
