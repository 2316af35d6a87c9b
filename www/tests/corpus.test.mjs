// What meshmark makes of a corpus of files, beside what three.js and glTF-Transform make of it; each difference has its reason here.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { Logger, NodeIO, Verbosity } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { init, inspect } from "meshmark";
import { looseFiles, malformedFiles, soundFiles } from "./corpus.mjs";

/** Why a file is refused that both others open and that shows something in three.js. */
const REASONS = {
  "document.bad-json": "a value has a type that glTF does not have there: loaders go on with what JavaScript makes of it, and nothing says which vertices that moves",
  "document.bad-accessor": "elements overlap, or are of a kind that no vertex is",
  "document.bad-vertex": "a triangle uses a vertex that is not there: GPUs draw what they like",
  "document.out-of-bounds": "a view reaches beyond its buffer: loaders read what there is",
  "document.truncated": "a buffer is shorter than it says: loaders read what there is",
  "scene.no-triangles": "what is shown has no triangle with three different corners",
};

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).setLogger(new Logger(Verbosity.SILENT));

/** The number of meshes that three.js shows of each file; `null` where it refuses. */
let inThree;

before(async () => {
  await init();
  const script = fileURLToPath(new URL("in-three.mjs", import.meta.url));
  const { stdout, stderr } = spawnSync(process.execPath, ["--unhandled-rejections=none", script], { encoding: "utf8", maxBuffer: 2 ** 24 });
  assert.notEqual(stdout, "", stderr);
  inThree = JSON.parse(stdout);
});

async function isReadByTransform(bytes) {
  try {
    await io.readBinary(bytes);
    return true;
  } catch {
    return false;
  }
}

/** The triangles that are seen here, or the code of the refusal. */
function ours({ bytes, files }) {
  try {
    return inspect(bytes, { files }).triangles;
  } catch ({ code }) {
    return code;
  }
}

test("every sound kind of file is read", () => {
  for (const file of soundFiles()) {
    assert.ok(ours(file) > 0, `${file.name}: ${ours(file)}`);
  }
});

test("what glTF forbids and three.js opens is read", () => {
  for (const file of looseFiles()) {
    assert.ok(inThree[file.name] > 0, file.name);
    assert.ok(ours(file) > 0, `${file.name}: ${ours(file)}`);
  }
});

test("of malformed files, each that others open is opened, or refused for a reason", async (t) => {
  const files = malformedFiles();
  assert.ok(files.length >= 500);
  const tally = {};
  for (const file of files) {
    const here = ours(file);
    assert.match(String(here), /^(\d+|(document|scene)\.[a-z-]+)$/, file.name);
    const others = [inThree[file.name] > 0 && "three.js", (await isReadByTransform(file.bytes)) && "glTF-Transform"].filter(Boolean);
    if (typeof here === "string" && others.length === 2) {
      assert.ok(here in REASONS, `${file.name}: ${here}`);
      tally[here] = (tally[here] ?? 0) + 1;
    }
    const row = `${typeof here === "number" ? "opened" : "refused"} here, opened by ${others.join(" and ") || "no other"}`;
    tally[row] = (tally[row] ?? 0) + 1;
  }
  t.diagnostic(`${files.length} files: ${JSON.stringify(tally)}`);
});
