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

/** Looks at a model once for all its copies. */
export function prepare(model: Uint8Array, key: Uint8Array, options?: EmbedOptions): Prepared;
/** A copy with a number, 0 to 2^48 - 1. The last plan is kept ready: the first stamp of another one takes as long as several. */
export function stamp(plan: Uint8Array, number: number): Stamped;
/** Says whose copies a model was made of, among the numbers of a ledger. */
export function trace(model: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceOptions): Tracing;
/** The same of a suspect that is no glTF. */
export function traceMesh(positions: Float64Array, triangles: Uint32Array, key: Uint8Array, numbers: Float64Array, options?: TraceMeshOptions): Tracing;
/** The same of evidence: it is whoever wrote it who says what was measured. */
export function traceEvidence(evidence: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceEvidenceOptions): Tracing;
/** Reads a model as `detect` does, and gives what was found as an HTML file. */
export function stateReading(model: Uint8Array, key: Uint8Array, options: StateReadingOptions): string;
/** The number of the copy that has this payload under the key. */
export function copyNumber(payload: number, key: Uint8Array): number;
