/**
 * Invisible, keyed, robust watermarks in the geometry of glTF models: the synchronous API, bytes in and bytes out.
 *
 * Call `init()` once before anything else. The functions block while they work: on a page, use `meshmark/client`.
 */
import * as wasm from "../wasm/meshmark.js";
import { asMeshmarkError, MeshmarkError } from "./error.js";
import { load, type InitInput, type Loadable } from "./loading.js";
import type {
  EmbedOptions,
  Prepared,
  Stamped,
  StateReadingOptions,
  TraceEvidenceOptions,
  TraceMeshOptions,
  TraceOptions,
  Tracing,
} from "../wasm/meshmark.js";

export { MeshmarkError };
export type {
  Capacity,
  Carrier,
  CarrierReading,
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
  MeasureMeshOptions,
  MeasureOptions,
  MeshmarkErrorObject,
  OnProgress,
  Payload,
  Prepared,
  ReadOptions,
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

type Module = typeof wasm & Loadable;

/** The functions of the module that answers: the first one, or the one with the codecs once that is there. */
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
  await load(wasm as Module, input);
  started = true;
}

let startingCodecs: Promise<void> | undefined;

/**
 * Loads the module that reads compressed geometry (Draco, meshopt) too, in the place of the first one. Until then such models are refused with
 * `document.compression-unsupported`. The client calls it when a model asks for it.
 *
 * @param input as for `init`
 * @throws MeshmarkError `init.failed`
 */
export function initCodecs(input?: InitInput): Promise<void> {
  startingCodecs ??= startCodecs(input).catch((cause: unknown) => {
    startingCodecs = undefined;
    const known = asMeshmarkError(cause);
    const words = `The module for compressed models could not be loaded: ${String(cause)}`;
    throw known instanceof MeshmarkError ? known : new MeshmarkError("init.failed", words, null, { cause });
  });
  return startingCodecs;
}

async function startCodecs(input: InitInput = new URL("../wasm-codecs/codecs_bg.wasm", import.meta.url)): Promise<void> {
  // @ts-ignore It has the types of the first module, and may be built after the package.
  const codecs = (await import("../wasm-codecs/codecs.js")) as Module;
  await load(codecs, input);
  current = copies ?? codecs;
  started = true;
}

/** What the module for sellers has beside all that the others have. */
interface Copies {
  prepare(model: Uint8Array, key: Uint8Array, options?: EmbedOptions): Prepared;
  stamp(plan: Uint8Array, number: number): Stamped;
  trace(model: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceOptions): Tracing;
  traceMesh(positions: Float64Array, triangles: Uint32Array, key: Uint8Array, numbers: Float64Array, options?: TraceMeshOptions): Tracing;
  traceEvidence(evidence: Uint8Array, key: Uint8Array, numbers: Float64Array, options?: TraceEvidenceOptions): Tracing;
  stateReading(model: Uint8Array, key: Uint8Array, options: StateReadingOptions): string;
  copyNumber(payload: number, key: Uint8Array): number;
}

let startingCopies: Promise<void> | undefined;
let copies: (Module & Copies) | undefined;

/**
 * Loads the module that makes copies for buyers and traces them, in the place of the others: it reads compressed geometry too. Until then
 * `prepare`, `stamp`, `trace`, `traceMesh`, `traceEvidence`, `stateReading` and `copyNumber` throw `init.missing`. The client calls it when it is needed.
 *
 * @param input as for `init`
 * @throws MeshmarkError `init.failed`
 */
export function initCopies(input?: InitInput): Promise<void> {
  startingCopies ??= startCopies(input).catch((cause: unknown) => {
    startingCopies = undefined;
    const known = asMeshmarkError(cause);
    const words = `The module for copies could not be loaded: ${String(cause)}`;
    throw known instanceof MeshmarkError ? known : new MeshmarkError("init.failed", words, null, { cause });
  });
  return startingCopies;
}

async function startCopies(input: InitInput = new URL("../wasm-copies/copies_bg.wasm", import.meta.url)): Promise<void> {
  // @ts-ignore It has the types of the first module and of `Copies`, and may be built after the package.
  const module = (await import("../wasm-copies/copies.js")) as Module & Copies;
  await load(module, input);
  current = copies = module;
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

/** The same of what sellers need. */
function guardedCopies<N extends keyof Copies>(name: N): Copies[N] {
  return checked(() => {
    if (!copies) {
      throw new MeshmarkError("init.missing", "Call initCopies() and wait for it first.");
    }
    return copies[name];
  }) as Copies[N];
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

export const prepare = guardedCopies("prepare");
export const stamp = guardedCopies("stamp");
export const trace = guardedCopies("trace");
export const traceMesh = guardedCopies("traceMesh");
export const traceEvidence = guardedCopies("traceEvidence");
export const stateReading = guardedCopies("stateReading");
export const copyNumber = guardedCopies("copyNumber");
