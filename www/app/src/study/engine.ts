/** The study's module, in a worker of its own. */
import type * as study from "../../study-wasm/study.js";
import { Asker, type Call } from "../asker";

export interface Questions {
  parameters: { args: []; result: study.Parameters };
  prepare: { args: [model: Uint8Array, files: study.Files, preparation: study.Preparation]; result: study.Prepared };
  rank: { args: [mesh: study.StudyMesh, ranking: study.Ranking]; result: Uint32Array };
  fields: { args: [mesh: study.StudyMesh, ranking: study.Ranking]; result: study.Fields };
  trace: {
    args: [mesh: study.StudyMesh, smoothing: study.Smoothing, iterations: number, ranking: study.Ranking, numHosts: number];
    result: study.Tracing;
  };
  hosts: { args: [mesh: study.StudyMesh, smoothing: study.Smoothing, iterations: number, options: study.HostsOptions]; result: study.HostsRow };
  errors: { args: [mesh: study.StudyMesh, asked: study.ErrorsCase]; result: study.Errors[] };
}

const asker = new Asker<Questions>(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));

/** Asks, after all that was asked before; `errors` says how far it is. */
export function ask<M extends keyof Questions>(method: M, args: Questions[M]["args"], call: Call = {}): Promise<{ result: Questions[M]["result"]; ms: number }> {
  return asker.ask(method, args, call);
}
