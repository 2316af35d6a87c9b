// What takes long: preparing, stamping and tracing, beside the server's own thread.
import { parentPort } from "node:worker_threads";
import * as meshmark from "meshmark";

await meshmark.initFull();

parentPort.on("message", ({ id, name, args }) => {
  try {
    parentPort.postMessage({ id, result: meshmark[name](...args) });
  } catch (error) {
    parentPort.postMessage({ id, error: { code: error.code ?? "internal", message: error.message } });
  }
});
