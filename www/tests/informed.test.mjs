// Reading with the original and with the record: it finds what it should, and gives what the contract declares.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as meshmark from "meshmark";
import { readContract } from "./shape.mjs";
import { contractFile, smallModel } from "./support.mjs";

const contract = readContract(contractFile);
const key = new Uint8Array(32).fill(5);
let original;
let embedding;

before(async () => {
  original = await smallModel();
  embedding = meshmark.embed(original, "TEST-42", key);
});

test("before the full module is loaded, a call says so", async () => {
  assert.throws(() => meshmark.compare(original, original, key), { code: "init.missing" });
  await meshmark.initFull();
});

test("a marked copy is found with the original and with the record, and results have the declared shapes", () => {
  const heard = [];
  const comparison = meshmark.compare(embedding.model, original, key, { onProgress: (...report) => heard.push(report) });
  assert.deepEqual(contract.differences("Comparison", comparison), []);
  assert.deepEqual([comparison.verdict, comparison.shape, comparison.tag], ["found", "same", "TEST-42"]);
  assert.ok(heard.length > 0 && heard.every(([stage]) => contract.differences("Stage", stage).length === 0));
  const record = meshmark.record(original, embedding.report, key, { owner: "Ada", date: "2026-11-29" });
  assert.equal(JSON.parse(record).owner, "Ada");
  const again = meshmark.compareWithRecord(embedding.model, record, key);
  assert.deepEqual(contract.differences("Comparison", again), []);
  assert.deepEqual([again.verdict, again.tag], ["found", "TEST-42"]);
  assert.throws(() => meshmark.compareWithRecord(embedding.model, record, new Uint8Array(32).fill(6)), { code: "record.other-key" });
  assert.throws(() => meshmark.compareWithRecord(embedding.model, "{}", key), { code: "record.not-a-record" });
});

test("an expected payload alone is charged, and one that is not there is not found", () => {
  const record = meshmark.record(original, embedding.report, key);
  const { positions, triangles } = meshmark.compare(embedding.model, original, key, { overlay: true }).overlay.suspect;
  const ways = [
    (options) => meshmark.compare(embedding.model, original, key, options),
    (options) => meshmark.compareMesh(Float64Array.from(positions), triangles, original, key, options),
    (options) => meshmark.compareWithRecord(embedding.model, record, key, options),
  ];
  for (const compare of ways) {
    const [read, right, byNumber, wrong] = [{}, { expected: "TEST-42" }, { expected: embedding.report.number }, { expected: "OTHER" }].map(compare);
    assert.deepEqual(contract.differences("Comparison", right), []);
    assert.deepEqual([right.verdict, right.tag], ["found", "TEST-42"]);
    // 2^48 payloads are not guessed; five tests are charged where an expected one is held against the suspect, and three else.
    assert.ok(Math.abs(read.lnP - right.lnP - (48 * Math.LN2 - Math.log(5 / 3))) < 1e-6, `${read.lnP}, ${right.lnP}`);
    assert.equal(byNumber.lnP, right.lnP);
    assert.deepEqual([wrong.verdict, wrong.tag], ["partial", "TEST-42"]);
    assert.match(wrong.sentence, /another payload/);
    assert.throws(() => compare({ expected: "a tag that is too long" }), { code: /^payload\./ });
  }
});

test("what is seen of a comparison, and its statement, come where they are asked for", () => {
  const statement = { owner: "Ada", date: "today", files: [{ role: "Suspect", name: "<b>.glb", bytes: 1, sha256: "00" }], commands: ["meshmark extract it"] };
  const comparison = meshmark.compare(embedding.model, original, key, { overlay: true, statement });
  assert.deepEqual(contract.differences("Comparison", comparison), []);
  const { overlay } = comparison;
  const count = overlay.original.positions.length / 3;
  assert.deepEqual([overlay.differences.length, overlay.evidence.length], [count, count]);
  assert.ok(overlay.differences.every((difference) => difference < 0.01), "it lies elsewhere");
  assert.ok(overlay.evidence.reduce((sum, value) => sum + value, 0) / count > 0.1, "it speaks for no mark");
  for (const words of ["Your mark was found.", "data:image/png;base64,", "&lt;b&gt;.glb", "meshmark extract it"]) {
    assert.ok(comparison.statement.includes(words), words);
  }
  assert.ok(!("overlay" in meshmark.compare(embedding.model, original, key)));
  assert.equal(meshmark.compare(embedding.model, original, new Uint8Array(32).fill(6), { overlay: true }).overlay.evidence, null);
});

test("a suspect that is no glTF is read, and what follows the key is told where it is asked for", () => {
  const positions = new Float64Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const triangles = new Uint32Array([0, 1, 2]);
  const comparison = meshmark.compareMesh(positions, triangles, original, key);
  assert.deepEqual(contract.differences("Comparison", comparison), []);
  assert.equal(comparison.verdict, "none");
  assert.ok(!("lnP" in comparison));
  assert.ok("lnP" in meshmark.compareMesh(positions, triangles, original, key, { details: true }));
});

test("each call takes every option that is declared for it, and no other", () => {
  const calls = {
    CompareOptions: (options) => meshmark.compare(embedding.model, original, key, options),
    CompareMeshOptions: (options) => meshmark.compareMesh(new Float64Array(9), new Uint32Array(3), original, key, options),
    CompareWithRecordOptions: (options) => meshmark.compareWithRecord(embedding.model, "{}", key, options),
    RecordOptions: (options) => meshmark.record(original, embedding.report, key, options),
  };
  for (const [type, call] of Object.entries(calls)) {
    assert.throws(() => call({ other: 1 }), (error) => {
      const declared = /^there is no option "other"; there are (.*)$/.exec(error.message)?.[1].split(", ").sort();
      assert.deepEqual(declared, contract.properties(type).sort(), type);
      return error.code === "options.argument";
    });
  }
});
