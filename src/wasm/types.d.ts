/** Bytes of files that a `.gltf` names by URI, keyed by that URI (percent-decoded). */
export type Files = Record<string, Uint8Array>;

/** Where a mark can live: `solid` in the shape, whatever its triangles are; `ring` in how vertices are connected. */
export type Carrier = "solid" | "ring";

/** The owner's 48 bits: a tag of 1 to 8 characters (`A-Z a-z 0-9 - .`, the last not `.`), or a whole number from 0 to 2^48 - 1. */
export type Payload = string | number;

/**
 * Upper limit of the RMS displacement, as a fraction of the bounding box's diagonal (0.00001 to 0.01), or a preset:
 * `subtle` 0.0002 and `balanced` 0.0004, which take less where a surface is too smooth to hide that; `strong` 0.0008.
 */
export type Strength = "subtle" | "balanced" | "strong" | number;

/** What the work is at. */
export type Stage = "read" | "embed" | "write" | "measure" | "test" | "forecast";

/** Called as work goes on; `fraction` (0 to 1) is of the stage, not of the whole. If it throws, the work ends with code `aborted`. */
export type OnProgress = (stage: Stage, fraction: number) => void;

/** Of every call that reads a model. An option that is `undefined` is left out; one that a call does not know is refused. */
export interface InspectOptions {
  /** What a `.gltf` names by URI and needs for its geometry. Default: none, which does for a `.glb`. */
  files?: Files | undefined;
}

export interface MeasureOptions extends InspectOptions {
  /** Default: nobody is told. */
  onProgress?: OnProgress | undefined;
}

/** Of a suspect that is no glTF. */
export interface MeasureMeshOptions {
  /** Default: nobody is told. */
  onProgress?: OnProgress | undefined;
}

export interface EmbedOptions extends MeasureOptions {
  /** Default: `balanced`. */
  strength?: Strength | undefined;
  /** Default: every carrier. One that the model is too small or too regular for is left out, if another can be used. */
  carriers?: Carrier[] | undefined;
  /** How far a vertex may go at most, in scene units; positive. Default: as the strength allows. */
  maxMovement?: number | undefined;
}

/**
 * `found`: the payload was read and the chance of that without the key is at most 1e-9.
 * `present`: a mark of this key is there, and the chance of that without the key is at most 1e-9. It holds no payload, or none that can
 * be read.
 * `partial`: something of this key is there, but not enough to name it found; `reason` says what is missing.
 * `none`: no evidence of this key. This does not prove that the model is not yours.
 * `cannot-check`: the model has too little geometry to answer; `reason` says what is missing.
 */
export type Verdict = "found" | "present" | "partial" | "none" | "cannot-check";

/** What one carrier says. */
export interface CarrierReading {
  name: Carrier;
  /** Natural logarithm of the upper bound of the false-positive probability, every choice charged; at most 0. */
  lnP: number;
  /** The payload as a tag and as a number; `null` where this carrier alone does not find one. */
  tag: string | null;
  number: number | null;
  /**
   * Which piece of the model it was read in, alone: 1 is the first. Objects come before their parts, and what has more triangles before what
   * has fewer. `null` where it was the whole, and where nothing was found.
   */
  piece: number | null;
  /** Agreement of the symbols with that payload, weighted: 1 is perfect, 0 is chance. */
  agreement: number;
  /** Places for symbols that were there to be read, and how many of them are this key's. */
  addresses: number;
  ownedAddresses: number;
}

/** What was read: a model, measured here; or evidence, which says what whoever wrote it likes. */
export type Input = "model" | "evidence";

export interface ReadOptions {
  /**
   * Whether `Details` are told where nothing is found too. Default: false. They follow the key: whoever sees some thousands of them, of
   * suspects of their own making, can make one that is found. For the key's owner.
   */
  details?: boolean | undefined;
}

export interface DetectOptions extends MeasureOptions, ReadOptions {
  /**
   * A payload to test for, which makes the test stronger. It must not come from the suspect; payloads that are tried in turn add up,
   * as keys do. Default: none; the payload is read.
   */
  expected?: Payload | undefined;
}

/** As `DetectOptions`, of a suspect that is no glTF. */
export interface DetectMeshOptions extends MeasureMeshOptions, ReadOptions {
  expected?: Payload | undefined;
}

/** What follows the key in a reading. */
export interface Details {
  /** Natural logarithm of the bound of the false-positive probability, every choice charged; at most 0. */
  lnP: number;
  /** Agreement of the carrier that speaks loudest. */
  agreement: number;
  carriers: CarrierReading[];
}

/** A blind reading; `Details` are there where the verdict is `found` or `present`, and where they were asked for. */
export interface Extraction extends Partial<Details> {
  verdict: Verdict;
  input: Input;
  /** The verdict in one sentence for a person. */
  sentence: string;
  /** Why it is not `found`; `null` where it is. */
  reason: string | null;
  /** What a mark that is there does not prove, where it proves less than others: one that is in RING alone can be another model's. */
  caution: string | null;
  /**
   * Which piece of the suspect it was found in, alone: what its node is called, and how many of the model's connected parts it has. `null`
   * where it was the whole, where nothing was found, and where evidence was read.
   */
  foundIn: { name: string | null; parts: number; ofParts: number } | null;
  /** The payload, where it is found. */
  tag: string | null;
  number: number | null;
}

/** A reading with its details. */
export type DetailedExtraction = Extraction & Details;

/** A test of one expected payload; `tag` and `number` are the expected ones where it is found. */
export type Verification = Extraction;

/** What is likely to leave the mark readable: tried on the marked model itself. */
export interface Forecast {
  /** "none", "web", "noise", "quantize", "smooth", "simplify-30", "simplify-50", "simplify-70" or "crop". */
  attack: string;
  /** green: found with a wide margin; amber: found, but another program may take it; red: not found. */
  level: "green" | "amber" | "red";
  /** Natural logarithm of the bound that the mark reached there. */
  lnP: number;
}

/** What an embedding did, and what was read back from its own output. */
export interface EmbedReport {
  /**
   * `null` for the one number, 2^48 - 1, that has no tag. Both are `null` for a mark without a payload, which a model gets that is too
   * small to hold one: it says whose the model is, and no more.
   */
  tag: string | null;
  number: number | null;
  /** Welded vertices in the scene, and how many of them moved. */
  vertices: number;
  movedVertices: number;
  /** The host's bounding-box diagonal in scene units. */
  diagonal: number;
  /** Displacement over all vertices, as fractions of that diagonal. */
  rmsRel: number;
  maxRel: number;
  /** The largest one in scene units: metres, where the file keeps to glTF's. */
  maxMovement: number;
  /**
   * The farthest that a vertex went from where the mean movement of its part, what hangs together by edges, would have taken it, as a
   * fraction of the part's own diagonal; at most 0.01, at the strong strength 0.02. And the largest angle in degrees by which a triangle
   * turned that is no sliver; at most 10, at the strong strength 20.
   */
  worstPartRel: number;
  worstTurnDegrees: number;
  /** Whether rounding positions as web pipelines do takes the mark: the forecast "web" is red. */
  isFragile: boolean;
  /** Pairs of triangles of one part that cut each other now, and neither did nor touched before: none. */
  newIntersections: number;
  /**
   * What its owner should know, in sentences: that the mark is fragile, that it holds no payload, that it may be seen; and what
   * is strewn far from the model, and what the copy lacks of its host (its compression).
   */
  warnings: string[];
  strength: number;
  /** Meshes that no scene shows, by their place in the file's list: levels of detail, and what is left over; and whether they were marked, each alone. */
  unshown: { mesh: number; isMarked: boolean }[];
  /** The output as `extract` reads it. */
  readBack: DetailedExtraction;
  forecast: Forecast[];
  /** SHA-256 in hexadecimal of the main file before and after. */
  hostSha256: string;
  markedSha256: string;
}

export interface Embedding {
  /** The marked main file: `.glb` for a `.glb`, `.gltf` for a `.gltf`. */
  model: Uint8Array;
  /** The external buffers that changed, under the names they were handed in with. */
  files: Files;
  report: EmbedReport;
}

/** A model without compression. */
export interface Decompressed {
  /** The main file: what was given, if nothing in it is compressed. */
  model: Uint8Array;
  /** The external buffers that differ from those that were given. */
  files: Files;
}

/** What a model is made of. */
export interface Inspection {
  container: "glb" | "gltf";
  /** Bytes of the main file. */
  bytes: number;
  /** Of the scene, instances counted each, welded. */
  vertices: number;
  triangles: number;
  components: number;
  boundaryEdges: number;
  nonManifoldEdges: number;
  /** Bounding-box diagonal in scene units. */
  diagonal: number;
  meshes: number;
  primitives: number;
  nodes: number;
  extensionsUsed: string[];
  /** What is strewn far from the model, in sentences: it is left out of all that is said here, and would not be marked. */
  warnings: string[];
  sha256: string;
}

/** What a model can hold. */
export interface Capacity {
  /** What a mark in it can say: whose it is and a payload, whose it is, or nothing. */
  holds: "payload" | "presence" | "nothing";
  /** The preset that it takes: `strong` where that holds more than `balanced`; `null` where it holds nothing. */
  strength: "balanced" | "strong" | null;
  /** Why it holds no more, in words; `null` where it holds a payload. */
  reason: string | null;
}

/** What is thrown: a stable `code` such as `document.truncated`, words for people, and for documents a JSON pointer. */
export interface MeshmarkErrorObject {
  code: string;
  message: string;
  path: string | null;
}

/** What `prepare` gives. */
export interface Prepared {
  /** The plan as bytes: the host, the key and what was chosen for it. It is as secret as the key. */
  plan: Uint8Array;
  /** Of the specimen, the copy with the number 0: what the mark of every copy is likely to survive. */
  report: EmbedReport;
}

/** What a stamp did, and what was read back. */
export interface StampReport {
  number: number;
  /** What `detect` reads of the copy as its `number`: the copy's own number, permuted by the key. */
  payload: number;
  movedVertices: number;
  /** Triangles of the scene. Where a ledger keeps them, a statement of a tracing can say how many a copy that leaked has left. */
  triangles: number;
  /** Displacement over all vertices, as fractions of the diagonal. */
  rmsRel: number;
  maxRel: number;
  /** Pairs of triangles of one part that cut each other now, and neither did nor touched before: none. */
  newIntersections: number;
  /** Natural logarithm of the bound, read from the copy. */
  lnP: number;
  /** Whether that is less than three quarters of what the specimen reached. */
  isWeaker: boolean;
  markedSha256: string;
}

export interface Stamped {
  model: Uint8Array;
  /** The external buffers that changed. */
  files: Files;
  report: StampReport;
}

/** A file that a statement is about. */
export interface StatedFile {
  /** What it is to the reader: "Suspect", "Original". */
  role: string;
  name: string;
  bytes: number;
  sha256: string;
}

/** What a statement says beside what was found; every word is shown as text. */
export interface StatementOptions {
  /** Whose key it is, as they call themselves. Default: not said. */
  owner?: string | undefined;
  /** When it was looked at, in your words. Default: not said. */
  date?: string | undefined;
  /** What was looked at, the suspect first. Default: none. */
  files?: StatedFile[] | undefined;
  /** Command lines that repeat it. Default: none. */
  commands?: string[] | undefined;
  /** Of a tracing: what the ledger calls numbers. Default: they have no names. */
  names?: Record<string, string> | undefined;
  /** Of a tracing: how many triangles the model had that was sold, by the ledger. Default: not said. */
  triangles?: number | undefined;
}

export interface TraceEvidenceOptions {
  /** Default: no statement. */
  statement?: StatementOptions | undefined;
}

/** Of a suspect that is no glTF. */
export interface TraceMeshOptions extends MeasureMeshOptions {
  /**
   * The model that was sold, as it was before it was marked: buyers are named so who are named by the suspect alone no more. It proves something to others
   * only if it is older than the sale. Default: none.
   */
  original?: Uint8Array | undefined;
  /** What an original that is a `.gltf` names by URI. Default: none. */
  originalFiles?: Files | undefined;
  /** The record of an embedding of that model under the same key, in the stead of the original. Default: none. */
  record?: string | undefined;
  /** Whether the suspect is laid on the original or the record, to be looked at. Default: false. Its `evidence` follows the key: for the key's owner. */
  overlay?: boolean | undefined;
  /** Default: no statement. */
  statement?: StatementOptions | undefined;
}

export interface TraceOptions extends TraceMeshOptions {
  /** What a suspect that is a `.gltf` names by URI. Default: none. */
  files?: Files | undefined;
}

export interface StateReadingOptions extends MeasureOptions {
  statement: StatementOptions;
}

/** Whose copies a suspect was made of. */
export interface Tracing {
  /**
   * `named`: for any buyer who had no part in it the chance to be among `buyers` is at most 1e-9. `nobody`: a mark of this key is there, and
   * no copy of the ledger can be told from it. `no-mark`: no evidence of this key. `cannot-check`: the model has too little geometry.
   */
  traced: "named" | "nobody" | "no-mark" | "cannot-check";
  sentence: string;
  /** The most certain first; `lnP` has every buyer and way of reading charged. */
  buyers: { number: number; lnP: number }[];
  numBuyers: number;
  numWays: number;
  lnCharge: number;
  /** Triangles of the suspect; `null` for evidence. */
  triangles: number | null;
  /** What is read with the key alone. */
  reading: Extraction;
  /** What is read with the original or the record; `null` without. */
  comparison: Comparison | null;
  /** One HTML file without scripts, where it was asked for. */
  statement?: string;
  /** Where it was asked for; `null` where the suspect lies nowhere on the original, or there is none. */
  overlay?: Overlay | null;
}

/** Of every comparison. */
export interface ComparingOptions {
  /**
   * The payload that has to be there: it alone is charged, and not all payloads, so less has to be left of the mark. Where the copy has another
   * one of the key, the verdict is `partial` and `number` names it. It must not come from the suspect. Default: whatever is there is read.
   */
  expected?: Payload | undefined;
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
  /** The payload as a tag and as a number, where it is found; where another one was expected than is there, that other one. */
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
  /** In how many parts the suspect lies there, each moved by itself: 1 where it lies as a whole, 0 where it lies nowhere. */
  numParts: number;
  /** Whether it, or a part of it, had to be bent to lie there: it is in another pose. */
  isBent: boolean;
  /** What takes the suspect, or the largest of its parts, onto the original, or some of it where it was bent: three columns of a linear map, and a shift, in the original's scene units. */
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

/** 32 bytes from an owner's name and passphrase: Argon2id, see docs/FORMAT.md. Takes tenths of a second by design. */
export function deriveKey(owner: string, passphrase: string): Uint8Array;

/**
 * The key of one work of an owner, 32 bytes, from the owner's key and the work's title. Works with keys of their own have nothing in common that
 * somebody who has several of them could compare. A title is no secret, but is needed to find the mark again.
 */
export function workKey(key: Uint8Array, title: string): Uint8Array;

/** Marks a model. `key` is 32 bytes: from `deriveKey` or `workKey`, or a key file's. */
export function embed(model: Uint8Array, payload: Payload, key: Uint8Array, options?: EmbedOptions): Embedding;

/** Measures a suspect without any key. The result, versioned bytes, can be kept and tested against many keys. */
export function measure(model: Uint8Array, options?: MeasureOptions): Uint8Array;

/** Reads a payload from evidence, knowing only the key. */
export function extract(evidence: Uint8Array, key: Uint8Array, options?: ReadOptions): Extraction;

/**
 * Reads evidence with every key of a list, as `extract` does with one, and in their order. That there are many is charged in all that is
 * said: the probability that the mark of any of them is wrongly found is at most 1e-9.
 */
export function extractMany(evidence: Uint8Array, keys: Uint8Array[], options?: ReadOptions): Extraction[];

/**
 * Tests evidence for one expected payload: stronger than `extract`, for it has no payload to guess. The payload must not come from
 * the suspect; payloads that are tried in turn add up, as keys do.
 */
export function verify(evidence: Uint8Array, key: Uint8Array, expected: Payload, options?: ReadOptions): Verification;

/**
 * Reads a suspect in one go, ending as soon as it is sure: faster than measure and extract. Stage "test"
 * reports the fraction of hypotheses tried.
 */
export function detect(model: Uint8Array, key: Uint8Array, options?: DetectOptions): Extraction;

/**
 * As `measure`, of a suspect in any other format: x, y and z of each vertex, and the three vertices of each triangle by their index.
 * Units and axes do not matter, nor whether triangles share their vertices; it must not be mirrored.
 */
export function measureMesh(positions: Float64Array, triangles: Uint32Array, options?: MeasureMeshOptions): Uint8Array;

/** As `detect`, of a suspect in any other format: see `measureMesh`. */
export function detectMesh(positions: Float64Array, triangles: Uint32Array, key: Uint8Array, options?: DetectMeshOptions): Extraction;

/** A model whose geometry is not compressed, for viewers that know no codecs. */
export function decompress(model: Uint8Array, options?: InspectOptions): Decompressed;

/** Describes a model, without a key. */
export function inspect(model: Uint8Array, options?: InspectOptions): Inspection;

/**
 * Tries what a model can hold, with a key that is nobody's: at the balanced strength, then at the strong one. Another key may fare a little
 * better or worse. Takes as long as `embed` without its forecast, and twice as long where balanced is not enough.
 */
export function capacity(model: Uint8Array, options?: MeasureOptions): Capacity;

/** A generated model to try things on: a .glb with normals and one material. */
export function demoModel(): Uint8Array;

/** The version of this module. */
export function version(): string;
