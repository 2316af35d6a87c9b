// The pictures of the project's README: the page after it has marked the demo model, and after it has checked a piece of that with the original.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { demoModel, init } from "meshmark";
import * as attacks from "./app/research-wasm/research.js";
import { launch, serve, SLOW } from "./tests/browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "meshmark-pictures-"));
const saved = (name, bytes) => (writeFileSync(join(folder, name), bytes), join(folder, name));

await init();
await attacks.default({ module_or_path: readFileSync(new URL("app/research-wasm/research_bg.wasm", import.meta.url)) });
const original = saved("rock.glb", demoModel());

const server = await serve(new URL("app", import.meta.url));
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "light" });
page.setDefaultTimeout(SLOW);
const panel = () => page.getByRole("tabpanel");
const open = (file) => panel().locator('[data-input="files"]').setInputFiles(file);
const picture = (name) => page.screenshot({ path: fileURLToPath(new URL(`../docs/pictures/${name}.png`, import.meta.url)) });

async function fillKey() {
  await panel().getByLabel("Owner’s name").fill("Ada");
  await panel().locator('input[type="password"]').first().fill("correct horse battery staple");
}

await page.goto(server.origin);
await open(original);
await fillKey();
await page.getByLabel("The same passphrase again", { exact: true }).fill("correct horse battery staple");
await page.getByLabel("Tag", { exact: true }).fill("ADA-1");
await page.locator("#preview[aria-busy=false]").waitFor();
await page.getByRole("button", { name: /^Mark/ }).last().click();
await page.getByRole("button", { name: "Check this copy" }).waitFor();
const download = page.waitForEvent("download");
await page.getByRole("button", { name: /^Download/ }).first().click();
const marked = readFileSync(await (await download).path());
await picture("marked");

await page.getByRole("tab", { name: "Check" }).click();
await open(saved("suspect.glb", attacks.attack(marked, ["crop 30 %", "simplify 50 %", "quantize 10 bits", "similarity"])));
await fillKey();
await page.getByLabel("Original, or record").setInputFiles(original);
await panel().getByRole("button", { name: "Check this model" }).click();
await page.getByRole("heading", { name: "Your mark was found" }).waitFor();
await page.getByRole("button", { name: "On the original", exact: true }).click();
await picture("found");

await browser.close();
await server.close();
rmSync(folder, { recursive: true });
