/** A wasm module in a worker of its own: started when it is first asked, and ended to cancel. */
import type { MeshmarkErrorObject } from "meshmark";
import { MeshmarkError } from "meshmark/client";

/** Every question that a module answers: its arguments, progress apart, and its answer. */
type Questions<Q> = { [M in keyof Q]: { args: unknown[]; result: unknown } };

export type Question<Q extends Questions<Q>> = { [M in keyof Q]: { method: M; args: Q[M]["args"] } }[keyof Q];
export type Answer<Q extends Questions<Q>> = Q[keyof Q]["result"];

export type Reply<A> =
  | { kind: "progress"; fraction: number }
  | { kind: "answer"; result: A; ms: number }
  | { kind: "error"; error: MeshmarkErrorObject };

export interface Call {
  /** Aborting ends the worker at once. */
  signal?: AbortSignal;
  onProgress?: (fraction: number) => void;
}

export class Asker<Q extends Questions<Q>> {
  #worker: Worker | undefined;
  #last: Promise<unknown> = Promise.resolve();

  constructor(readonly start: () => Worker) {}

  /** Asks, after all that was asked before; says also how many milliseconds the answer took. */
  ask<M extends keyof Q>(method: M, args: Q[M]["args"], call: Call = {}): Promise<{ result: Q[M]["result"]; ms: number }> {
    const answer = this.#last.then(() => this.#run({ method, args } as Question<Q>, call));
    this.#last = answer.catch(() => {});
    return answer as Promise<{ result: Q[M]["result"]; ms: number }>;
  }

  #run(question: Question<Q>, { signal, onProgress }: Call): Promise<{ result: Answer<Q>; ms: number }> {
    return new Promise((resolve, reject) => {
      const running = (this.#worker ??= this.start());
      const settle = () => signal?.removeEventListener("abort", abort);
      const fail = (code: string, message: string, path: string | null = null) => {
        settle();
        reject(new MeshmarkError(code, message, path));
      };
      const end = () => {
        running.terminate();
        this.#worker = undefined;
      };
      const abort = () => {
        end();
        fail("aborted", "The work was cancelled.");
      };
      running.onmessage = ({ data }: MessageEvent<Reply<Answer<Q>>>) => {
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
}
