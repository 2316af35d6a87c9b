/**
 * Invisible, keyed, robust watermarks in the geometry of glTF models: the synchronous API, bytes in and bytes out.
 *
 * Call `init()` once before anything else. The functions block while they work: on a page, use `meshmark/client`.
 */
import * as wasm from "../wasm/meshmark.js";
import { asMeshmarkError, MeshmarkError } from "./error.js";
import { load, type InitInput, type Loadable } from "./loading.js";

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
  ReadOptions,
  Stage,
  Strength,
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
  current = codecs;
  started = true;
}

type Name = Exclude<keyof typeof wasm, "default" | "initSync">;

/** The function of the module that answers, with its errors made `MeshmarkError`s. More arguments than it takes would be ignored in silence. */
function guarded<N extends Name>(name: N): (typeof wasm)[N] {
  const call = (...args: unknown[]): unknown => {
    if (!started) {
      throw new MeshmarkError("init.missing", "Call init() and wait for it first.");
    }
    const f = current[name] as (...args: unknown[]) => unknown;
    if (args.length > f.length) {
      throw new MeshmarkError("options.argument", `There are ${args.length} arguments; it takes at most ${f.length}.`);
    }
    try {
      return f(...args);
    } catch (thrown) {
      throw asMeshmarkError(thrown);
    }
  };
  return call as (typeof wasm)[N];
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
