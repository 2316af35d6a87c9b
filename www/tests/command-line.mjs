// The command line's reports have the names and types that are declared for JavaScript: `MESHMARK_CLI` names the program.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { demoModel, init } from "meshmark";
import { readContract } from "./shape.mjs";

const declared = (name) => readContract(fileURLToPath(new URL(`../../src/wasm/${name}.d.ts`, import.meta.url)));
const marks = declared("types");
const attacks = declared("attacks");
const study = declared("study");
const folder = mkdtempSync(join(tmpdir(), "meshmark-command-line-"));
const OWNER = ["--key-file", join(folder, "key")];

before(async () => {
  await init();
  writeFileSync(join(folder, "model.glb"), demoModel());
  writeFileSync(join(folder, "key"), new Uint8Array(32).fill(1));
  report("embed", "model.glb", "marked.glb", ...OWNER, "--tag", "ADA-1");
});

after(() => rmSync(folder, { recursive: true }));

/** What a command prints, but for what it alone tells: the times, and the files that it wrote. */
function report(...args) {
  const { stdout, stderr, error } = spawnSync(process.env.MESHMARK_CLI, args, { encoding: "utf8", cwd: folder });
  assert.equal(error, undefined);
  assert.notEqual(stdout, "", stderr);
  const report = JSON.parse(stdout);
  delete report.ms;
  delete report.stored;
  return report;
}

test("embed reports what is declared", () => {
  assert.deepEqual(marks.differences("EmbedReport", report("embed", "model.glb", "again.glb", ...OWNER, "--tag", "ADA-1")), []);
});

test("readings are what is declared, found or not, with details or without", () => {
  const of = (...args) => report(...args.slice(0, 2), ...OWNER, ...args.slice(2));
  assert.deepEqual(marks.differences("DetailedExtraction", of("extract", "marked.glb")), []);
  assert.deepEqual(marks.differences("Extraction", of("extract", "model.glb")), []);
  assert.deepEqual(marks.differences("DetailedExtraction", of("extract", "model.glb", "--details")), []);
  assert.deepEqual(marks.differences("Verification", of("verify", "marked.glb", "--tag", "ADA-1")), []);
});

test("inspect reports what is declared", () => {
  assert.deepEqual(marks.differences("Inspection", report("inspect", "model.glb")), []);
  assert.deepEqual(marks.differences("Capacity", report("capacity", "model.glb")), []);
});

test("attacks and their cost are what is declared", () => {
  for (const attack of report("attacks")) {
    assert.deepEqual(attacks.differences("Attack", attack), []);
  }
  const { steps, seed, ...quality } = report("attack", "model.glb", "copy.glb", "--step", "noise 0.1");
  assert.deepEqual([steps, seed], [["noise 0.1 %"], 1]);
  assert.deepEqual(attacks.differences("Quality", quality), []);
});

test("the study's rows are what is declared", () => {
  const { table1, figure5, vertices, triangles } = report("study", "model.glb", "--keys", "1");
  assert.ok(table1.length > 0 && vertices > 0 && triangles > 0);
  for (const row of table1) {
    assert.deepEqual(study.differences("HostsRow", row), []);
  }
  for (const errors of Object.values(figure5).flat()) {
    assert.deepEqual(study.differences("Errors", errors), []);
  }
});

test("an error has the declared shape", () => {
  const { verdict, error } = report("inspect", "key");
  assert.equal(verdict, "cannot-check");
  assert.deepEqual(marks.differences("MeshmarkErrorObject", error), []);
});
