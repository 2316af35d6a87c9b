// What several tests need: where things are, models to mark, an owner.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import * as attacks from "../app/research-wasm/research.js";
import { validationErrors } from "./validator.mjs";

export const repository = new URL("../../", import.meta.url);
export const packageFolder = new URL("../meshmark/", import.meta.url);
export const contractFile = fileURLToPath(new URL("src/wasm/types.d.ts", repository));
export const fullContractFile = fileURLToPath(new URL("src/wasm/full.d.ts", repository));

/** What a wasm module exports beside its functions: what loads it, and what is run as soon as it is loaded. */
export const LOADING = ["default", "initSync", "start"];

export const OWNER = "Test Owner";
export const PASSPHRASE = "a passphrase for tests only";
export const TAG = "TEST-42";

/** Of tests that are much alike a commit runs one; the others, which have this as their option `skip`, are shown as skipped. */
export const RARELY = process.env.MESHMARK_ALL ? false : "it runs with cargo xtask test --all";

/** As an OBJ file. */
export const CUBE = `
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8`;

const sharedModels = new URL("../shared/models/", repository);

/** Bytes of a development model beside the repository, or `null` with a line that says it is not there. */
export function sharedModel(path, t) {
  const url = new URL(path, sharedModels);
  if (existsSync(url)) {
    return new Uint8Array(readFileSync(url));
  }
  t.skip(`../shared/models/${path} is not here`);
  return null;
}

/** The demo model with so much of its triangles taken, for what does not depend on a model's size: of 70 % both carriers still hold a mark. */
export async function smallModel(taken = "70 %") {
  await Promise.all([meshmark.init(), attacks.default({ module_or_path: readFileSync(new URL("../app/research-wasm/research_bg.wasm", import.meta.url)) })]);
  return attacks.attack(meshmark.demoModel(), [`simplify ${taken}`]);
}

/** A .glb of the vertices and triangles of an OBJ file, nothing else. */
export function glbFromObj(text) {
  const positions = [];
  const indices = [];
  for (const line of text.split("\n")) {
    const [kind, ...fields] = line.trim().split(/\s+/);
    if (kind === "v") {
      positions.push(...fields.slice(0, 3).map(Number));
    } else if (kind === "f") {
      const corners = fields.map((field) => parseInt(field, 10) - 1);
      for (let i = 2; i < corners.length; i++) {
        indices.push(corners[0], corners[i - 1], corners[i]);
      }
    }
  }
  return glbOf({ positions, indices });
}

/** A .glb of one mesh: `x y z` of each vertex and, if wanted, of its normal, and three vertices a triangle. */
export function glbOf({ positions, indices, normals = [] }) {
  const axis = (k) => positions.filter((_, i) => i % 3 === k).map(Math.fround);
  const vectors = (list) => ({ bytes: Buffer.from(new Float32Array(list).buffer), accessor: { componentType: 5126, type: "VEC3", count: list.length / 3 } });
  const parts = [vectors(positions), { bytes: Buffer.from(new Uint32Array(indices).buffer), accessor: { componentType: 5125, type: "SCALAR", count: indices.length } }];
  Object.assign(parts[0].accessor, {
    min: [0, 1, 2].map((k) => axis(k).reduce((a, b) => Math.min(a, b))),
    max: [0, 1, 2].map((k) => axis(k).reduce((a, b) => Math.max(a, b))),
  });
  const attributes = { POSITION: 0 };
  if (normals.length > 0) {
    attributes.NORMAL = parts.push(vectors(normals)) - 1;
  }
  const bin = Buffer.concat(parts.map(({ bytes }) => bytes));
  let byteOffset = 0;
  const bufferViews = parts.map(({ bytes: { byteLength } }) => ({ buffer: 0, byteOffset: (byteOffset += byteLength) - byteLength, byteLength }));
  return glb(
    {
      asset: { version: "2.0" },
      scene: 0,
      scenes: [{ nodes: [0] }],
      nodes: [{ mesh: 0 }],
      meshes: [{ primitives: [{ attributes, indices: 1 }] }],
      accessors: parts.map(({ accessor }, bufferView) => ({ bufferView, ...accessor })),
      bufferViews,
      buffers: [{ byteLength: bin.length }],
    },
    bin,
  );
}

/** The container: glTF 2.0, section 4.4. */
function glb(json, bin) {
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
  const u32 = (...values) => Buffer.from(new Uint32Array(values).buffer);
  const length = 12 + 8 + padded.length + 8 + bin.length;
  return new Uint8Array(Buffer.concat([u32(0x46546c67, 2, length, padded.length, 0x4e4f534a), padded, u32(bin.length, 0x004e4942), bin]));
}

/** The marked model has no error that its host did not have. */
export async function assertNoNewErrors(host, marked) {
  const before = await validationErrors(host);
  const after = await validationErrors(marked);
  assert.deepEqual(after.filter((error) => !before.includes(error)), []);
}

/** What a function throws; it is wrong not to. */
export function caught(f) {
  try {
    f();
  } catch (error) {
    return error;
  }
  return assert.fail("nothing was thrown");
}
