/** The attacks' module, in a worker of its own. */
import type { Attack, AttackOptions, Quality, QualityOptions } from "../../research-wasm/research.js";
import { Remote, type CallOptions } from "../remote";

const remote = new Remote(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));

export function catalogue(options?: CallOptions): Promise<Attack[]> {
  return remote.call("catalogue", [], options);
}

export function attack(model: Uint8Array, steps: string[], options?: AttackOptions & CallOptions): Promise<Uint8Array> {
  return remote.call("attack", [model, steps], options);
}

export function quality(reference: Uint8Array, model: Uint8Array, options?: QualityOptions & CallOptions): Promise<Quality> {
  return remote.call("quality", [reference, model], options);
}
