// The attacks in their module, held to src/wasm/research.d.ts.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import * as attacks from "../app/research-wasm/research.js";
import { readContract } from "./shape.mjs";
import { caught, glbOf, repository } from "./support.mjs";
import { validationErrors } from "./validator.mjs";

const contract = readContract(fileURLToPath(new URL("src/wasm/research.d.ts", repository)));
let demo;

before(async () => {
  await meshmark.init();
  await attacks.default({ module_or_path: readFileSync(new URL("../app/research-wasm/research_bg.wasm", import.meta.url)) });
  demo = meshmark.demoModel();
});

const qualityOf = (model) => attacks.quality(demo, model);

test("real results have exactly the declared shapes", () => {
  const catalogue = attacks.catalogue();
  assert.ok(catalogue.length > 10);
  for (const attack of catalogue) {
    assert.deepEqual(contract.differences("Attack", attack), []);
    assert.equal(attack.steps.length, Math.max(attack.levels.length, 1), attack.name);
  }
  const copy = attacks.attack(demo, ["noise 0.1 %"]);
  assert.ok(copy instanceof Uint8Array);
  assert.deepEqual(contract.differences("Quality", qualityOf(copy)), []);
});

test("every step of the catalogue can be done to a small model, and leaves a valid one", async () => {
  const [around, across] = [48, 24];
  const positions = [];
  const indices = [];
  for (let i = 0; i < around; i++) {
    for (let j = 0; j < across; j++) {
      const [u, v] = [(i / around) * 2 * Math.PI, (j / across) * 2 * Math.PI];
      positions.push(Math.cos(u) * (2 + Math.cos(v)), Math.sin(u) * (2 + Math.cos(v)), Math.sin(v));
      const corner = (a, b) => ((i + a) % around) * across + ((j + b) % across);
      indices.push(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1));
    }
  }
  const torus = glbOf({ positions, indices });
  for (const step of attacks.catalogue().flatMap(({ steps }) => steps)) {
    assert.deepEqual(await validationErrors(attacks.attack(torus, [step], { seed: 3 })), [], step);
  }
});

test("equal seeds give equal copies, and steps are done one upon the other", () => {
  const noisy = (seed) => attacks.attack(demo, ["noise 0.3 %"], { seed });
  assert.deepEqual(noisy(undefined), noisy(1));
  assert.deepEqual(noisy(7), noisy(7));
  assert.notDeepEqual(noisy(7), noisy(8));
  const [all, half] = [qualityOf(demo), qualityOf(attacks.attack(demo, ["simplify 50 %"]))];
  assert.ok(all.rmsRel < 1e-9 && all.hausdorffRel < 1e-9 && all.msdm < 1e-9, JSON.stringify(all));
  assert.ok(Math.abs(half.triangles / all.triangles - 0.5) < 0.01);
  const chained = qualityOf(attacks.attack(demo, ["crop 30 %", "simplify 50 %", "quantize 8 bits"]));
  assert.ok(chained.triangles < 0.8 * half.triangles && chained.rmsRel > half.rmsRel);
});

test("what moves the model as a whole, or names its vertices anew, costs nothing", () => {
  for (const step of ["similarity", "swapped axes", "reorder"]) {
    const { rmsRel, msdm } = qualityOf(attacks.attack(demo, [step], { seed: 5 }));
    assert.ok(rmsRel < 1e-6 && msdm < 0.01, `${step}: ${rmsRel} ${msdm}`);
  }
});

test("what is no model and no attack is refused with a code", () => {
  for (const [code, wrong] of [
    ["document.", () => attacks.attack(new Uint8Array(3), [])],
    ["document.", () => qualityOf(new Uint8Array(3))],
    ["options.argument", () => attacks.attack(demo, ["melt"])],
    ["options.argument", () => attacks.attack(demo, ["noise 0.2 %"])],
    ["options.argument", () => attacks.attack(demo, [7])],
    ["options.argument", () => attacks.attack(demo, "noise 0.1 %")],
    ["options.argument", () => attacks.attack(demo, ["noise 0.1 %"], { files: 3 })],
    ["options.argument", () => attacks.attack(demo, ["noise 0.1 %"], { seeds: 3 })],
    ["options.argument", () => attacks.attack(demo, ["noise 0.1 %"], { seed: 0.5 })],
    ["options.argument", () => attacks.attack(demo, ["noise 0.1 %"], { seed: "3" })],
    ["options.argument", () => attacks.quality(demo, demo, { seed: 3 })],
  ]) {
    const error = caught(wrong);
    assert.deepEqual(contract.differences("MeshmarkErrorObject", error), []);
    assert.ok(error.code.startsWith(code), `${error.code} ${wrong}`);
  }
});

test("an attack that leaves nothing says so", () => {
  const triangle = glbOf({ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], indices: [0, 1, 2] });
  const error = caught(() => attacks.attack(triangle, ["noise 0.1 %", "crop 50 %"]));
  assert.equal(error.code, "attack.nothing-left");
  assert.match(error.message, /after crop 50 % there is nothing left/);
});
