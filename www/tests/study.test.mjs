// The study in its module, held to src/wasm/research.d.ts.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import * as study from "../app/research-wasm/research.js";
import { readContract } from "./shape.mjs";
import { caught, glbOf, repository } from "./support.mjs";

const contract = readContract(fileURLToPath(new URL("src/wasm/research.d.ts", repository)));
const HOSTS = 100;
let mesh;

before(async () => {
  await meshmark.init();
  await study.default({ module_or_path: readFileSync(new URL("../app/research-wasm/research_bg.wasm", import.meta.url)) });
  mesh = study.prepare(meshmark.demoModel(), "optimize");
});

test("real results have exactly the declared shapes", () => {
  assert.deepEqual(contract.differences("Parameters", study.parameters()), []);
  assert.deepEqual(contract.differences("Prepared", mesh), []);
  assert.deepEqual(contract.differences("Fields", study.fields(mesh, "literal")), []);
  assert.deepEqual(contract.differences("Tracing", study.trace(mesh, { smoothing: "meshSmooth", iterations: 1, ranking: "integrated", numHosts: HOSTS })), []);
  assert.deepEqual(contract.differences("HostsRow", study.hosts(mesh, { smoothing: "loop", iterations: 1, draws: 2, numHosts: HOSTS })), []);
  assert.deepEqual(contract.differences("HostsRow", study.hosts(mesh, { smoothing: "taubin", iterations: 0, draws: undefined })), []);
  const found = ["random", "literal", "all"].flatMap((hosts) => study.errors(mesh, { hosts, smoothing: "laplacian", iterations: 1, strength: 8e-4, keys: 1 }));
  assert.deepEqual([...new Set(found.map(({ finding }) => finding))].sort(), ["cells", "original", "ranked", "traced"]);
  for (const errors of found) {
    assert.deepEqual(contract.differences("Errors", errors), []);
  }
});

test("every name of the contract is known to the module, and no other", () => {
  const namesOf = (type) => readFileSync(new URL("src/wasm/research.d.ts", repository), "utf8").match(new RegExp(`export type ${type} =([^;]*);`))[1].match(/(?<=")\w+(?=")/g);
  const tetrahedron = { positions: new Float64Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), triangles: new Uint32Array([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]) };
  namesOf("Ranking").forEach((ranking) => assert.equal(study.rank(tetrahedron, ranking).length, 4));
  namesOf("Smoothing").forEach((smoothing) => study.trace(tetrahedron, { smoothing, iterations: 1, ranking: "collapse", numHosts: 1 }));
  assert.throws(() => study.rank(tetrahedron, "other"), { code: "options.argument" });
  assert.throws(() => study.trace(tetrahedron, { smoothing: "other", iterations: 1, ranking: "collapse", numHosts: 1 }), { code: "options.argument" });
});

test("the mesh is of the paper's size, and its rankings are permutations of what was not rejected", () => {
  const { numTriangles } = study.parameters();
  assert.ok(mesh.triangles.length / 3 <= numTriangles && mesh.modelTriangles > numTriangles);
  const order = study.rank(mesh, "collapse");
  assert.equal(new Set(order).size, order.length);
  assert.ok(order.length > 0.9 * (mesh.positions.length / 3));
});

test("vertices keep their indices in every smoothing, and without one all hosts are found", () => {
  const vertices = mesh.positions.length / 3;
  const unchanged = study.trace(mesh, { smoothing: "meshSmooth", iterations: 0, ranking: "collapse", numHosts: HOSTS });
  assert.ok(unchanged.found.every(Boolean) && unchanged.found.length === HOSTS);
  assert.deepEqual(unchanged.positions, mesh.positions);
  const { positions, deviation } = study.trace(mesh, { smoothing: "meshSmooth", iterations: 1, ranking: "collapse", numHosts: HOSTS });
  assert.ok(positions.length / 3 > 5 * vertices);
  const moved = (v) => Math.hypot(...[0, 1, 2].map((k) => positions[3 * v + k] - mesh.positions[3 * v + k])) / mesh.diagonal;
  [0, 1, vertices - 1].forEach((v) => assert.ok(Math.abs(moved(v) - deviation[v]) < 1e-12));
});

test("what is no model and no mesh is refused with a code", () => {
  assert.deepEqual(contract.differences("MeshmarkErrorObject", caught(() => study.prepare(new Uint8Array(3), "optimize"))), []);
  const small = study.prepare(glbOf({ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], indices: [0, 1, 2] }), "simplify");
  for (const wrong of [
    () => study.rank({ ...small, triangles: new Uint32Array([0, 1, 3]) }, "literal"),
    () => study.rank({ ...small, triangles: new Uint32Array([0, 1]) }, "literal"),
    () => study.rank({ ...small, positions: new Float64Array(9).fill(NaN) }, "literal"),
    () => study.rank({ ...small, positions: [0, 0, 0] }, "literal"),
    () => study.rank(undefined, "literal"),
    () => study.trace(small, { smoothing: "loop", iterations: 3, ranking: "literal", numHosts: 1 }),
    () => study.trace(small, { smoothing: "loop", iterations: 1, ranking: "literal", numHosts: 1, seed: 1 }),
    () => study.trace(small, { smoothing: "loop", iterations: 1 }),
    () => study.hosts(small, { smoothing: "loop", iterations: 1, draws: "many" }),
    () => study.hosts(small, { smoothing: "loop", iterations: 1, draw: 2 }),
    () => study.hosts(small),
    () => study.errors(small, {}),
    () => study.errors(small, { hosts: "all", smoothing: "loop", iterations: 1, strength: 8e-4, keys: 1, signal: null }),
    () => study.prepare(new Uint8Array(3), "optimize", { file: {} }),
  ]) {
    assert.equal(caught(wrong).code, "options.argument", String(wrong));
  }
});
