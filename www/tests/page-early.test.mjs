// The page that is there before its other modules.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { launch, serve, SLOW } from "./browser.mjs";
import { packageFolder } from "./support.mjs";

const app = new URL("../app", import.meta.url);

test("the package compiles before its full module is there", () => {
  const project = mkdtempSync(join(tmpdir(), "meshmark-early-"));
  for (const part of ["package.json", "src", "tsconfig.json", "wasm"]) {
    cpSync(new URL(part, packageFolder), join(project, part), { recursive: true });
  }
  const compiler = fileURLToPath(new URL("../node_modules/typescript/bin/tsc", import.meta.url));
  const { status, stdout } = spawnSync(process.execPath, [compiler, "--project", project], { encoding: "utf8" });
  assert.equal(status, 0, stdout);
  rmSync(project, { recursive: true });
});

test("the page is built before the study and the attacks are, and says so where one is asked for", async () => {
  const outDir = mkdtempSync(join(tmpdir(), "meshmark-early-"));
  execFileSync("npm", ["run", "build:early", "--", "--outDir", outDir, "--emptyOutDir"], { cwd: fileURLToPath(app) });
  const server = await serve(app, { build: { outDir } });
  const browser = await launch();
  try {
    const page = await browser.newPage();
    page.setDefaultTimeout(SLOW);
    await page.goto(server.origin);
    await page.getByRole("button", { name: "Try the demo model" }).click();
    await page.getByRole("tabpanel").getByText("demo.glb").first().waitFor(); // the study begins with it
    await page.getByRole("tab", { name: "Study" }).click();
    await page.getByRole("tabpanel").getByText("still being built").waitFor();
    const compressed = { asset: { version: "2.0" }, extensionsRequired: ["KHR_draco_mesh_compression"] };
    await page.getByRole("tab", { name: "Check" }).click();
    const input = page.getByRole("tabpanel").locator('[data-input="files"]');
    await input.setInputFiles({ name: "a.gltf", mimeType: "model/gltf+json", buffer: Buffer.from(JSON.stringify(compressed)) });
    await page.getByRole("tabpanel").getByRole("heading", { name: /still being built/ }).waitFor();
    assert.equal(await page.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length), 0, "a service worker keeps this page");
  } finally {
    await browser.close();
    await server.close();
    rmSync(outDir, { recursive: true });
  }
});
