// The recipes of docs/RECIPES.md: each is built as somebody would build it. Its form marks a model in Chromium and sends it; on the edge, a
// copy is stamped at download.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import * as meshmark from "meshmark";
import { launch } from "../browser.mjs";
import { marksBeforeUpload, serveForm } from "../form.mjs";
import { buildNext, clean, install, path, run } from "./support.mjs";

const KEY = new Uint8Array(32).fill(9);
const RECIPES = ["html/index.html", "html/upload.js", "react/upload.jsx", "next/app/page.jsx", "vue/Upload.vue", "vue/vite.config.js", "edge/worker.js", "edge/build.mjs", "edge/config.capnp"];
let browser;

before(async () => {
  install();
  await meshmark.initFull();
  browser = await launch();
});

after(() => browser?.close());

/** The built page in a folder marks what is chosen, and sends that. */
async function works(folder) {
  const server = await serveForm({ "/": new URL(`recipes/${folder}/`, import.meta.url) });
  try {
    await marksBeforeUpload(browser, server, meshmark, KEY);
  } finally {
    server.close();
  }
}

async function buildVite(folder) {
  clean(`recipes/${folder}/dist`);
  const { build } = await import("vite");
  await build({ root: path(`recipes/${folder}`), logLevel: "warn" });
}

test("docs/RECIPES.md shows what is tried here", () => {
  const shown = readFileSync(new URL("../../../docs/RECIPES.md", import.meta.url), "utf8");
  for (const file of RECIPES) {
    assert.ok(shown.includes(readFileSync(path(`recipes/${file}`), "utf8")), `docs/RECIPES.md shows another ${file}`);
  }
});

test("React", async () => {
  await buildVite("react");
  await works("react/dist");
});

test("Next", async () => {
  buildNext("recipes/next", "--turbopack");
  await works("next/out");
});

test("Vue", async () => {
  await buildVite("vue");
  await works("vue/dist");
});

test("an edge worker stamps at download", { timeout: 120_000 }, async () => {
  clean("recipes/edge/dist");
  run(process.execPath, ["build.mjs"], { cwd: path("recipes/edge") });
  writeFileSync(path("recipes/edge/dist/model.plan"), meshmark.prepare(meshmark.demoModel(), KEY).plan);
  const program = path("node_modules/workerd/bin/workerd");
  const worker = spawn(program, ["serve", path("recipes/edge/config.capnp"), "--control-fd=3"], { stdio: ["ignore", "inherit", "inherit", "pipe"] });
  try {
    let port;
    for await (const line of worker.stdio[3]) {
      port = JSON.parse(String(line).trim().split("\n").at(-1)).port;
      break;
    }
    const ledger = Float64Array.of(6, 7, 8);
    for (const number of [7, 8]) {
      const response = await fetch(`http://127.0.0.1:${port}/?number=${number}`);
      assert.equal(response.status, 200);
      const { buyers } = meshmark.trace(new Uint8Array(await response.arrayBuffer()), KEY, ledger);
      assert.deepEqual(buyers.map((buyer) => buyer.number), [number]);
    }
  } finally {
    worker.kill();
  }
});
