/**
 * Invisible, keyed, robust watermarks in the geometry of glTF models: the synchronous API, bytes in and bytes out.
 *
 * Call `init()` once before anything else. The functions block while they work: on a page, use `meshmark/client`.
 */
import * as wasm from "../wasm/meshmark.js";
import { asMeshmarkError, MeshmarkError } from "./error.js";

export { MeshmarkError };
export type {
  Capacity,
  Carrier,
  CarrierReading,
  DetailedExtraction,
  Details,
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

/** Where the module can come from: an address, a response, its bytes, or the compiled module. */
export type InitInput = string | URL | Request | Response | BufferSource | WebAssembly.Module;

/** What wasm-bindgen exports beside the functions that the types declare. */
const { default: load } = wasm as unknown as { default(options: { module_or_path: InitInput }): Promise<unknown> };

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
  await load({ module_or_path: isFileUrl(input) ? await readFile(input) : input });
  started = true;
}

function isFileUrl(input: InitInput): input is string | URL {
  return (typeof input === "string" || input instanceof URL) && String(input).startsWith("file:");
}

/** Node's `fetch` knows no `file:` URLs. Asked for by name at run time, so that bundlers for browsers see no import. */
async function readFile(url: string | URL): Promise<BufferSource> {
  const { process } = globalThis as unknown as {
    process: { getBuiltinModule(id: "node:fs/promises"): { readFile(url: URL): Promise<Uint8Array<ArrayBuffer>> } };
  };
  return process.getBuiltinModule("node:fs/promises").readFile(new URL(url));
}

/** The module's function, with its errors made `MeshmarkError`s. More arguments than it takes would be ignored in silence. */
function guarded<Arguments extends unknown[], Result>(f: (...args: Arguments) => Result) {
  return (...args: Arguments): Result => {
    if (!started) {
      throw new MeshmarkError("init.missing", "Call init() and wait for it first.");
    }
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

export const deriveKey: typeof wasm.deriveKey = guarded(wasm.deriveKey);
export const embed: typeof wasm.embed = guarded(wasm.embed);
export const measure: typeof wasm.measure = guarded(wasm.measure);
export const extract: typeof wasm.extract = guarded(wasm.extract);
export const extractMany: typeof wasm.extractMany = guarded(wasm.extractMany);
export const verify: typeof wasm.verify = guarded(wasm.verify);
export const detect: typeof wasm.detect = guarded(wasm.detect);
export const inspect: typeof wasm.inspect = guarded(wasm.inspect);
export const capacity: typeof wasm.capacity = guarded(wasm.capacity);
export const demoModel: typeof wasm.demoModel = guarded(wasm.demoModel);
export const version: typeof wasm.version = guarded(wasm.version);
