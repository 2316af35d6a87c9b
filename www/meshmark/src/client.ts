/**
 * The same functions as promises, run in a worker: the page never freezes, and work can be watched and cancelled.
 *
 * Calls run one after another. Inputs are copied to the worker, so that the caller keeps them; results are moved back.
 */
import { MeshmarkError } from "./error.js";
import type { EmbedOptions, Embedding, Extraction, Files, Inspection, OnProgress, Payload, ReadOptions, Verification } from "./index.js";
import type { Calls, Method, Reply, Request } from "./protocol.js";

export { MeshmarkError };

export interface ClientOptions {
  /** Default: `worker.js` of this package, which bundlers find and copy. Must be of the page's origin. */
  workerUrl?: string | URL;
  /** Default: the module of this package. */
  wasmUrl?: string | URL;
}

export interface CallOptions {
  /** Aborting rejects the call with code `aborted`; a running one is stopped at once, by ending its worker. */
  signal?: AbortSignal;
  /** Heard from `embed`, `measure` and `detect`. */
  onProgress?: OnProgress;
}

/** The functions of `meshmark`, each with `CallOptions` last. They reject with `MeshmarkError`. */
export interface Client {
  deriveKey(owner: string, passphrase: string, call?: CallOptions): Promise<Uint8Array>;
  embed(
    model: Uint8Array,
    files: Files | undefined,
    payload: Payload,
    key: Uint8Array,
    options?: EmbedOptions,
    call?: CallOptions,
  ): Promise<Embedding>;
  measure(model: Uint8Array, files?: Files, call?: CallOptions): Promise<Uint8Array>;
  extract(evidence: Uint8Array, key: Uint8Array, options?: ReadOptions, call?: CallOptions): Promise<Extraction>;
  verify(evidence: Uint8Array, key: Uint8Array, expected: Payload, options?: ReadOptions, call?: CallOptions): Promise<Verification>;
  detect(
    model: Uint8Array,
    files: Files | undefined,
    key: Uint8Array,
    expected?: Payload,
    options?: ReadOptions,
    call?: CallOptions,
  ): Promise<Extraction>;
  inspect(model: Uint8Array, files?: Files, call?: CallOptions): Promise<Inspection>;
  demoModel(call?: CallOptions): Promise<Uint8Array>;
  version(call?: CallOptions): Promise<string>;
  /** Ends the worker; calls under way, and later ones, reject with code `disposed`. */
  dispose(): void;
}

/**
 * A client whose worker is up and has its module loaded.
 *
 * @throws MeshmarkError `worker.failed` where no worker can be started (Node has none), `init.failed` where the module
 * cannot be loaded
 */
export async function createClient(options: ClientOptions = {}): Promise<Client> {
  const client = new WorkerClient(options);
  try {
    await client.version();
  } catch (error) {
    client.dispose();
    throw error;
  }
  return client;
}

interface Job {
  request: Request;
  onProgress: OnProgress | undefined;
  resolve(result: unknown): void;
  reject(error: MeshmarkError): void;
}

class WorkerClient implements Client {
  readonly #options: ClientOptions;
  readonly #waiting: Job[] = [];
  #running: Job | undefined;
  #worker: Worker | undefined;
  #disposed = false;

  constructor(options: ClientOptions) {
    this.#options = options;
  }

  deriveKey: Client["deriveKey"] = (owner, passphrase, call) => this.#call("deriveKey", [owner, passphrase], call);
  embed: Client["embed"] = (model, files, payload, key, options, call) =>
    this.#call("embed", [model, files, payload, key, options], call);
  measure: Client["measure"] = (model, files, call) => this.#call("measure", [model, files], call);
  extract: Client["extract"] = (evidence, key, options, call) => this.#call("extract", [evidence, key, options], call);
  verify: Client["verify"] = (evidence, key, expected, options, call) => this.#call("verify", [evidence, key, expected, options], call);
  detect: Client["detect"] = (model, files, key, expected, options, call) =>
    this.#call("detect", [model, files, key, expected, options], call);
  inspect: Client["inspect"] = (model, files, call) => this.#call("inspect", [model, files], call);
  demoModel: Client["demoModel"] = (call) => this.#call("demoModel", [], call);
  version: Client["version"] = (call) => this.#call("version", [], call);

  dispose(): void {
    this.#disposed = true;
    this.#endWorker();
    const jobs = [this.#running, ...this.#waiting.splice(0)];
    this.#running = undefined;
    for (const job of jobs) {
      job?.reject(new MeshmarkError("disposed", "The client was disposed."));
    }
  }

  #call<M extends Method>(method: M, args: Calls[M]["args"], call: CallOptions = {}): Promise<Calls[M]["result"]> {
    const { signal, onProgress } = call;
    const { promise, resolve, reject } = deferred<Calls[M]["result"]>();
    if (this.#disposed) {
      reject(new MeshmarkError("disposed", "The client was disposed."));
    } else if (signal?.aborted) {
      reject(aborted());
    } else {
      const wasmUrl = absolute(this.#options.wasmUrl);
      const job: Job = {
        request: { method, args, wasmUrl } as Request,
        onProgress,
        resolve: resolve as (result: unknown) => void,
        reject,
      };
      const abort = () => this.#abort(job);
      signal?.addEventListener("abort", abort, { once: true });
      const settled = () => signal?.removeEventListener("abort", abort);
      promise.then(settled, settled);
      this.#waiting.push(job);
      this.#next();
    }
    return promise;
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
    const { workerUrl } = this.#options;
    const worker = workerUrl
      ? new Worker(workerUrl, { type: "module" })
      : new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
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
      job.onProgress?.(reply.stage, reply.fraction);
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
    if (job === this.#running) {
      this.#fail(aborted());
    } else {
      this.#waiting.splice(this.#waiting.indexOf(job), 1);
      job.reject(aborted());
    }
  }
}

function aborted(): MeshmarkError {
  return new MeshmarkError("aborted", "The work was cancelled.");
}

function workerFailed(why: string, cause?: unknown): MeshmarkError {
  return new MeshmarkError("worker.failed", `The worker could not be used: ${why}`, null, { cause });
}

/** A worker would resolve a relative URL against its own address. */
function absolute(url: string | URL | undefined): string | undefined {
  return url === undefined ? undefined : new URL(url, globalThis.location?.href).href;
}

function deferred<T>() {
  let resolve!: (value: T) => void;
  let reject!: (error: MeshmarkError) => void;
  const promise = new Promise<T>((yes, no) => ((resolve = yes), (reject = no)));
  return { promise, resolve, reject };
}
