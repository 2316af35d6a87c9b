// src/wasm/types.d.ts and full.d.ts are written by hand; these tests hold them to the modules, in both directions.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as facade from "meshmark";
import * as glue from "../meshmark/wasm/meshmark.js";
import { readContract } from "./shape.mjs";
import { caught, contractFile, fullContractFile, LOADING, OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

const contract = readContract(contractFile);
const full = readContract(fullContractFile);

let small;

before(async () => (small = await smallModel()));

test("the module exports exactly the functions that the contract declares", () => {
  const exported = Object.keys(glue).filter((name) => !LOADING.includes(name));
  assert.deepEqual(exported.sort(), [...contract.functions.keys()].sort());
});

test("each function takes the declared number of arguments", () => {
  for (const [name, parameters] of contract.functions) {
    assert.equal(glue[name].length, parameters, name);
  }
});

test("the package exports the same functions, init and its error", () => {
  assert.deepEqual(Object.keys(facade).sort(), [...contract.functions.keys(), ...full.functions.keys(), "init", "initFull", "MeshmarkError"].sort());
});

test("real results have exactly the declared shapes", () => {
  const model = small;
  const key = facade.deriveKey(OWNER, PASSPHRASE);
  const embedding = facade.embed(model, TAG, key);
  const evidence = facade.measure(embedding.model);
  const wrongKey = new Uint8Array(32).fill(7);
  assert.deepEqual(contract.differences("Embedding", embedding), []);
  assert.deepEqual(contract.differences("Extraction", facade.extract(evidence, key)), []);
  assert.deepEqual(contract.differences("Extraction", facade.extract(evidence, wrongKey)), []);
  facade.extractMany(evidence, [wrongKey, key]).forEach((reading) => assert.deepEqual(contract.differences("Extraction", reading), []));
  assert.deepEqual(contract.differences("Extraction", facade.detect(embedding.model, key)), []);
  assert.deepEqual(contract.differences("Extraction", facade.detect(model, key, { expected: TAG })), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.detect(model, key, { expected: TAG, details: true })), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.extract(evidence, wrongKey, { details: true })), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.verify(evidence, wrongKey, TAG, { details: true })), []);
  assert.deepEqual(contract.differences("Verification", facade.verify(evidence, key, TAG)), []);
  assert.deepEqual(contract.differences("Verification", facade.verify(evidence, key, 12345)), []);
  assert.deepEqual(contract.differences("Inspection", facade.inspect(model)), []);
  assert.deepEqual(contract.differences("Capacity", facade.capacity(model)), []);
  assert.ok(key instanceof Uint8Array && key.length === 32);
  assert.ok(evidence instanceof Uint8Array);
  assert.equal(typeof facade.version(), "string");
});

test("the full module exports what the first one does and what its own contract declares", async () => {
  const glue = await import("../meshmark/wasm-full/full.js");
  const exported = Object.keys(glue).filter((name) => !LOADING.includes(name));
  assert.deepEqual(exported.sort(), [...contract.functions.keys(), ...full.functions.keys()].sort());
  for (const [name, parameters] of full.functions) {
    assert.equal(glue[name].length, parameters, name);
  }
});

test("copies and tracings have the declared shapes, and their calls the declared options", async () => {
  await facade.initFull();
  const [model, key] = [small, new Uint8Array(32).fill(1)];
  const prepared = facade.prepare(model, key);
  assert.deepEqual(contract.differences("Prepared", prepared), []);
  const stamped = facade.stamp(prepared.plan, 1);
  assert.deepEqual(contract.differences("Stamped", stamped), []);
  const numbers = Float64Array.of(1, 2);
  assert.deepEqual(contract.differences("Tracing", facade.trace(stamped.model, key, numbers, { statement: {} })), []);
  assert.deepEqual(contract.differences("Tracing", facade.trace(model, key, numbers)), []);
  const calls = {
    EmbedOptions: (options) => facade.prepare(model, key, options),
    TraceOptions: (options) => facade.trace(model, key, numbers, options),
    TraceMeshOptions: (options) => facade.traceMesh(new Float64Array(9), new Uint32Array(3), key, numbers, options),
    TraceEvidenceOptions: (options) => facade.traceEvidence(facade.measure(model), key, numbers, options),
    StateReadingOptions: (options) => facade.stateReading(model, key, options),
  };
  for (const [type, call] of Object.entries(calls)) {
    const { message } = caught(() => call({ other: 1 }));
    assert.deepEqual(/^there is no option "other"; there are (.*)$/.exec(message)?.[1].split(", ").sort(), contract.properties(type).sort(), type);
  }
});

test("each call takes every option that is declared for it, and no other", () => {
  const [model, key] = [small, new Uint8Array(32).fill(1)];
  const evidence = facade.measure(model);
  const calls = {
    EmbedOptions: (options) => facade.embed(model, TAG, key, options),
    MeasureOptions: (options) => facade.measure(model, options),
    ReadOptions: (options) => facade.extract(evidence, key, options),
    DetectOptions: (options) => facade.detect(model, key, options),
    InspectOptions: (options) => facade.inspect(model, options),
    MeasureMeshOptions: (options) => facade.measureMesh(new Float64Array(9), new Uint32Array(3), options),
    DetectMeshOptions: (options) => facade.detectMesh(new Float64Array(9), new Uint32Array(3), key, options),
  };
  for (const [type, call] of Object.entries(calls)) {
    const { message } = caught(() => call({ other: 1 }));
    assert.deepEqual(/^there is no option "other"; there are (.*)$/.exec(message)?.[1].split(", ").sort(), contract.properties(type).sort(), type);
  }
  assert.throws(() => facade.verify(evidence, key, TAG, { detail: true }), { code: "options.argument" });
  for (const wrong of [{ details: 1 }, { onProgress: 1 }, { files: 1 }, "files", null]) {
    assert.throws(() => facade.detect(model, key, wrong), { code: "options.argument" }, JSON.stringify(wrong));
  }
  assert.throws(() => facade.deriveKey(OWNER, PASSPHRASE, {}), { code: "options.argument" }, "one that takes no options");
  facade.inspect(model, { files: undefined });
});

test("every error has the declared shape", () => {
  const thrown = caught(() => glue.inspect(new Uint8Array([1, 2, 3])));
  assert.deepEqual(contract.differences("MeshmarkErrorObject", thrown), []);
});

test("progress names declared stages, with fractions from 0 to 1", () => {
  const heard = [];
  const key = new Uint8Array(32).fill(1);
  const onProgress = (...report) => heard.push(report);
  const { model } = facade.embed(small, TAG, key, { onProgress });
  facade.measure(model, { onProgress });
  facade.detect(model, key, { onProgress });
  assert.ok(heard.length > 0);
  for (const [stage, fraction] of heard) {
    assert.deepEqual(contract.differences("Stage", stage), []);
    assert.ok(fraction >= 0 && fraction <= 1, `${stage} ${fraction}`);
  }
});

test("the comparison sees what is missing, undeclared and of another type", () => {
  const carrier = { name: "ring", lnP: -1, tag: null, number: null, piece: null, agreement: 0.5, addresses: 1, ownedAddresses: 1 };
  assert.deepEqual(contract.differences("CarrierReading", carrier), []);
  const { lnP: _, ...without } = carrier;
  for (const wrong of [without, { ...carrier, extra: 1 }, { ...carrier, name: "other" }, { ...carrier, tag: 3 }, { ...carrier, lnP: NaN }, new Map()]) {
    assert.equal(contract.differences("CarrierReading", wrong).length > 0, true);
  }
});
