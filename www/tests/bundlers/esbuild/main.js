import { markAndFind } from "../mark-and-find.js";

document.title = await markAndFind({ workerUrl: "meshmark-worker.js", wasmUrl: "meshmark.wasm" });
