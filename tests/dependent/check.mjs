// `node check.mjs dependent.wasm`: what the module exports and imports, and whether it works without any glue.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const module = new WebAssembly.Module(readFileSync(process.argv[2]));
const functions = WebAssembly.Module.exports(module).filter(({ kind }) => kind === "function");
assert.deepEqual(functions.map(({ name }) => name), ["marks_and_finds"]);
assert.deepEqual(WebAssembly.Module.imports(module), []);
assert.equal(new WebAssembly.Instance(module).exports.marks_and_finds(), 1);
console.log("the dependent module exports its own function alone, and marks and finds");
