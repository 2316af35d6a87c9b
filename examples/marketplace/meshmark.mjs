// meshmark's functions as promises, in a worker thread.
import { Worker } from "node:worker_threads";

const worker = new Worker(new URL("worker.mjs", import.meta.url));
const waiting = new Map();
let last = 0;

worker.on("message", ({ id, result, error }) => {
  const { resolve, reject } = waiting.get(id);
  waiting.delete(id);
  if (error) {
    reject(Object.assign(new Error(error.message), { code: error.code }));
  } else {
    resolve(result);
  }
});

/** Calls a function of the package: `prepare`, `stamp`, `trace`, ... */
export function call(name, ...args) {
  return new Promise((resolve, reject) => {
    const id = ++last;
    waiting.set(id, { resolve, reject });
    worker.postMessage({ id, name, args });
  });
}

export const close = () => worker.terminate();
