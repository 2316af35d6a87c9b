// The facade in Node: loading, errors, size.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import * as meshmark from "meshmark";
import { createClient, MeshmarkError } from "meshmark/client";
import { packageFolder } from "./support.mjs";

const wasm = new URL("wasm/meshmark_bg.wasm", packageFolder);

/** Runs a module in a fresh Node, where nothing has been loaded yet; returns what it prints. */
function fresh(code) {
  return execFileSync(process.execPath, ["--input-type=module", "--eval", code], { cwd: new URL(".", import.meta.url), encoding: "utf8" }).trim();
}

test("importing touches no browser global", () => {
  const output = fresh(`
    for (const name of ["window", "self", "document", "navigator", "location", "Worker", "localStorage"]) {
      Object.defineProperty(globalThis, name, { get() { throw new Error("touched " + name); } });
    }
    await import("meshmark");
    await import("meshmark/client");
    console.log("untouched");`);
  assert.equal(output, "untouched");
});

for (const [what, input] of Object.entries({
  "nothing, from disk": "",
  "a file URL": "url",
  "a file URL as text": "url.href",
  bytes: "await readFile(url)",
  "a compiled module": "await WebAssembly.compile(await readFile(url))",
  "a response": "new Response(await readFile(url), { headers: { 'content-type': 'application/wasm' } })",
  "a response with another MIME type": "new Response(await readFile(url), { headers: { 'content-type': 'application/octet-stream' } })",
})) {
  test(`init takes ${what}`, () => {
    const output = fresh(`
      import { readFile } from "node:fs/promises";
      import { init, version } from "meshmark";
      const url = new URL(${JSON.stringify(wasm.href)});
      console.warn = () => {};
      await init(${input});
      console.log(version());`);
    const { version } = JSON.parse(readFileSync(new URL("package.json", packageFolder), "utf8"));
    assert.equal(output, version);
  });
}

test("init fails with a code, and can then be repeated", () => {
  const output = fresh(`
    import { init, version } from "meshmark";
    await init(new Uint8Array(8)).catch((error) => console.log(error.name, error.code));
    await init();
    console.log(typeof version());`);
  assert.equal(output, "MeshmarkError init.failed\nstring");
});

test("a function called before init says so", () => {
  const output = fresh(`
    import { version } from "meshmark";
    try { version(); } catch (error) { console.log(error.name, error.code); }`);
  assert.equal(output, "MeshmarkError init.missing");
});

test("init is idempotent", async () => {
  assert.equal(meshmark.init(), meshmark.init());
  await meshmark.init();
});

test("what the module throws is a MeshmarkError with code and path", async () => {
  await meshmark.init();
  const truncated = meshmark.demoModel().slice(0, 1000);
  assert.throws(() => meshmark.inspect(truncated), (error) => {
    assert.ok(error instanceof MeshmarkError && error instanceof Error);
    assert.match(error.code, /^document\./);
    assert.ok(error.message.length > 0);
    assert.ok(error.path === null || typeof error.path === "string");
    return true;
  });
});

test("a key is Argon2id's of the name and the passphrase, as docs/FORMAT.md says", async () => {
  await meshmark.init();
  const key = Buffer.from(meshmark.deriveKey("Ada", "correct horse battery staple"));
  assert.equal(key.toString("hex"), "1e880652b5b6d7b3009828ff54ee8de813fb064b83b8b4311e9721e4505dd825");
});

test("a key does not depend on how its name and passphrase were typed", async () => {
  await meshmark.init();
  const typed = meshmark.deriveKey("Zo\u00eb", "caf\u00e9 \uff11");
  assert.deepEqual(meshmark.deriveKey(" Zoe\u0308 ", "cafe\u0301 1"), typed);
  assert.notDeepEqual(meshmark.deriveKey("Zoe", "cafe 1"), typed);
});

test("every carrier speaks, in its order, and a carrier alone leaves the other silent", async () => {
  await meshmark.init();
  const key = new Uint8Array(32).fill(5);
  const names = (list) => list.map(({ name }) => name);
  const host = meshmark.demoModel();
  assert.deepEqual(meshmark.capacity(host), { holds: "payload", strength: "balanced", reason: null });
  const { readBack } = meshmark.embed(host, "ALONE", key, { carriers: ["ring"] }).report;
  assert.deepEqual(names(readBack.carriers), ["solid", "ring"]);
  assert.deepEqual(readBack.carriers.map(({ tag }) => tag), [null, "ALONE"]);
  const none = () => meshmark.embed(host, "ALONE", key, { carriers: [] });
  assert.throws(none, (error) => error instanceof MeshmarkError && error.code === "options.no-carrier");
});

test("detect reads at one go what measure, extract and verify read", async () => {
  await meshmark.init();
  const [key, stranger] = [5, 6].map((byte) => new Uint8Array(32).fill(byte));
  const { model } = meshmark.embed(meshmark.demoModel(), "GO", key);
  const evidence = meshmark.measure(model);
  const answer = ({ verdict, tag }) => [verdict, tag];
  assert.deepEqual(answer(meshmark.detect(model, key)), ["found", "GO"]);
  assert.deepEqual(answer(meshmark.detect(model, key, { expected: "GO" })), answer(meshmark.verify(evidence, key, "GO")));
  assert.deepEqual(answer(meshmark.detect(model, key, { expected: "OTHER" })), answer(meshmark.verify(evidence, key, "OTHER")));
  assert.deepEqual(answer(meshmark.detect(model, stranger)), answer(meshmark.extract(evidence, stranger)));
  for (const read of [(options) => meshmark.extract(evidence, stranger, options), (options) => meshmark.detect(model, stranger, options)]) {
    assert.equal("lnP" in read(), false, "what follows the key is told");
    assert.equal(typeof read({ details: true }).lnP, "number");
  }
  assert.deepEqual([meshmark.extract(evidence, key).input, meshmark.detect(model, key).input], ["evidence", "model"]);
  const [one] = meshmark.extractMany(evidence, [key]);
  const [not, ofTwo] = meshmark.extractMany(evidence, [stranger, key]);
  assert.deepEqual([not.verdict, ...answer(ofTwo)], ["none", "found", "GO"]);
  assert.ok(ofTwo.lnP > one.lnP && one.lnP === meshmark.extract(evidence, key).lnP, `${ofTwo.lnP} of two, ${one.lnP} of one`);
  assert.throws(() => meshmark.extractMany(evidence, [key, "key"]), { code: "options.argument" });
  const fractions = [];
  meshmark.detect(model, stranger, { onProgress: (stage, fraction) => stage === "test" && fractions.push(fraction) });
  assert.ok(fractions.length > 1, "no hypothesis is heard of");
  assert.deepEqual(fractions, fractions.toSorted((a, b) => a - b));
});

test("an embedding foretells what its mark survives, each kind of change once", async () => {
  await meshmark.init();
  const embed = (options) => meshmark.embed(meshmark.demoModel(), "FORE", new Uint8Array(32).fill(5), options).report.forecast;
  const both = embed({});
  assert.deepEqual(both.map(({ attack }) => attack).sort(), ["crop", "noise", "none", "quantize", "simplify-30", "simplify-50", "simplify-70", "smooth", "web"]);
  assert.equal(both.find(({ attack }) => attack === "none").level, "green");
  const ring = embed({ carriers: ["ring"] }); // connectivity alone: other triangles, another connectivity
  assert.deepEqual(ring.filter(({ level }) => level === "red").map(({ attack }) => attack), ["simplify-30", "simplify-50", "simplify-70"]);
});

test("a key of another length is refused", async () => {
  await meshmark.init();
  const isKeyError = (error) => error instanceof MeshmarkError && error.code.startsWith("key.");
  assert.throws(() => meshmark.embed(meshmark.demoModel(), "TAG", new Uint8Array(31)), isKeyError);
});

test("a listener that throws stops the work with code aborted", async () => {
  await meshmark.init();
  const [model, key] = [meshmark.demoModel(), new Uint8Array(32)];
  let heard = 0;
  const onProgress = () => {
    heard++;
    throw new Error("enough");
  };
  const calls = [() => meshmark.embed(model, "TAG", key, { onProgress }), () => meshmark.measure(model, { onProgress }), () => meshmark.detect(model, key, { onProgress })];
  for (const work of calls) {
    assert.throws(work, (error) => error instanceof MeshmarkError && error.code === "aborted");
  }
  assert.equal(heard, calls.length, "it was told more after it had thrown");
});

test("a module that stops says why on the console, and the caller is told internal", () => {
  const output = fresh(`
    import { init, inspect } from "meshmark";
    console.error = (text) => console.log(text);
    await init();
    const lying = Object.defineProperty(new Uint8Array(1), "length", { value: 2 ** 32 - 1 }); // more than a module can ever hold
    try { inspect(new Uint8Array(4), { files: { lying } }); } catch (error) { console.log(error.name, error.code); }`);
  const [said, told] = output.split(/\n(?=MeshmarkError)/);
  assert.match(said, /^meshmark: panicked at .+\.rs:\d+:\d+:\s+capacity overflow/);
  assert.equal(told, "MeshmarkError internal");
});

test("where there is no Worker, createClient rejects with a code", async () => {
  await assert.rejects(createClient(), (error) => error instanceof MeshmarkError && error.code === "worker.failed");
});

/** What only some pages load, an entry of its own. */
const MORE = ["elements.js"];

test("the facade stays within 6 KiB, compressed", (t) => {
  const dist = new URL("dist/", packageFolder);
  const code = readdirSync(dist).filter((name) => name.endsWith(".js") && !MORE.includes(name)).map((name) => readFileSync(new URL(name, dist)));
  const size = gzipSync(Buffer.concat(code), { level: 9 }).length;
  t.diagnostic(`facade ${size} bytes, module ${gzipSync(readFileSync(wasm), { level: 9 }).length} bytes, compressed`);
  assert.ok(size <= 6 * 1024, `${size} bytes`);
});
