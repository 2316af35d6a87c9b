/** Bytes of files that a `.gltf` names by URI, keyed by that URI (percent-decoded). */
export type Files = Record<string, Uint8Array>;

/** What the work is at. */
export type Stage = "read" | "embed" | "write" | "measure" | "test" | "forecast";

/** Called as work goes on; `fraction` (0 to 1) is of the stage, not of the whole. If it throws, the work ends with code `aborted`. */
export type OnProgress = (stage: Stage, fraction: number) => void;

/** A file that a statement is about. */
export interface StatedFile {
  /** What it is to the reader: "Suspect", "Original". */
  role: string;
  name: string;
  bytes: number;
  sha256: string;
}

/** What a statement says beside what was found. */
export interface StatementOptions {
  /** Whose key it is, as they call themselves. Default: not said. */
  owner?: string | undefined;
  /** When it was looked at, in your words. Default: not said. */
  date?: string | undefined;
  /** What was looked at, the suspect first. Default: none. */
  files?: StatedFile[] | undefined;
  /** Command lines that repeat it. Default: none. */
  commands?: string[] | undefined;
}

/** Of every comparison. */
export interface ComparingOptions {
  /** Whether `lnP` is told where nothing is found too. Default: false. It follows the key: for the key's owner. */
  details?: boolean | undefined;
  /** Whether the suspect is laid on the original, to be looked at. Default: false. Its `evidence` follows the key: for the key's owner. */
  overlay?: boolean | undefined;
  /** Makes a statement of what was found, with a picture of the suspect laid on the original. Default: none is made. */
  statement?: StatementOptions | undefined;
  /** Default: nobody is told. */
  onProgress?: OnProgress | undefined;
}

/** Of a suspect that is no glTF. */
export interface CompareMeshOptions extends ComparingOptions {
  /** What an original that is a `.gltf` names by URI. Default: none, which does for a `.glb`. */
  originalFiles?: Files | undefined;
}

export interface CompareOptions extends CompareMeshOptions {
  /** What a suspect that is a `.gltf` names by URI. Default: none. */
  files?: Files | undefined;
}

/** Of a suspect that is read with a record. */
export interface CompareWithRecordOptions extends ComparingOptions {
  /** What a suspect that is a `.gltf` names by URI. Default: none. */
  files?: Files | undefined;
}

export interface RecordOptions {
  /** What an original that is a `.gltf` names by URI. Default: none. */
  originalFiles?: Files | undefined;
  /** The owner's name, in clear. Default: none. */
  owner?: string | undefined;
  /** When the model was marked, in clear. Default: none. */
  date?: string | undefined;
}

/** What a record names of an `EmbedReport`: the report itself will do. */
export interface Marking {
  tag: string | null;
  number: number | null;
  strength: number;
  hostSha256: string;
  markedSha256: string;
}

/** What `compare` says. */
export interface Comparison {
  /**
   * `found`: the payload was read and the chance of that without the key is at most 1e-9. `present`: a mark of this key is there, at the same
   * chance, without a payload that can be read. `partial`: something of this key is there, but not enough. `none`: no evidence of this key.
   */
  verdict: "found" | "present" | "partial" | "none";
  /** `same`: most of the suspect lies on the original, it is a copy of it or of a piece of it, whoever marked it. `other`: it does not. */
  shape: "same" | "other";
  /** Both in words. */
  sentence: string;
  /** The payload as a tag and as a number, where it is found. */
  tag: string | null;
  number: number | null;
  /** What told of the mark, where it is found or present: the surface, the vertices that were kept, or the suspect alone. */
  witness: "surface" | "vertices" | "blind" | null;
  /** The share of the suspect's surface that lies on the original, 0 to 1. */
  near: number;
  /** The share of the original's surface that the suspect shows, 0 to 1. */
  covered: number;
  /** Whether the suspect is a mirror image. */
  isMirrored: boolean;
  /** What takes the suspect onto the original: three columns of a linear map, and a shift, in the original's scene units. */
  motion: number[][] | null;
  /** Natural logarithm of the bound of the false-positive probability, every choice charged. There where found or present, or asked for. */
  lnP?: number;
  /** The suspect laid on the original, where that was asked for; `null` for another shape. */
  overlay?: Overlay | null;
  /** What was found as an HTML file for a person, where that was asked for. */
  statement?: string;
}

/** Triangles to be drawn. */
export interface Sheet {
  /** Three coordinates for each vertex, in the original's scene units. */
  positions: Float32Array;
  /** Three vertices for each triangle. */
  triangles: Uint32Array;
}

/** A suspect laid on its original. */
export interface Overlay {
  /** Whether the original is what a record keeps of it: some 1200 triangles, from which a copy differs a little everywhere. */
  isRecorded: boolean;
  /** The original, or what a record keeps of it. */
  original: Sheet;
  /** The suspect, moved to where it lies on the original. */
  suspect: Sheet;
  /** For each vertex of the original, how far away the suspect is, as a share of the diagonal; `Infinity` where nothing of the suspect is near. */
  differences: Float32Array;
  /** The same for each vertex of the suspect: `Infinity` where it has what the original has not. */
  additions: Float32Array;
  /** Up to where nearly all finite differences go: the end of a scale. */
  mostDifference: number;
  /**
   * For each vertex of the original, what a window of the mark there adds to the exponent on the average, in nats: above 0 it speaks for the
   * mark. `null` where the mark was not read with the original.
   */
  evidence: Float32Array | null;
  /** Up to where nearly all evidence goes. */
  mostEvidence: number;
  /** The original's diagonal, in its scene units. */
  diagonal: number;
  /** From where the suspect is seen well: a direction of unit length, away from the model. */
  from: number[];
}

/** What is thrown by a call that fails. */
export interface MeshmarkErrorObject {
  code: string;
  message: string;
  path: string | null;
}

/**
 * Reads a suspect with the original: the model as it was before it was marked. A copy is found so that `detect` finds no more: a piece with other
 * triangles, a mirror image, one that was stretched, smoothed or simplified.
 */
export function compare(suspect: Uint8Array, original: Uint8Array, key: Uint8Array, options?: CompareOptions): Comparison;

/** The same of a suspect that is no glTF: three coordinates for each vertex, three vertices for each triangle. */
export function compareMesh(
  positions: Float64Array,
  triangles: Uint32Array,
  original: Uint8Array,
  key: Uint8Array,
  options?: CompareMeshOptions,
): Comparison;

/** The same with the record of an embedding in the stead of the original: with about half of the exponent. */
export function compareWithRecord(suspect: Uint8Array, record: string, key: Uint8Array, options?: CompareWithRecordOptions): Comparison;

/**
 * The record of an embedding: JSON of some tens of kilobytes, to be kept where the original may be lost. It says to anybody whose and which
 * files it is of; only the key reads the rest.
 */
export function record(original: Uint8Array, report: Marking, key: Uint8Array, options?: RecordOptions): string;
