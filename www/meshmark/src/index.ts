/**
 * Invisible, keyed, robust watermarks in the geometry of glTF models: the synchronous API, bytes in and bytes out.
 *
 * Call `init()` once before anything else. The functions block while they work: on a page, use `meshmark/client`.
 */
import * as wasm from "../wasm/meshmark.js";
import { asMeshmarkError, MeshmarkError } from "./error.js";
import { load, type InitInput, type Loadable } from "./loading.js";
// @ts-ignore It may be built after the package.
import type * as full from "../wasm-full/full.js";

export { MeshmarkError };
export type {
  Capacity,
  Carrier,
  CarrierReading,
  CompareMeshOptions,
  CompareOptions,
  CompareWithRecordOptions,
  ComparingOptions,
  Comparison,
  Decompressed,
  DetailedExtraction,
  Details,
  DetectMeshOptions,
  DetectOptions,
  EmbedOptions,
  EmbedReport,
  Embedding,
  Extraction,
  Files,
  Forecast,
  Input,
  Inspection,
  InspectOptions,
  Marking,
  MeasureMeshOptions,
  MeasureOptions,
  MeshmarkErrorObject,
  OnProgress,
  Overlay,
  Payload,
  Prepared,
  ReadOptions,
  RecordOptions,
  Sheet,
  Stage,
  Stamped,
  StampReport,
  StatedFile,
  StatementOptions,
  StateReadingOptions,
  Strength,
  TraceEvidenceOptions,
  TraceMeshOptions,
  TraceOptions,
  Tracing,
  Verdict,
  Verification,
} from "../wasm/meshmark.js";

export type { InitInput };

/** The functions of the module that answers: the first one, or the full one once that is there. */
let current: typeof wasm = wasm;

let starting: Promise<void> | undefined;
let started = false;

/**
 * Loads the WebAssembly module; further calls return the first one's promise, and a failed one can be repeated.
 *
 * @param input where to get the module: a URL, `Request`, `Response`, its bytes or a `WebAssembly.Module`. Default: the
 * file that lies beside this one in the package, read from disk in Node, fetched elsewhere.
 * @throws MeshmarkError `init.failed`
 */
export function init(input?: InitInput): Promise<void> {
  starting ??= start(input).catch((cause: unknown) => {
    starting = undefined;
    throw new MeshmarkError("init.failed", `The WebAssembly module could not be loaded: ${String(cause)}`, null, { cause });
  });
  return starting;
}

async function start(input: InitInput = new URL("../wasm/meshmark_bg.wasm", import.meta.url)): Promise<void> {
  await load(wasm as typeof wasm & Loadable, input);
  started = true;
}

let startingFull: Promise<void> | undefined;
let loadedFull: typeof full | undefined;

/**
 * Loads the full module in the place of the first one. Until then compressed models (Draco, meshopt) are refused with
 * `document.compression-unsupported`, and the functions at the end of this file throw `init.missing`. The client calls it when it is needed.
 *
 * @param input as for `init`
 * @throws MeshmarkError `init.failed`
 */
export function initFull(input?: InitInput): Promise<void> {
  startingFull ??= startFull(input).catch((cause: unknown) => {
    startingFull = undefined;
    const known = asMeshmarkError(cause);
    const words = `The full module could not be loaded: ${String(cause)}`;
    throw known instanceof MeshmarkError ? known : new MeshmarkError("init.failed", words, null, { cause });
  });
  return startingFull;
}

async function startFull(input: InitInput = new URL("../wasm-full/full_bg.wasm", import.meta.url)): Promise<void> {
  // @ts-ignore It may be built after the package.
  const module = (await import("../wasm-full/full.js")) as typeof full & Loadable;
  await load(module, input);
  current = loadedFull = module;
  started = true;
}

type Name = Exclude<keyof typeof wasm, "default" | "initSync">;

/** The function of the module that answers, with its errors made `MeshmarkError`s. More arguments than it takes would be ignored in silence. */
function guarded<N extends Name>(name: N): (typeof wasm)[N] {
  return checked(() => {
    if (!started) {
      throw new MeshmarkError("init.missing", "Call init() and wait for it first.");
    }
    return current[name];
  }) as (typeof wasm)[N];
}

/** The same of what only the full module has. */
function guardedFull<N extends Exclude<keyof typeof full, "default" | "initSync">>(name: N): (typeof full)[N] {
  return checked(() => {
    if (!loadedFull) {
      throw new MeshmarkError("init.missing", "Call initFull() and wait for it first.");
    }
    return loadedFull[name];
  }) as (typeof full)[N];
}

function checked(find: () => unknown): (...args: unknown[]) => unknown {
  return (...args) => {
    const f = find() as (...args: unknown[]) => unknown;
    if (args.length > f.length) {
      throw new MeshmarkError("options.argument", `There are ${args.length} arguments; it takes at most ${f.length}.`);
    }
    try {
      return f(...args);
    } catch (thrown) {
      throw asMeshmarkError(thrown);
    }
  };
}

export const deriveKey = guarded("deriveKey");
export const workKey = guarded("workKey");
export const embed = guarded("embed");
export const measure = guarded("measure");
export const measureMesh = guarded("measureMesh");
export const extract = guarded("extract");
export const extractMany = guarded("extractMany");
export const verify = guarded("verify");
export const detect = guarded("detect");
export const detectMesh = guarded("detectMesh");
export const decompress = guarded("decompress");
export const inspect = guarded("inspect");
export const capacity = guarded("capacity");
export const demoModel = guarded("demoModel");
export const version = guarded("version");

export const compare = guardedFull("compare");
export const compareMesh = guardedFull("compareMesh");
export const compareWithRecord = guardedFull("compareWithRecord");
export const record = guardedFull("record");
export const prepare = guardedFull("prepare");
export const stamp = guardedFull("stamp");
export const trace = guardedFull("trace");
export const traceMesh = guardedFull("traceMesh");
export const traceEvidence = guardedFull("traceEvidence");
export const stateReading = guardedFull("stateReading");
export const copyNumber = guardedFull("copyNumber");
