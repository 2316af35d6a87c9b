// The package's own files in Chromium, without a bundler and under a strict policy: the client and its worker.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { after, before, beforeEach, test } from "node:test";
import * as meshmark from "meshmark";
import { launch, serve } from "./browser.mjs";
import { packageFolder } from "./support.mjs";

const POLICY = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'";

let server;
let browser;
let page;

before(async () => {
  await meshmark.init();
  server = await serve(packageFolder, { configFile: false, appType: "mpa", build: { outDir: "." } });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
});

beforeEach(async () => {
  await page?.close();
  page = await browser.newPage();
  await page.route(`${server.origin}/`, (route) =>
    route.fulfill({ contentType: "text/html", headers: { "Content-Security-Policy": POLICY }, body: "<!doctype html><title>client</title>" }),
  );
  await page.goto(server.origin);
  await page.evaluate(async () => {
    const { createClient } = await import("/dist/client.js");
    globalThis.createClient = createClient;
    globalThis.key = new Uint8Array(32).fill(9);
    /** How a promise ends: its error's code, or "done". */
    globalThis.end = (promise) => promise.then(() => "done", (error) => `${error.name} ${error.code}`);
    globalThis.sha256 = async (bytes) =>
      [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  });
});

test("it marks to the same bytes as in Node, heard all the way, its inputs left whole", async () => {
  const inBrowser = await page.evaluate(async () => {
    const client = await createClient();
    const host = await client.demoModel();
    const stages = new Set();
    const { model, report } = await client.embed(host, "CLIENT", key, { onProgress: (stage) => stages.add(stage) });
    const reading = await client.extract(await client.measure(model), key);
    const tried = [];
    const detected = await client.detect(model, key, { expected: "CLIENT", onProgress: (stage, fraction) => stage === "test" && tried.push(fraction) });
    return { host: host.length, key: key.length, sha256: await sha256(model), report, reading, detected, tried, stages: [...stages] };
  });
  const host = meshmark.demoModel();
  const key = new Uint8Array(32).fill(9);
  const { model, report } = meshmark.embed(host, "CLIENT", key);
  assert.equal(inBrowser.sha256, createHash("sha256").update(model).digest("hex"));
  assert.deepEqual(inBrowser.report, report);
  assert.deepEqual(inBrowser.reading, meshmark.extract(meshmark.measure(model), key));
  assert.deepEqual(inBrowser.detected, meshmark.detect(model, key, { expected: "CLIENT" }));
  assert.ok(inBrowser.tried.length > 0, "no hypothesis is heard of");
  assert.equal(inBrowser.host, host.length);
  assert.equal(inBrowser.key, 32);
  assert.ok(inBrowser.stages.includes("embed"), inBrowser.stages.join());
});

test("aborting ends the call it belongs to, and no other, and so does a listener that throws", async () => {
  const ends = await page.evaluate(async () => {
    const client = await createClient();
    const host = await client.demoModel();
    const [running, waiting] = [new AbortController(), new AbortController()];
    const calls = [
      client.embed(host, "A", key, { signal: running.signal, onProgress: () => running.abort() }),
      client.embed(host, "B", key, { signal: waiting.signal }),
      client.embed(host, "C", key),
      client.measure(host, { onProgress: () => { throw new Error("enough"); } }),
      client.version({ signal: AbortSignal.abort() }),
    ].map(end);
    waiting.abort();
    return Promise.all(calls);
  });
  assert.deepEqual(ends, ["MeshmarkError aborted", "MeshmarkError aborted", "done", "MeshmarkError aborted", "MeshmarkError aborted"]);
});

test("dispose ends what runs, what waits and what comes", async () => {
  const ends = await page.evaluate(async () => {
    const client = await createClient();
    const calls = [end(client.demoModel()), end(client.version())];
    client.dispose();
    return Promise.all([...calls, end(client.version())]);
  });
  assert.deepEqual(ends, Array(3).fill("MeshmarkError disposed"));
});

test("errors arrive as MeshmarkErrors, and the client goes on", async () => {
  const ends = await page.evaluate(async () => {
    const client = await createClient();
    const wrong = [client.inspect(new Uint8Array(3)), client.extract(key, key, { onProgress: () => {} }), client.version({ other: 1 })];
    return [...(await Promise.all(wrong.map(end))), await end(client.version())];
  });
  assert.match(ends[0], /^MeshmarkError document\./);
  assert.deepEqual(ends.slice(1), ["MeshmarkError options.argument", "MeshmarkError options.argument", "done"]);
});

test("a worker or a module that is not there is said to be missing", async () => {
  const ends = await page.evaluate(() => Promise.all([end(createClient({ workerUrl: "/none.js" })), end(createClient({ wasmUrl: "/none.wasm" }))]));
  assert.deepEqual(ends, ["MeshmarkError worker.failed", "MeshmarkError init.failed"]);
});

test("the module may come from elsewhere", async () => {
  const version = await page.evaluate(async () => (await createClient({ workerUrl: "/dist/worker.js", wasmUrl: "/wasm/meshmark_bg.wasm" })).version());
  assert.equal(version, meshmark.version());
});
