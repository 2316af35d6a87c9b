// Copies for buyers in JavaScript: in Node, and by the client in Chromium, where the module for them is loaded when it is asked for.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import * as meshmark from "meshmark";
import { launch, serve, SLOW } from "./browser.mjs";
import { smallModel } from "./support.mjs";

const packageFolder = new URL("../meshmark/", import.meta.url);
const KEY = new Uint8Array(32).fill(9);
let small;
let server;
let browser;

before(async () => {
  small = await smallModel();
  assert.throws(() => meshmark.prepare(small, KEY), { code: "init.missing" });
  await meshmark.initFull();
  server = await serve(packageFolder, { configFile: false, appType: "mpa", build: { outDir: "." } });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
});

test("copies are stamped from a plan, read and traced", { timeout: SLOW }, () => {
  const model = small;
  const { plan, report } = meshmark.prepare(model, KEY, { strength: "balanced" });
  assert.equal(report.isFragile, false);
  const copy = meshmark.stamp(plan, 7);
  assert.equal(copy.report.number, 7);
  const found = meshmark.detect(copy.model, KEY);
  assert.equal(found.verdict, "found");
  assert.equal(found.number, copy.report.payload);
  assert.equal(meshmark.copyNumber(found.number, KEY), 7);
  // Another plan between them changes nothing.
  meshmark.prepare(model, KEY, { strength: "strong" });
  assert.deepEqual(meshmark.stamp(plan, 7).model, copy.model);

  const ledger = Float64Array.from({ length: 1000 }, (_, number) => number + 1);
  const statement = { owner: "<b>Ada</b>", names: { 7: "Grace & Co" }, files: [{ role: "Suspect", name: "a.glb", bytes: 5, sha256: "00" }] };
  const tracing = meshmark.trace(copy.model, KEY, ledger, { statement });
  assert.equal(tracing.traced, "named");
  assert.deepEqual(tracing.buyers.map(({ number }) => number), [7]);
  assert.ok(tracing.buyers[0].lnP < -20.8);
  assert.equal(tracing.numBuyers, 1000);
  assert.match(tracing.statement, /Grace &amp; Co/);
  assert.match(tracing.statement, /&lt;b&gt;Ada/);
  assert.equal(meshmark.trace(model, KEY, ledger).traced, "no-mark");
  const measured = meshmark.traceEvidence(meshmark.measure(copy.model), KEY, ledger, { statement });
  assert.deepEqual(measured.buyers.map(({ number }) => number), [7]);
  assert.equal(measured.reading.input, "evidence");
  assert.match(measured.statement, /Evidence that somebody measured/);
  assert.equal(measured.triangles, null);
  assert.equal(tracing.triangles, copy.report.triangles);
  assert.equal(tracing.comparison, null);
  assert.match(meshmark.stateReading(copy.model, KEY, { statement }), /Your mark was found\./);
});

test("a copy is traced with the original or a record, and laid on it", { timeout: SLOW }, () => {
  const original = small;
  const { plan, report } = meshmark.prepare(original, KEY);
  const record = meshmark.record(original, report, KEY);
  const { model } = meshmark.stamp(plan, 7);
  const ledger = Float64Array.of(6, 7, 8);
  const statement = { triangles: 2 * report.vertices };
  for (const beside of [{ original }, { record }]) {
    const tracing = meshmark.trace(model, KEY, ledger, { ...beside, overlay: true, statement });
    assert.deepEqual(tracing.buyers.map(({ number }) => number), [7]);
    assert.deepEqual([tracing.comparison.verdict, tracing.comparison.shape], ["found", "same"]);
    assert.equal(tracing.overlay.isRecorded, "record" in beside);
    assert.match(tracing.statement, /<img alt="Three pictures/);
    // With the original it is counted where the suspect lies on it.
    assert.equal(/that the ledger gives/.test(tracing.statement), "record" in beside);
  }
  assert.throws(() => meshmark.trace(model, KEY, ledger, { original, record }), { code: "options.argument" });
  assert.throws(() => meshmark.trace(model, KEY, ledger, { record: "{}" }), { code: "record.not-a-record" });
});

test("what is no plan or no number is refused by name", () => {
  const { plan } = meshmark.prepare(small, KEY);
  for (const number of [-1, 0.5, 2 ** 48, NaN]) {
    assert.throws(() => meshmark.stamp(plan, number), { code: "payload.range" });
  }
  assert.throws(() => meshmark.stamp(new Uint8Array(9), 1), { code: "plan.not-plan" });
  assert.throws(() => meshmark.stamp(plan.slice(0, 99), 1), { code: "plan.damaged" });
  assert.throws(() => meshmark.trace(plan, KEY, new Float64Array(1), { statment: {} }), { code: "options.argument" });
});

test("the client makes copies with several workers, in their order", { timeout: SLOW }, async () => {
  const page = await browser.newPage();
  const fetched = [];
  page.on("request", (request) => fetched.push(new URL(request.url()).pathname));
  await page.route(`${server.origin}/`, (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>copies</title>" }));
  await page.goto(server.origin);
  const { before, numbers, end } = await page.evaluate(async (bytes) => {
    const { createClient } = await import("/dist/client.js");
    const key = new Uint8Array(32).fill(9);
    const client = await createClient();
    const model = Uint8Array.from(bytes);
    const before = performance.getEntriesByType("resource").some(({ name }) => name.includes("copies"));
    const numbers = [];
    for await (const { model: copy, report } of client.copies(model, [5, 3, 4], key, { workers: 2 })) {
      const tracing = await client.trace(copy, key, Float64Array.of(3, 4, 5));
      numbers.push([report.number, tracing.buyers.map(({ number }) => number)]);
    }
    const end = await client.copies(model, [1, -1], key).next().then(({ value }) => value.report.number);
    client.dispose();
    return { before, numbers, end };
  }, [...small]);
  assert.equal(before, false, "the module comes when it is asked for");
  assert.deepEqual(numbers, [[5, [5]], [3, [3]], [4, [4]]]);
  assert.equal(end, 1);
  assert.ok(fetched.some((path) => path.endsWith("full_bg.wasm")));
  await page.close();
});
