/**
 * Reading with the original at hand, synchronously: a module of its own, which a page that only marks and checks does not load.
 *
 * Call `init()` once before anything else. On a page, use `compare` of `meshmark/client`, which loads this when it is asked for.
 */
import type * as wasm from "../wasm-informed/informed.js";
import { asMeshmarkError, MeshmarkError } from "./error.js";
import { load, type InitInput, type Loadable } from "./loading.js";

export { MeshmarkError };
export type {
  CompareMeshOptions,
  CompareOptions,
  CompareWithRecordOptions,
  ComparingOptions,
  Comparison,
  Marking,
  Overlay,
  RecordOptions,
  Sheet,
  StatedFile,
  StatementOptions,
} from "../wasm-informed/informed.js";

let module: typeof wasm | undefined;
let starting: Promise<void> | undefined;

/**
 * Loads the WebAssembly module; further calls return the first one's promise, and a failed one can be repeated.
 *
 * @param input where to get the module, as for `init` of `meshmark`
 * @throws MeshmarkError `init.failed`
 */
export function init(input?: InitInput): Promise<void> {
  starting ??= start(input).catch((cause: unknown) => {
    starting = undefined;
    const known = asMeshmarkError(cause);
    const words = `The module for comparing could not be loaded: ${String(cause)}`;
    throw known instanceof MeshmarkError ? known : new MeshmarkError("init.failed", words, null, { cause });
  });
  return starting;
}

async function start(input: InitInput = new URL("../wasm-informed/informed_bg.wasm", import.meta.url)): Promise<void> {
  const loaded = (await import("../wasm-informed/informed.js")) as typeof wasm & Loadable;
  await load(loaded, input);
  module = loaded;
}

type Name = Exclude<keyof typeof wasm, "default" | "initSync">;

/** The function of the module, with its errors made `MeshmarkError`s. More arguments than it takes would be ignored in silence. */
function guarded<N extends Name>(name: N): (typeof wasm)[N] {
  const call = (...args: unknown[]): unknown => {
    if (!module) {
      throw new MeshmarkError("init.missing", "Call init() and wait for it first.");
    }
    const f = module[name] as (...args: unknown[]) => unknown;
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

export const compare = guarded("compare");
export const compareMesh = guarded("compareMesh");
export const compareWithRecord = guarded("compareWithRecord");
export const record = guarded("record");
