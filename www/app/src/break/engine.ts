/** The attacks' module, in a worker of its own. */
import type * as attacks from "../../attacks-wasm/attacks.js";
import { Asker } from "../asker";

export interface Questions {
  catalogue: { args: []; result: attacks.Attack[] };
  attack: { args: [model: Uint8Array, files: attacks.Files, steps: string[], seed: number]; result: Uint8Array };
  quality: {
    args: [reference: Uint8Array, referenceFiles: attacks.Files, model: Uint8Array, files: attacks.Files];
    result: attacks.Quality;
  };
}

export const attacker = new Asker<Questions>(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));
