// src/wasm/research.d.ts is written by hand; this test holds it to the module of the study and the attacks, in both directions.
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import * as research from "../app/research-wasm/research.js";
import { readContract } from "./shape.mjs";
import { LOADING, repository } from "./support.mjs";

test("the module exports exactly the functions that the contract declares, with their numbers of arguments", () => {
  const contract = readContract(fileURLToPath(new URL("src/wasm/research.d.ts", repository)));
  const exported = Object.keys(research).filter((name) => !LOADING.includes(name));
  assert.deepEqual(exported.sort(), [...contract.functions.keys()].sort());
  for (const [name, parameters] of contract.functions) {
    assert.equal(research[name].length, parameters, name);
  }
});
