/** The study's module in a worker of its own: started when it is first asked, and ended to cancel. */
import { MeshmarkError } from "meshmark/client";
import type * as study from "../../study-wasm/study.js";

/** Every question: its arguments, progress apart, and its answer. */
interface Questions {
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

type Method = keyof Questions;

export type Question = { [M in Method]: { method: M; args: Questions[M]["args"] } }[Method];
export type Answer = Questions[Method]["result"];

export type Reply =
  | { kind: "progress"; fraction: number }
  | { kind: "answer"; result: Answer; ms: number }
  | { kind: "error"; error: study.MeshmarkErrorObject };

export interface Call {
  /** Aborting ends the worker at once. */
  signal?: AbortSignal;
  /** Heard from `errors`. */
  onProgress?: (fraction: number) => void;
}

let worker: Worker | undefined;
let last: Promise<unknown> = Promise.resolve();

/** Asks, after all that was asked before; says also how many milliseconds the answer took. */
export function ask<M extends Method>(method: M, args: Questions[M]["args"], call: Call = {}): Promise<{ result: Questions[M]["result"]; ms: number }> {
  const answer = last.then(() => run({ method, args } as Question, call));
  last = answer.catch(() => {});
  return answer as Promise<{ result: Questions[M]["result"]; ms: number }>;
}

function run(question: Question, { signal, onProgress }: Call): Promise<{ result: Answer; ms: number }> {
  return new Promise((resolve, reject) => {
    const running = (worker ??= new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));
    const settle = () => signal?.removeEventListener("abort", abort);
    const fail = (code: string, message: string, path: string | null = null) => {
      settle();
      reject(new MeshmarkError(code, message, path));
    };
    const end = () => {
      running.terminate();
      worker = undefined;
    };
    const abort = () => {
      end();
      fail("aborted", "The work was cancelled.");
    };
    running.onmessage = ({ data }: MessageEvent<Reply>) => {
      if (data.kind === "progress") {
        onProgress?.(data.fraction);
      } else if (data.kind === "answer") {
        settle();
        resolve(data);
      } else {
        if (data.error.code === "internal") {
          end(); // a module that has trapped is in no state to be used again
        }
        fail(data.error.code, data.error.message, data.error.path);
      }
    };
    running.onerror = ({ message }) => {
      end();
      fail("worker.failed", `The worker could not be used: ${message ?? "its script could not be loaded"}`);
    };
    if (signal?.aborted) {
      fail("aborted", "The work was cancelled.");
    } else {
      signal?.addEventListener("abort", abort);
      running.postMessage(question);
    }
  });
}
