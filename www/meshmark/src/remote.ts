/**
 * Functions in a worker, called from outside: both ends. One request, then any number of progress replies, then the end.
 *
 * Calls run one after another. Arguments are copied to the worker, so that the caller keeps them; results are moved back.
 */
import { asMeshmarkError, MeshmarkError } from "./error.js";

/** What a call may hold among its options beside what the function itself takes. */
export interface CallOptions {
  /** Aborting rejects the call with code `aborted`; a running one is stopped at once, by ending its worker. */
  signal?: AbortSignal | undefined;
}

/** The options of a call: those of its function, of which `onProgress` stays at this end, and `CallOptions`. */
type Options = CallOptions & { onProgress?: ((...heard: never[]) => void) | undefined };

/** What the other end needs before its first call, by name. */
export type Setup = Record<string, string | undefined>;

interface Request {
  name: string;
  args: unknown[];
  options: object | undefined;
  /** Whether progress is to be told. */
  isHeard: boolean;
  /** What the worker needs before its first call; it comes with every one. */
  setup: Setup | undefined;
}

type Reply =
  | { kind: "progress"; heard: unknown[] }
  | { kind: "result"; result: unknown }
  | { kind: "error"; error: { code: string; message: string; path: string | null } };

interface Job {
  request: Request;
  onProgress: ((...heard: unknown[]) => void) | undefined;
  resolve(result: unknown): void;
  reject(error: MeshmarkError): void;
}

/** The calling end. Its worker is started with the first call, and again after one that was ended. */
export class Remote {
  readonly #start: () => Worker;
  readonly #setup: Setup | undefined;
  readonly #waiting: Job[] = [];
  #running: Job | undefined;
  #worker: Worker | undefined;
  #disposed = false;

  /** @param setup what the other end's `ready` is given */
  constructor(start: () => Worker, setup?: Setup) {
    this.#start = start;
    this.#setup = setup;
  }

  /** Calls a function with its arguments and, where there are any, its options. Rejects with `MeshmarkError`. */
  call<Result>(name: string, args: unknown[], { signal, onProgress, ...rest }: Options = {}): Promise<Result> {
    return new Promise((resolve, reject) => {
      if (this.#disposed) {
        return reject(disposed());
      }
      if (signal?.aborted) {
        return reject(aborted());
      }
      const settle = () => signal?.removeEventListener("abort", abort);
      const job: Job = {
        request: { name, args, options: Object.keys(rest).length > 0 ? rest : undefined, isHeard: onProgress !== undefined, setup: this.#setup },
        onProgress: onProgress as Job["onProgress"],
        resolve: (result) => (settle(), resolve(result as Result)),
        reject: (error) => (settle(), reject(error)),
      };
      const abort = () => this.#abort(job);
      signal?.addEventListener("abort", abort);
      this.#waiting.push(job);
      this.#next();
    });
  }

  /** Ends the worker; calls under way, and later ones, reject with code `disposed`. */
  dispose(): void {
    this.#disposed = true;
    this.#endWorker();
    const jobs = [this.#running, ...this.#waiting.splice(0)];
    this.#running = undefined;
    jobs.forEach((job) => job?.reject(disposed()));
  }

  #next(): void {
    if (this.#running || this.#waiting.length === 0) {
      return;
    }
    const job = (this.#running = this.#waiting.shift()!);
    try {
      this.#worker ??= this.#startWorker();
      this.#worker.postMessage(job.request);
    } catch (cause) {
      this.#fail(workerFailed(String(cause), cause));
    }
  }

  #startWorker(): Worker {
    const worker = this.#start();
    worker.onmessage = ({ data }: MessageEvent<Reply>) => this.#hear(data);
    worker.onerror = (event) => this.#fail(workerFailed(event.message ?? "its script could not be loaded"));
    return worker;
  }

  #endWorker(): void {
    if (this.#worker) {
      this.#worker.onmessage = this.#worker.onerror = null;
      this.#worker.terminate();
      this.#worker = undefined;
    }
  }

  #hear(reply: Reply): void {
    const job = this.#running;
    if (!job) {
      return;
    }
    if (reply.kind === "progress") {
      try {
        job.onProgress?.(...reply.heard);
      } catch {
        this.#abort(job); // a listener that throws ends the work, as it does without a worker
      }
      return;
    }
    if (reply.kind === "error") {
      const { code, message, path } = reply.error;
      if (code === "internal") {
        this.#endWorker(); // a module that has trapped is in no state to be used again
      }
      job.reject(new MeshmarkError(code, message, path));
    } else {
      job.resolve(reply.result);
    }
    this.#running = undefined;
    this.#next();
  }

  /** The running job fails with its worker. */
  #fail(error: MeshmarkError): void {
    this.#endWorker();
    this.#running?.reject(error);
    this.#running = undefined;
    this.#next();
  }

  #abort(job: Job): void {
    const place = this.#waiting.indexOf(job);
    if (job === this.#running) {
      this.#fail(aborted());
    } else if (place >= 0) {
      this.#waiting.splice(place, 1);
      job.reject(aborted());
    }
  }
}

/**
 * The answering end: lets whoever started this worker call some functions.
 *
 * @param ready is waited for before each call; it is given the caller's `setup`
 */
export function answer(functions: Record<string, (...args: never[]) => unknown>, ready: (setup: Setup | undefined) => Promise<unknown>): void {
  const reply = (message: Reply, transfer: Transferable[] = []) => self.postMessage(message, { transfer });
  self.addEventListener("message", async ({ data }: MessageEvent<Request>) => {
    try {
      await ready(data.setup);
      const f = functions[data.name] as (...args: unknown[]) => unknown;
      const onProgress = (...heard: unknown[]) => reply({ kind: "progress", heard });
      const options = data.isHeard ? { ...data.options, onProgress } : data.options;
      const result = await f(...data.args, ...(options ? [options] : []));
      reply({ kind: "result", result }, buffersOf(result));
    } catch (thrown) {
      reply({ kind: "error", error: errorObject(asMeshmarkError(thrown)) });
    }
  });
}

/** The buffers of every typed array in a result: moved to the page, not copied. */
function buffersOf(result: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(result)) {
    return [result.buffer as ArrayBuffer];
  }
  return typeof result === "object" && result !== null ? Object.values(result).flatMap(buffersOf) : [];
}

/** An error class does not survive `postMessage`; its fields do. */
function errorObject(error: unknown): { code: string; message: string; path: string | null } {
  return error instanceof MeshmarkError
    ? { code: error.code, message: error.message, path: error.path }
    : { code: "internal", message: String(error), path: null };
}

function aborted(): MeshmarkError {
  return new MeshmarkError("aborted", "The work was cancelled.");
}

function disposed(): MeshmarkError {
  return new MeshmarkError("disposed", "The client was disposed.");
}

function workerFailed(why: string, cause?: unknown): MeshmarkError {
  return new MeshmarkError("worker.failed", `The worker could not be used: ${why}`, null, { cause });
}
