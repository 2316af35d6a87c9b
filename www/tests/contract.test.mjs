// src/wasm/types.d.ts is written by hand; these tests hold it to the module, in both directions.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as facade from "meshmark";
import * as glue from "../meshmark/wasm/meshmark.js";
import { readContract } from "./shape.mjs";
import { caught, contractFile, OWNER, PASSPHRASE, TAG } from "./support.mjs";

const contract = readContract(contractFile);

before(() => facade.init());

test("the module exports exactly the functions that the contract declares", () => {
  const exported = Object.keys(glue).filter((name) => !["default", "initSync"].includes(name));
  assert.deepEqual(exported.sort(), [...contract.functions.keys()].sort());
});

test("each function takes the declared number of arguments", () => {
  for (const [name, parameters] of contract.functions) {
    assert.equal(glue[name].length, parameters, name);
  }
});

test("the package exports the same functions, init and its error", () => {
  assert.deepEqual(Object.keys(facade).sort(), [...contract.functions.keys(), "init", "MeshmarkError"].sort());
});

test("real results have exactly the declared shapes", () => {
  const model = facade.demoModel();
  const key = facade.deriveKey(OWNER, PASSPHRASE);
  const embedding = facade.embed(model, undefined, TAG, key);
  const evidence = facade.measure(embedding.model, undefined);
  const wrongKey = new Uint8Array(32).fill(7);
  assert.deepEqual(contract.differences("Embedding", embedding), []);
  assert.deepEqual(contract.differences("Extraction", facade.extract(evidence, key)), []);
  assert.deepEqual(contract.differences("Extraction", facade.extract(evidence, wrongKey)), []);
  assert.deepEqual(contract.differences("Extraction", facade.detect(embedding.model, undefined, key)), []);
  assert.deepEqual(contract.differences("Extraction", facade.detect(model, undefined, key, TAG)), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.detect(model, undefined, key, TAG, { details: true })), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.extract(evidence, wrongKey, { details: true })), []);
  assert.deepEqual(contract.differences("DetailedExtraction", facade.verify(evidence, wrongKey, TAG, { details: true })), []);
  assert.deepEqual(contract.differences("Verification", facade.verify(evidence, key, TAG)), []);
  assert.deepEqual(contract.differences("Verification", facade.verify(evidence, key, 12345)), []);
  assert.deepEqual(contract.differences("Inspection", facade.inspect(model)), []);
  assert.ok(key instanceof Uint8Array && key.length === 32);
  assert.ok(evidence instanceof Uint8Array);
  assert.equal(typeof facade.version(), "string");
});

test("every error has the declared shape", () => {
  const thrown = caught(() => glue.inspect(new Uint8Array([1, 2, 3]), undefined));
  assert.deepEqual(contract.differences("MeshmarkErrorObject", thrown), []);
});

test("progress names declared stages, with fractions from 0 to 1", () => {
  const heard = [];
  const key = new Uint8Array(32).fill(1);
  const { model } = facade.embed(facade.demoModel(), undefined, TAG, key, undefined, (...report) => heard.push(report));
  facade.measure(model, undefined, (...report) => heard.push(report));
  facade.detect(model, undefined, key, undefined, undefined, (...report) => heard.push(report));
  assert.ok(heard.length > 0);
  for (const [stage, fraction] of heard) {
    assert.deepEqual(contract.differences("Stage", stage), []);
    assert.ok(fraction >= 0 && fraction <= 1, `${stage} ${fraction}`);
  }
});

test("the comparison sees what is missing, undeclared and of another type", () => {
  const carrier = { name: "ring", lnP: -1, tag: null, number: null, agreement: 0.5, addresses: 1, ownedAddresses: 1 };
  assert.deepEqual(contract.differences("CarrierReading", carrier), []);
  const { lnP: _, ...without } = carrier;
  for (const wrong of [without, { ...carrier, extra: 1 }, { ...carrier, name: "other" }, { ...carrier, tag: 3 }, { ...carrier, lnP: NaN }, new Map()]) {
    assert.equal(contract.differences("CarrierReading", wrong).length > 0, true);
  }
});
