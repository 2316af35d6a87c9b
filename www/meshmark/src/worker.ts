/** The worker behind `createClient`: a real file, so that it runs under a strict Content-Security-Policy. */
import * as meshmark from "./index.js";
import type { MeshmarkErrorObject, OnProgress } from "./index.js";
import type { Calls, Method, Reply, Request } from "./protocol.js";

self.addEventListener("message", async ({ data }: MessageEvent<Request>) => {
  try {
    await meshmark.init(data.wasmUrl);
    const result = run(data, (stage, fraction) => reply({ kind: "progress", stage, fraction }));
    reply({ kind: "result", result }, buffersOf(result));
  } catch (thrown) {
    reply({ kind: "error", error: errorObject(thrown) });
  }
});

function run(request: Request, onProgress: OnProgress): Calls[Method]["result"] {
  switch (request.method) {
    case "embed":
      return meshmark.embed(...request.args, onProgress);
    case "measure":
      return meshmark.measure(...request.args, onProgress);
    case "detect":
      return meshmark.detect(...request.args, onProgress);
    case "deriveKey":
      return meshmark.deriveKey(...request.args);
    case "extract":
      return meshmark.extract(...request.args);
    case "verify":
      return meshmark.verify(...request.args);
    case "inspect":
      return meshmark.inspect(...request.args);
    case "demoModel":
      return meshmark.demoModel();
    case "version":
      return meshmark.version();
  }
}

function reply(message: Reply, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

/** The buffers of every byte array in a result: moved to the page, not copied. */
function buffersOf(result: unknown): ArrayBuffer[] {
  if (result instanceof Uint8Array) {
    return [result.buffer as ArrayBuffer];
  }
  return typeof result === "object" && result !== null ? Object.values(result).flatMap(buffersOf) : [];
}

/** An error class does not survive `postMessage`; its fields do. */
function errorObject(thrown: unknown): MeshmarkErrorObject {
  return thrown instanceof meshmark.MeshmarkError
    ? { code: thrown.code, message: thrown.message, path: thrown.path }
    : { code: "internal", message: String(thrown), path: null };
}
