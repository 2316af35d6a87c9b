// The packed package in projects of others: each bundler builds a page, and the page marks and finds in Chromium. What the package's
// README says of bundlers is tried here. They have a lock file of their own: `npm ci` in www/ installs none of them.
import assert from "node:assert/strict";
import { copyFileSync, readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { promisify } from "node:util";
import { launch, serve } from "../browser.mjs";
import { buildNext, clean, install, path, run } from "./support.mjs";

const FOUND = "found BUNDLED";
/** A build on a busy machine, and a page that marks and finds. */
const SLOW = 120_000;

let browser;

before(async () => {
  install();
  browser = await launch();
});

after(() => browser?.close());

/** What the page at an address comes to. */
async function resultOf(origin) {
  const page = await browser.newPage();
  const said = [];
  page.on("console", (message) => said.push(message.text()));
  page.on("pageerror", (error) => said.push(error.message));
  await page.goto(origin);
  await page.waitForFunction(() => /found|none|partial|Error/.test(document.title), undefined, { timeout: SLOW }).catch(() => {});
  const title = await page.title();
  await page.close();
  return title === FOUND ? FOUND : [title, ...said].join("\n");
}

/** What the built page in a folder comes to. */
async function resultOfFolder(folder) {
  const server = await serve(new URL(`${folder}/`, import.meta.url), { configFile: false, appType: "mpa", build: { outDir: "." } });
  try {
    return await resultOf(server.origin);
  } finally {
    await server.close();
  }
}

test("Node", () => {
  assert.equal(run(process.execPath, [path("node/main.mjs")]).trim(), FOUND);
});

test("Vite, built", async () => {
  clean("vite/dist");
  const { build } = await import("vite");
  await build({ root: path("vite"), logLevel: "warn" });
  assert.equal(await resultOfFolder("vite/dist"), FOUND);
});

test("Vite, served by its development server", async () => {
  const { createServer } = await import("vite");
  const server = await createServer({ root: path("vite"), logLevel: "warn", server: { host: "127.0.0.1", fs: { allow: [path(".")] } } });
  await server.listen();
  try {
    assert.equal(await resultOf(server.resolvedUrls.local[0]), FOUND);
  } finally {
    await server.close();
  }
});

test("webpack", async () => {
  clean("webpack/dist");
  const [{ default: webpack }, { default: config }] = await Promise.all([import("webpack"), import("./webpack/webpack.config.js")]);
  const stats = await promisify(webpack)(config);
  assert.deepEqual([...stats.toJson().errors, ...stats.toJson().warnings.filter(({ message }) => !/size/.test(message))].map(({ message }) => message), []);
  copyFileSync(path("webpack/index.html"), path("webpack/dist/index.html"));
  assert.equal(await resultOfFolder("webpack/dist"), FOUND);
});

test("esbuild, as the README shows it", async () => {
  const readme = readFileSync(path("node_modules/meshmark/README.md"), "utf8");
  assert.ok(readme.includes(readFileSync(path("esbuild/build.mjs"), "utf8")), "the README shows another build");
  clean("esbuild/dist");
  run(process.execPath, ["build.mjs"], { cwd: path("esbuild") });
  copyFileSync(path("esbuild/index.html"), path("esbuild/dist/index.html"));
  assert.equal(await resultOfFolder("esbuild/dist"), FOUND);
});

for (const [name, option] of [["Next", "--turbopack"], ["Next, by webpack", "--webpack"]]) {
  test(name, async () => {
    buildNext("next", option);
    assert.equal(await resultOfFolder("next/out"), FOUND);
  });
}
