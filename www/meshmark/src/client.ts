/**
 * The same functions as promises, run in a worker: the page never freezes, and work can be watched and cancelled.
 *
 * Calls run one after another. Inputs are copied to the worker, so that the caller keeps them; results are moved back.
 */
import { MeshmarkError } from "./error.js";
import type {
  Capacity,
  CompareMeshOptions,
  CompareOptions,
  CompareWithRecordOptions,
  Comparison,
  Decompressed,
  DetectMeshOptions,
  DetectOptions,
  EmbedOptions,
  Embedding,
  Extraction,
  Inspection,
  InspectOptions,
  Marking,
  MeasureMeshOptions,
  MeasureOptions,
  Payload,
  Prepared,
  ReadOptions,
  RecordOptions,
  Stamped,
  StateReadingOptions,
  TraceEvidenceOptions,
  TraceMeshOptions,
  TraceOptions,
  Tracing,
  Verification,
} from "./index.js";
import { Remote, type CallOptions } from "./remote.js";

export { MeshmarkError };
export type { CallOptions };

export interface ClientOptions {
  /** Default: `worker.js` of this package, which bundlers find and copy. Must be of the page's origin. */
  workerUrl?: string | URL | undefined;
  /** Default: the module of this package. */
  wasmUrl?: string | URL | undefined;
  /** Default: the full module of this package. It is fetched when something needs it: a compressed model, an original, a record, copies, a tracing. */
  fullUrl?: string | URL | undefined;
}

/** Of `copies`. */
export interface CopiesOptions extends EmbedOptions, CallOptions {
  /** Workers that stamp at the same time, 1 to 16. Default: 2. Each holds the model. */
  workers?: number | undefined;
}

/** The functions of `meshmark` with the same arguments; a `signal` among their options ends a call. They reject with `MeshmarkError`. */
export interface Client {
  deriveKey(owner: string, passphrase: string, options?: CallOptions): Promise<Uint8Array>;
  workKey(key: Uint8Array, title: string, options?: CallOptions): Promise<Uint8Array>;
  embed(model: Uint8Array, payload: Payload, key: Uint8Array, options?: EmbedOptions & CallOptions): Promise<Embedding>;
  measure(model: Uint8Array, options?: MeasureOptions & CallOptions): Promise<Uint8Array>;
  measureMesh(positions: Float64Array, triangles: Uint32Array, options?: MeasureMeshOptions & CallOptions): Promise<Uint8Array>;
  extract(evidence: Uint8Array, key: Uint8Array, options?: ReadOptions & CallOptions): Promise<Extraction>;
  extractMany(evidence: Uint8Array, keys: Uint8Array[], options?: ReadOptions & CallOptions): Promise<Extraction[]>;
  verify(evidence: Uint8Array, key: Uint8Array, expected: Payload, options?: ReadOptions & CallOptions): Promise<Verification>;
  detect(model: Uint8Array, key: Uint8Array, options?: DetectOptions & CallOptions): Promise<Extraction>;
  detectMesh(positions: Float64Array, triangles: Uint32Array, key: Uint8Array, options?: DetectMeshOptions & CallOptions): Promise<Extraction>;
  decompress(model: Uint8Array, options?: InspectOptions & CallOptions): Promise<Decompressed>;
  inspect(model: Uint8Array, options?: InspectOptions & CallOptions): Promise<Inspection>;
  capacity(model: Uint8Array, options?: MeasureOptions & CallOptions): Promise<Capacity>;
  compare(suspect: Uint8Array, original: Uint8Array, key: Uint8Array, options?: CompareOptions & CallOptions): Promise<Comparison>;
  compareMesh(
    positions: Float64Array,
    triangles: Uint32Array,
    original: Uint8Array,
    key: Uint8Array,
    options?: CompareMeshOptions & CallOptions,
  ): Promise<Comparison>;
  compareWithRecord(suspect: Uint8Array, record: string, key: Uint8Array, options?: CompareWithRecordOptions & CallOptions): Promise<Comparison>;
  record(original: Uint8Array, report: Marking, key: Uint8Array, options?: RecordOptions & CallOptions): Promise<string>;
  demoModel(options?: CallOptions): Promise<Uint8Array>;
  version(options?: CallOptions): Promise<string>;
  prepare(model: Uint8Array, key: Uint8Array, options?: EmbedOptions & CallOptions): Promise<Prepared>;
  stamp(plan: Uint8Array, number: number, options?: CallOptions): Promise<Stamped>;
  /** A copy for each number, in their order, made by several workers. To end early, leave the loop. */
  copies(model: Uint8Array, numbers: Iterable<number>, key: Uint8Array, options?: CopiesOptions): AsyncGenerator<Stamped, void, void>;
  trace(model: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceOptions & CallOptions): Promise<Tracing>;
  traceMesh(
    positions: Float64Array,
    triangles: Uint32Array,
    key: Uint8Array,
    numbers: Float64Array,
    options?: TraceMeshOptions & CallOptions,
  ): Promise<Tracing>;
  traceEvidence(evidence: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceEvidenceOptions & CallOptions): Promise<Tracing>;
  stateReading(model: Uint8Array, key: Uint8Array, options: StateReadingOptions & CallOptions): Promise<string>;
  copyNumber(payload: number, key: Uint8Array, options?: CallOptions): Promise<number>;
  /** Ends the worker; calls under way, and later ones, reject with code `disposed`. */
  dispose(): void;
}

/**
 * A client whose worker is up and has its module loaded.
 *
 * @throws MeshmarkError `worker.failed` where no worker can be started (Node has none), `init.failed` where the module
 * cannot be loaded
 */
export async function createClient({ workerUrl, wasmUrl, fullUrl }: ClientOptions = {}): Promise<Client> {
  const setup = { wasmUrl: absolute(wasmUrl), fullUrl: absolute(fullUrl) };
  const start = () => new Remote(() => startWorker(workerUrl), setup);
  const remote = start();
  const client: Client = {
    deriveKey: (owner, passphrase, options) => remote.call("deriveKey", [owner, passphrase], options),
    workKey: (key, title, options) => remote.call("workKey", [key, title], options),
    embed: (model, payload, key, options) => remote.call("embed", [model, payload, key], options),
    measure: (model, options) => remote.call("measure", [model], options),
    measureMesh: (positions, triangles, options) => remote.call("measureMesh", [positions, triangles], options),
    extract: (evidence, key, options) => remote.call("extract", [evidence, key], options),
    extractMany: (evidence, keys, options) => remote.call("extractMany", [evidence, keys], options),
    verify: (evidence, key, expected, options) => remote.call("verify", [evidence, key, expected], options),
    detect: (model, key, options) => remote.call("detect", [model, key], options),
    detectMesh: (positions, triangles, key, options) => remote.call("detectMesh", [positions, triangles, key], options),
    decompress: (model, options) => remote.call("decompress", [model], options),
    inspect: (model, options) => remote.call("inspect", [model], options),
    capacity: (model, options) => remote.call("capacity", [model], options),
    compare: (suspect, original, key, options) => remote.call("compare", [suspect, original, key], options),
    compareMesh: (positions, triangles, original, key, options) => remote.call("compareMesh", [positions, triangles, original, key], options),
    compareWithRecord: (suspect, text, key, options) => remote.call("compareWithRecord", [suspect, text, key], options),
    record: (original, report, key, options) => remote.call("record", [original, report, key], options),
    demoModel: (options) => remote.call("demoModel", [], options),
    version: (options) => remote.call("version", [], options),
    prepare: (model, key, options) => remote.call("prepare", [model, key], options),
    stamp: (plan, number, options) => remote.call("stamp", [plan, number], options),
    copies: (model, numbers, key, options) => copies(remote, start, model, numbers, key, options),
    trace: (model, key, numbers, options) => remote.call("trace", [model, key, numbers], options),
    traceMesh: (positions, triangles, key, numbers, options) => remote.call("traceMesh", [positions, triangles, key, numbers], options),
    traceEvidence: (evidence, key, numbers, options) => remote.call("traceEvidence", [evidence, key, numbers], options),
    stateReading: (model, key, options) => remote.call("stateReading", [model, key], options),
    copyNumber: (payload, key, options) => remote.call("copyNumber", [payload, key], options),
    dispose: () => remote.dispose(),
  };
  try {
    await client.version();
  } catch (error) {
    client.dispose();
    throw error;
  }
  return client;
}

/** The client's own worker prepares; others stamp beside it, and end with the last copy. */
async function* copies(
  remote: Remote,
  start: () => Remote,
  model: Uint8Array,
  numbers: Iterable<number>,
  key: Uint8Array,
  { workers = 2, signal, ...options }: CopiesOptions = {},
): AsyncGenerator<Stamped, void, void> {
  const { plan } = await remote.call<Prepared>("prepare", [model, key], { ...options, signal });
  const others = Array.from({ length: Math.min(Math.max(Math.trunc(workers), 1), 16) - 1 }, start);
  const stampers = [remote, ...others];
  const waiting: Promise<Stamped>[] = [];
  const ask = (number: number, place: number) => {
    const copy = stampers[place % stampers.length]!.call<Stamped>("stamp", [plan, number], { signal });
    copy.catch(() => {}); // it is heard of when its turn comes
    waiting.push(copy);
  };
  try {
    let place = 0;
    for (const number of numbers) {
      ask(number, place++);
      if (waiting.length > stampers.length) {
        yield await waiting.shift()!;
      }
    }
    while (waiting.length > 0) {
      yield await waiting.shift()!;
    }
  } finally {
    others.forEach((other) => other.dispose());
  }
}

/** Bundlers look for these very words, `new Worker(new URL(…))`. */
function startWorker(url: string | URL | undefined): Worker {
  return url ? new Worker(url, { type: "module" }) : new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
}

/** A worker would resolve a relative URL against its own address. */
function absolute(url: string | URL | undefined): string | undefined {
  return url === undefined ? undefined : new URL(url, globalThis.location?.href).href;
}
