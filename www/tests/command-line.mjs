// The command line is what the modules for JavaScript are: its reports have the names and types that are declared for these, and what is compiled
// for this machine makes the same bytes as what is compiled for wasm. `MESHMARK_CLI` names the program.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import * as research from "../app/research-wasm/research.js";
import { readContract } from "./shape.mjs";
import { COMPRESSIONS, ready } from "./programs.mjs";
import { smallModel } from "./support.mjs";

const declared = (name) => readContract(fileURLToPath(new URL(`../../src/wasm/${name}.d.ts`, import.meta.url)));
const marks = declared("types");
const attacksAndStudy = declared("research");
const folder = mkdtempSync(join(tmpdir(), "meshmark-command-line-"));
const KEY = new Uint8Array(32).fill(1);
const OWNER = ["--key-file", join(folder, "key")];
let model;
let smaller; // for what takes long
let marked;

before(async () => {
  await meshmark.initFull();
  model = await smallModel();
  smaller = await smallModel("90 %");
  write("model.glb", model);
  write("smaller.glb", smaller);
  write("key", KEY);
  marked = report("embed", "model.glb", "marked.glb", ...OWNER, "--tag", "ADA-1", "--record");
});

after(() => rmSync(folder, { recursive: true }));

const write = (name, bytes) => writeFileSync(join(folder, name), bytes);
const read = (name) => new Uint8Array(readFileSync(join(folder, name)));

/** Bytes that are equal. Where they are not, no two thousand lines say so. */
function assertSame(native, wasm) {
  assert.equal(Buffer.compare(native, wasm), 0, `${native.length} bytes, ${wasm.length} bytes`);
}

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
    assert.deepEqual(attacksAndStudy.differences("Attack", attack), []);
  }
  const { steps, seed, ...quality } = report("attack", "model.glb", "copy.glb", "--step", "noise 0.1");
  assert.deepEqual([steps, seed], [["noise 0.1 %"], 1]);
  assert.deepEqual(attacksAndStudy.differences("Quality", quality), []);
});

test("the study's rows are what is declared, with the same numbers", () => {
  const { table1, figure5, vertices, triangles } = report("study", "smaller.glb", "--keys", "1");
  assert.ok(table1.length > 0 && vertices > 0 && triangles > 0);
  for (const row of table1) {
    assert.deepEqual(attacksAndStudy.differences("HostsRow", row), []);
  }
  for (const errors of Object.values(figure5).flat()) {
    assert.deepEqual(attacksAndStudy.differences("Errors", errors), []);
  }
  const mesh = research.prepare(smaller, "optimize");
  assert.deepEqual(table1, table1.map(({ smoothing, iterations }) => research.hosts(mesh, { smoothing, iterations })));
});

test("an error has the declared shape", () => {
  const { verdict, error } = report("inspect", "key");
  assert.equal(verdict, "cannot-check");
  assert.deepEqual(marks.differences("MeshmarkErrorObject", error), []);
});

test("a marked model has the same bytes, with a report and a record that are the same", () => {
  const { model: bytes, report } = meshmark.embed(model, "ADA-1", KEY);
  assertSame(read("marked.glb"), bytes);
  assert.deepEqual(marked, report);
  const record = meshmark.record(model, report, KEY);
  assert.deepEqual(JSON.parse(readFileSync(join(folder, "marked.meshmark.json"), "utf8")), JSON.parse(record));
});

test("a compressed model too", async () => {
  await ready();
  const compressed = await COMPRESSIONS["Draco, 14 bits"]({ model, files: {} });
  write("compressed.glb", compressed.model);
  report("embed", "compressed.glb", "marked-compressed.glb", ...OWNER, "--tag", "ADA-1");
  assertSame(read("marked-compressed.glb"), meshmark.embed(compressed.model, "ADA-1", KEY).model);
});

test("an attacked copy and its evidence have the same bytes, and are read alike: blind, with the original and with the record", () => {
  const steps = ["crop 30 %", "simplify 50 %", "noise 0.05 %"];
  report("attack", "marked.glb", "copy.glb", ...steps.flatMap((step) => ["--step", step]));
  const copy = research.attack(read("marked.glb"), steps);
  assertSame(read("copy.glb"), copy);
  report("measure", "copy.glb", "copy.evidence");
  assertSame(read("copy.evidence"), meshmark.measure(copy));
  assert.deepEqual(report("extract", "copy.glb", ...OWNER, "--details"), meshmark.detect(copy, KEY, { details: true }));
  const record = readFileSync(join(folder, "marked.meshmark.json"), "utf8");
  const withOriginal = report("extract", "copy.glb", ...OWNER, "--details", "--original", "model.glb");
  assert.deepEqual(withOriginal, meshmark.compare(copy, model, KEY, { details: true }));
  const withRecord = report("extract", "copy.glb", ...OWNER, "--details", "--record", "marked.meshmark.json");
  assert.deepEqual(withRecord, meshmark.compareWithRecord(copy, record, KEY, { details: true }));
});

test("a copy in another pose is bent back onto its original alike", () => {
  const steps = ["posed 30 degrees", "simplify 50 %"];
  report("attack", "smaller.glb", "posed.glb", ...steps.flatMap((step) => ["--step", step])); // without a mark all ways are tried
  const native = report("extract", "posed.glb", ...OWNER, "--original", "smaller.glb");
  assert.equal(native.isBent, true);
  assert.deepEqual(native, meshmark.compare(read("posed.glb"), smaller, KEY));
});

test("copies for buyers have the same bytes, and are traced alike", () => {
  write("buyers.csv", "number\n7\n8\n");
  report("copies", "model.glb", ...OWNER, "--ledger", "buyers.csv", "--out", "copies");
  const { plan } = meshmark.prepare(model, KEY);
  const { model: copy } = meshmark.stamp(plan, 7);
  assertSame(read("copies/model.7.glb"), copy);
  const traced = report("trace", "copies/model.7.glb", ...OWNER, "--ledger", "copies/ledger.csv");
  traced.buyers.forEach((buyer) => delete buyer.name);
  assert.deepEqual(traced, meshmark.trace(copy, KEY, Float64Array.of(7, 8)));
});
