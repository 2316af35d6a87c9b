// The built page in Chromium, as a person uses it: real files, real clicks, no network but its own origin.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { fileURLToPath } from "node:url";
import { NodeIO } from "@gltf-transform/core";
import * as meshmark from "meshmark";
import { launch, serve } from "./browser.mjs";
import { assertNoNewErrors, glbFromObj, glbOf, OWNER, PASSPHRASE, repository, sharedModel, TAG } from "./support.mjs";

const DESKTOP = { width: 1280, height: 800 };
const CUBE = `
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8`;
/** The cube as a thin rod: neither its shape nor its connectivity can hold a mark. */
const ROD = CUBE.replaceAll(/^v (\d) (\d) (\d)$/gm, (_, x, y, z) => `v ${x} ${y / 100} ${z / 100}`);
const SLOW = 120_000;

const pictures = new URL("test-output/", repository);
const folder = mkdtempSync(join(tmpdir(), "meshmark-page-"));
let server;
let browser;
let context;
let page;
/** What must stay empty: requests to elsewhere, policy violations, script errors, dialogs. */
let offences;

before(async () => {
  mkdirSync(pictures, { recursive: true });
  await meshmark.init();
  server = await serve(new URL("../app", import.meta.url));
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, { recursive: true });
});

beforeEach(() => open());

afterEach(async () => {
  const violations = await page.evaluate(() => globalThis.violations);
  await context.close();
  assert.deepEqual([...offences, ...violations], []);
});

async function open(options = {}) {
  await context?.close();
  offences = [];
  context = await browser.newContext({ viewport: DESKTOP, colorScheme: "light", ...options });
  context.on("request", (request) => {
    const url = new URL(request.url());
    if (url.origin !== server.origin && url.protocol !== "blob:") {
      offences.push(`request to ${request.url()}`);
    }
  });
  await context.addInitScript(() => {
    globalThis.violations = [];
    globalThis.asked = []; // what workers were asked to do
    const { postMessage } = Worker.prototype;
    Worker.prototype.postMessage = function (message, ...rest) {
      globalThis.asked.push(message.name);
      return postMessage.call(this, message, ...rest);
    };
    addEventListener("securitypolicyviolation", (event) => globalThis.violations.push(`${event.violatedDirective} ${event.blockedURI}`));
  });
  page = await context.newPage();
  page.setDefaultTimeout(SLOW);
  page.on("pageerror", (error) => offences.push(`error ${error.message}`));
  page.on("dialog", (dialog) => offences.push(`dialog ${dialog.message()}`));
  page.on("console", (message) => /content security policy/i.test(message.text()) && offences.push(message.text()));
  await page.goto(server.origin);
}

/** Drops files or folders from disk on the middle of the page, as the desktop does. */
async function drop(...paths) {
  const session = await context.newCDPSession(page);
  const data = { items: [], files: paths, dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"]) {
    await session.send("Input.dispatchDragEvent", { type, x: 640, y: 400, data });
  }
}

function onDisk(name, bytes) {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
}

/** Whether something comes true within seconds. */
async function eventually(isTrue) {
  for (let tries = 0; tries < 20; tries++) {
    if (await isTrue()) {
      return true;
    }
    await page.waitForTimeout(250);
  }
  return false;
}

const view = () => page.locator(".view:visible");
const result = () => view().locator(".result");
const headline = () => result().getByRole("heading", { level: 2 }).textContent();
const facts = () => view().locator(".facts");
const canvas = () => view().getByRole("application");
const button = (name) => view().getByRole("button", { name, exact: true });
const scale = async (unit) => (await view().locator(`[data-legend="${unit}"] span`).allTextContents()).join(" ");
const preview = () => page.locator("#preview");
/** The preview's RMS displacement, in percent of the diagonal. */
const previewRms = async () => parseFloat(await preview().locator("dd").first().textContent());
const picture = (name) => page.screenshot({ path: fileURLToPath(new URL(`${name}.png`, pictures)) });

async function fillKey(passphrase = PASSPHRASE) {
  await page.getByLabel("Owner’s name").fill(OWNER);
  await page.getByLabel("Passphrase", { exact: true }).and(page.locator("input:not([type=radio])")).fill(passphrase);
}

async function mark(tag = TAG) {
  await fillKey();
  await page.getByLabel("Tag", { exact: true }).fill(tag);
  await page.getByRole("button", { name: "Mark this model" }).click();
  await result().waitFor();
}

async function check(passphrase = PASSPHRASE) {
  await fillKey(passphrase);
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().waitFor();
}

/** Presses a button that saves a file; returns where it is. */
async function saved(name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name }).click()]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

async function dropped(path) {
  await drop(path);
  await facts().getByText(basename(path), { exact: true }).waitFor();
}

for (const [name, source] of [
  ["demo.glb", () => meshmark.demoModel()],
  ["chr_knight.glb", (t) => sharedModel("gltf/chr_knight.glb", t)],
]) {
  test(`${name} is dropped, marked, downloaded, and its mark found with this key alone`, async (t) => {
    const host = source(t);
    if (!host) {
      return;
    }
    await dropped(onDisk(name, host));
    await mark();
    assert.equal(await headline(), "Your mark is in the copy");
    await picture(`marked-${name}`);
    await page.getByRole("button", { name: "Heat map" }).click();
    assert.match(await scale("units"), /^0 0\.\d+ units 0\.\d+ units$/);
    assert.match(await scale("percent"), /^0 0\.\d+ % 0\.\d+ %$/);
    await picture(`heat-${name}`);
    for (const version of ["Original", "Marked"]) {
      await button(version).click();
      await button(version).and(page.locator('[aria-pressed="true"]')).waitFor();
    }
    const copy = await saved(/^Download/);
    assert.equal(basename(copy), name.replace(".glb", ".marked.glb"));
    await assertNoNewErrors(host, new Uint8Array(readFileSync(copy)));

    await page.getByRole("tab", { name: "Check" }).click();
    await dropped(copy);
    await check();
    assert.equal(await headline(), "Your mark was found");
    await result().getByText(/at most 1 in 10/).first().waitFor();
    await result().getByText(/^Read from the (shape|connectivity|shape and the connectivity)\.$/).waitFor();
    await picture(`found-${name}`);
    const report = JSON.parse(readFileSync(await saved("Save report (JSON)"), "utf8"));
    assert.equal(report.result.verdict, "found");
    assert.equal(report.result.tag, TAG);
    assert.ok(!JSON.stringify(report).includes(PASSPHRASE) && !JSON.stringify(report).includes(OWNER));

    await check("another passphrase");
    assert.equal(await headline(), "No evidence of this key");
    await result().getByText("This does not prove that the model is not yours.").waitFor();
    assert.equal(await result().getByText("Agreement").isVisible(), false, "what follows the key is shown unasked");
    await result().getByText("Details for the owner").click();
    await result().getByText("Keep these figures to yourself.").waitFor();
    assert.ok(await result().getByText("Agreement").isVisible());
    const passedOn = JSON.parse(readFileSync(await saved("Save report (JSON)"), "utf8")).result;
    assert.deepEqual(Object.keys(passedOn).sort(), ["input", "number", "reason", "sentence", "tag", "verdict"]);
    await picture(`none-${name}`);

    await page.getByLabel(/Tag to look for/).fill(TAG);
    await check();
    assert.equal(await headline(), "Your mark was found");
  });
}

test("a .gltf with its folder is dropped, marked, and downloaded file by file", async () => {
  const io = new NodeIO();
  const { json, resources } = await io.writeJSON(await io.readBinary(meshmark.demoModel()), { basename: "scene" });
  const scene = join(folder, "scene");
  mkdirSync(scene);
  writeFileSync(join(scene, "scene.gltf"), JSON.stringify(json));
  for (const [uri, bytes] of Object.entries(resources)) {
    writeFileSync(join(scene, uri), bytes);
  }
  await drop(scene);
  await facts().getByText("scene.gltf").waitFor();
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const gltf = await saved("Download scene.marked.gltf");
  const bin = await saved("Download scene.bin");

  await page.getByRole("tab", { name: "Check" }).click();
  await drop(gltf, bin);
  await facts().getByText("scene.marked.gltf").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
});

test("a truncated file is refused in words, and a good one afterwards is not", async () => {
  const model = meshmark.demoModel();
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("cut.glb", model.slice(0, model.length / 2)));
  await result().waitFor();
  assert.match(await headline(), /^Cannot check: .*\w+/);
  await result().getByText("document.").waitFor();
  await picture("truncated");
  await check();
  assert.match(await headline(), /^Cannot check: /);

  await dropped(onDisk("whole.glb", model));
  await view().locator(".viewer canvas").first().waitFor();
  assert.equal(await result().count(), 0);
});

test("a model that is too small is told so before and after it is tried, in numbers", async () => {
  const offers = (home) => `its ${home} offers \\d+ of the \\d+ places that are needed`;
  await dropped(onDisk("rod.glb", glbFromObj(ROD)));
  await view().getByText(new RegExp(`too small or too regular to hold a mark: ${offers("shape")}, ${offers("connectivity")}`)).waitFor();
  await mark();
  assert.match(await headline(), /^Cannot mark: .*too small or too regular.*\d/);
  await result().getByText("carrier.too-few-addresses").waitFor();
  await picture("too-small");

  await dropped(onDisk("cube.glb", glbFromObj(CUBE)));
  await view().getByText(new RegExp(`too small or too regular to hold a mark: ${offers("shape")}, ${offers("connectivity")}`)).waitFor();
  await mark();
  assert.match(await headline(), /^Cannot mark: .*\d/);
});

test("the carriers can be chosen, and one always stays", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await view().getByText("Advanced").click();
  const [shape, connectivity] = ["Shape (SOLID)", "Connectivity (RING)"].map((name) => page.getByRole("checkbox", { name }));
  assert.ok((await shape.isChecked()) && (await connectivity.isChecked()));
  await connectivity.uncheck();
  assert.ok(await shape.isDisabled());
  await connectivity.check();
  assert.ok(await shape.isEnabled());
  await shape.uncheck();
  assert.ok(await connectivity.isDisabled());
  await picture("advanced");
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const { report } = JSON.parse(readFileSync(await saved("Save report (JSON)"), "utf8"));
  assert.equal(await result().locator("dl div", { hasText: "Held by" }).locator("dd").textContent(), "Connectivity (RING)");
  assert.deepEqual(report.readBack.carriers.map(({ name, tag }) => [name, tag]), [["solid", null], ["ring", TAG]]);

  const [warning, download] = [result().locator(".warning"), result().getByRole("button", { name: /^Download/ })];
  assert.match(await warning.textContent(), /^It will not survive removing .* triangles\.$/);
  assert.ok((await warning.boundingBox()).y < (await download.boundingBox()).y, "the warning comes after the download");
  await picture("warning");

  await page.getByRole("button", { name: "Check this copy" }).click();
  await facts().getByText("demo.marked.glb").waitFor();
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().getByText("Read from the connectivity.").waitFor();
});

test("a strength is tried on the model before it is chosen, the last one wins, and what was tried is not done again", async () => {
  const embeddings = () => page.evaluate(() => asked.filter((name) => name === "embed").length);
  const tried = () => page.waitForFunction(() => document.querySelector("#preview")?.ariaBusy === "false");
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await preview().getByText("Tried with a key made for this preview.").waitFor();
  const balanced = await previewRms();
  for (const row of await preview().locator("li").allTextContents()) {
    assert.match(row, /\w.*(Survives|Barely|Lost)$/);
  }
  assert.equal(await preview().locator("li").count(), 7);
  await button("Marked").waitFor();
  await picture("preview");

  const seen = await page.evaluateHandle(() => {
    const texts = [];
    const content = document.querySelector("#preview-content");
    new MutationObserver(() => texts.push(content.querySelector("dd")?.textContent)).observe(content, { childList: true });
    return texts;
  });
  const before = await embeddings();
  await page.getByLabel("Strength").selectOption("strong");
  await page.waitForFunction((count) => asked.filter((name) => name === "embed").length > count, before);
  await page.getByLabel("Strength").selectOption("subtle"); // while the strong one is tried
  await page.waitForFunction((texts) => texts.length > 0, seen);
  await tried();
  assert.equal((await seen.jsonValue()).length, 1, "the strong one was shown too");
  assert.ok((await previewRms()) < balanced, `${await previewRms()} % and ${balanced} %`);

  await fillKey();
  await page.getByLabel("Tag", { exact: true }).fill(TAG);
  await preview().getByText("Tried with a key made").waitFor({ state: "hidden" });
  await tried();
  const subtle = await previewRms();
  const count = await embeddings();
  await page.getByRole("button", { name: "Mark this model" }).click();
  await result().waitFor();
  assert.equal(await embeddings(), count, "what was tried is done again");
  assert.equal(await preview().isVisible(), false);
  const { report } = JSON.parse(readFileSync(await saved("Save report (JSON)"), "utf8"));
  assert.equal(report.tag, TAG);
  assert.ok(Math.abs(report.rmsRel * 100 - subtle) < 0.0005, `${report.rmsRel} and ${subtle} %`);

  await page.getByLabel("Tag", { exact: true }).fill("OTHER");
  await page.getByRole("button", { name: "Mark this model" }).click();
  await result().locator("code", { hasText: "OTHER" }).first().waitFor();
  assert.equal(await embeddings(), count + 1, "another tag needs another copy");

  await page.getByLabel("Strength").selectOption("strong");
  assert.equal(await result().count(), 0, "a copy of another strength is still offered");
  await page.getByRole("tab", { name: "Check" }).click();
  await page.waitForTimeout(1000);
  assert.equal(await embeddings(), count + 1, "something is tried behind another view");
});

test("raking light shows the geometry's own normals, whatever seams and normals the file has", async () => {
  const { positions, indices } = torus();
  const split = indices.flatMap((corner) => positions.slice(corner * 3, corner * 3 + 3));
  const up = split.map((_, i) => Number(i % 3 === 1));
  const whole = onDisk("whole.glb", glbOf({ positions, indices }));
  const seams = onDisk("seams.glb", glbOf({ positions: split, indices: indices.map((_, i) => i), normals: up }));
  const normals = () => view().getByRole("group", { name: "Normals" });
  const look = async () => {
    await page.waitForTimeout(500);
    return canvas().screenshot();
  };
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(whole);
  const surface = await look();
  await button("Raking light").press("Enter");
  const raking = await look();
  await picture("raking");
  assert.notDeepEqual(raking, surface);
  assert.equal(await normals().isVisible(), false, "this file has no normals");

  await dropped(seams);
  assert.equal(await normals().isVisible(), false, "it is not their turn");
  await button("Raking light").press("Enter");
  assert.equal(await normals().isVisible(), true);
  assert.deepEqual(await look(), raking, "seams or the file's normals show");
  await button("File’s own").press("Enter");
  assert.notDeepEqual(await look(), raking);
  await button("Surface").press("Enter");
  assert.equal(await normals().isVisible(), false);
});

test("how many of the things that may have been done to a copy were tried is said while they are", async () => {
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  const said = await page.evaluateHandle(() => {
    const texts = new Set();
    const outcome = document.querySelector("#check [data-outcome]");
    new MutationObserver(() => texts.add(outcome.textContent)).observe(outcome, { childList: true, subtree: true, characterData: true });
    return texts;
  });
  await check();
  const texts = await page.evaluate((texts) => [...texts], said);
  assert.ok(texts.some((text) => /Looking for the mark … \d+ % tried/.test(text)), texts.join("\n"));
});

test("each carrier's part is told by its name, with what it survives, in both views", async () => {
  await dropped(onDisk("two.glb", meshmark.demoModel()));
  const read = async () => {
    await result().locator("summary").click();
    assert.deepEqual(await result().locator("tbody th").allTextContents(), ["Shape (SOLID)", "Connectivity (RING)"]);
    const hints = await result().locator(".carriers .hint").allTextContents();
    assert.match(hints.join(" "), /Shape \(SOLID\): Survives noise.* Connectivity \(RING\): Survives cropping/);
  };
  await mark();
  await read();
  await result().screenshot({ path: fileURLToPath(new URL("details-protect.png", pictures)) });
  await page.getByRole("button", { name: "Check this copy" }).click();
  await facts().getByText("two.marked.glb").waitFor();
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().waitFor();
  await read();
  await result().screenshot({ path: fileURLToPath(new URL("details-check.png", pictures)) });
});

test("compressed geometry is refused in words", async () => {
  const compressed = { asset: { version: "2.0" }, extensionsUsed: ["KHR_draco_mesh_compression"], extensionsRequired: ["KHR_draco_mesh_compression"] };
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("compressed.gltf", JSON.stringify(compressed)));
  await result().waitFor();
  assert.match(await headline(), /^Cannot check: .*(Draco|compress)/i);
});

test("files without a model are refused in words", async () => {
  await drop(onDisk("notes.txt", "nothing"));
  await result().waitFor();
  assert.equal(await headline(), "Cannot open: There is no .glb or .gltf file in this.");
});

test("work can be cancelled at any stage, and started again", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  for (const stage of ["Making your key", "Writing the mark"]) {
    await page.evaluate((words) => {
      const outcome = document.querySelector("#protect [data-outcome]");
      new MutationObserver((_, observer) => {
        if (outcome.textContent.includes(words)) {
          observer.disconnect();
          outcome.querySelector("button").click();
        }
      }).observe(outcome, { childList: true, subtree: true, characterData: true });
    }, stage);
    await page.getByLabel("Tag", { exact: true }).fill("");
    await fillKey();
    // In one go: once the form is complete the page begins on its own, and on a busy machine it may be done before a click.
    await page.getByLabel("Tag", { exact: true }).evaluate((input, tag) => {
      input.value = tag;
      input.dispatchEvent(new Event("input", { bubbles: true }));
      input.form.requestSubmit();
    }, TAG);
    await view().getByText("Cancelled. Nothing was changed.").waitFor();
  }
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
});

test("what a person waits for goes on behind another view, and while the form is filled in anew", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await fillKey();
  await page.getByLabel("Tag", { exact: true }).fill(TAG);
  await page.getByRole("button", { name: "Mark this model" }).click();
  await page.getByLabel("Tag", { exact: true }).fill("NEXT");
  await page.getByRole("tab", { name: "Check" }).click();
  await page.getByRole("tab", { name: "Protect" }).click();
  await result().waitFor();
  assert.equal(await headline(), "Your mark is in the copy");
  assert.equal(await result().locator("code").first().textContent(), TAG);
  await page.getByRole("button", { name: "Mark this model" }).click();
  await result().locator("code", { hasText: "NEXT" }).first().waitFor();
});

test("after one visit the page works without a network, through a reload", async () => {
  await page.getByText("Ready to work offline").waitFor();
  await context.setOffline(true);
  await page.reload();
  await page.getByRole("button", { name: "Try the demo model" }).click();
  await facts().getByText("demo.glb").waitFor();
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  await page.getByRole("tab", { name: "Study" }).click();
  await page.locator("#traced").getByText("Ranked anew").waitFor();
  await page.getByRole("tab", { name: "Break" }).click();
  await button("Try noise 0.1 %").click();
  await view().locator('tr[data-state="done"]').waitFor();
});

test("a made key file marks and finds, and a file of another length is refused", async () => {
  await page.getByRole("button", { name: "Try the demo model" }).click();
  await facts().getByText("demo.glb").waitFor();
  await page.locator("label", { hasText: "Key file" }).first().click();
  const keyFile = await saved("Make a key file");
  assert.equal(readFileSync(keyFile).length, 32);
  await page.getByLabel("Tag", { exact: true }).fill(TAG);
  await page.getByRole("button", { name: "Mark this model" }).click();
  await result().waitFor();
  await page.getByRole("button", { name: "Check this copy" }).click();
  await page.locator("input#key-file").setInputFiles(onDisk("short.key", Buffer.alloc(31)));
  await page.getByText("A key file has exactly 32 bytes; this one has 31.").waitFor();
  await page.locator("input#key-file").setInputFiles(keyFile);
  await page.getByText("This key file is in use.").waitFor();
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().waitFor();
  assert.equal(await headline(), "Your mark was found");
});

test("the study begins with the model in Protect, in a worker that was not there before, and is measured until it is cancelled", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  assert.equal(page.workers().length, 1);
  await page.getByRole("tab", { name: "Study" }).click();
  const traced = page.locator("#traced");
  await traced.getByText("Ranked anew").waitFor();
  // A worker that has been given up is listed for a moment.
  assert.ok(await eventually(() => page.workers().length === 2), `${page.workers().length} workers`);
  assert.match(await facts().textContent(), /demo\.glb.*11,7\d\d triangles.*from 12,\d+ vertices · 2\d,\d+ triangles/);

  const found = async () => parseInt(await traced.locator("dd").first().textContent(), 10);
  const once = await found();
  assert.ok(once > 0 && once < 1000, `${once}`);
  await page.locator("label", { hasText: /^0$/ }).click();
  await traced.getByText("1,000 of 1,000").waitFor();
  await page.getByLabel("Ranking").selectOption("literal");
  await page.locator("label", { hasText: /^1$/ }).click();
  assert.ok(await eventually(async () => (await found()) < once), "the literal ranking finds as many");

  const before = await canvas().screenshot();
  await button("Smoothed").click();
  await page.getByRole("combobox", { name: "Hosts", exact: true }).selectOption("fate");
  await view().getByText(/\d+ found again/).waitFor();
  assert.notDeepEqual(await canvas().screenshot(), before);
  for (const [field, said] of [["stability", "place in the ranking"], ["gaussian", "1/units²"], ["mean", "1/units;"], ["deviation", "% of the diagonal"]]) {
    await page.getByLabel("Colours of the surface").selectOption(field);
    await view().locator(".legend", { hasText: said }).waitFor();
  }

  await page.getByLabel("Smoothing").selectOption("laplacian");
  await button("Measure Table I and Fig. 5").click();
  await page.getByRole("region", { name: "Table I" }).locator("tbody tr:not(.rule)").nth(8).waitFor();
  await page.getByRole("region", { name: "Fig. 5" }).locator(".plot circle").nth(4).waitFor();
  await button("Cancel").click();
  await view().getByText("Cancelled. Nothing was changed.").waitFor();
  assert.equal(await button("Measure Table I and Fig. 5").getAttribute("aria-disabled"), null);
  await page.getByLabel("Hosts", { exact: true }).and(page.locator("input")).fill("500");
  await traced.getByText(" of 500 ").first().waitFor(); // by a new worker
});

test("what is wrong with a study is said in words", async () => {
  await page.getByRole("tab", { name: "Study" }).click();
  await button("Measure Table I and Fig. 5").click();
  await view().getByText("First drop a model, or choose one.").waitFor();
  await drop(onDisk("broken.glb", "glTF but no more"));
  await result().waitFor();
  assert.match(await headline(), /^Cannot study: /);
  await dropped(onDisk("cube.glb", glbFromObj(CUBE)));
  const hosts = page.getByLabel("Hosts", { exact: true }).and(page.locator("input"));
  await page.locator("#traced").getByText("Ranked anew").waitFor();
  await hosts.fill("9");
  await view().getByText("Give a whole number from 1 to 8.").waitFor();
  await hosts.fill("8");
  await button("Measure Table I and Fig. 5").click();
  await view().getByText(/^Not measured: /).waitFor(); // a cube has no thousand hosts
});

test("the mark just made is attacked, once and in a chain, by hand and over the map, and every copy can be had", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await mark();
  assert.equal(page.workers().length, 1);
  await button("Try to break it").click();
  const row = (title) => view().getByRole("row", { name: title });
  const done = (title) => row(title).and(page.locator('[data-state="done"]')).waitFor();
  assert.match(await row("As it was marked").textContent(), /✓ Found.*1 in 10\d+ln p −\d+/);
  assert.ok(await eventually(() => page.workers().length === 3), `${page.workers().length} workers`); // to mark, to attack, to read

  await button("Try noise 0.1 %").click();
  await done("Noise 0.1 %");
  await slide("noise", "0.5 %");
  await button("Try noise 0.5 %").click();
  await done("Noise 0.5 %");
  for (const [name, level] of [["crop", "30 %"], ["simplify", "50 %"], ["quantize", "10 bits"], ["noise", "0.05 %"]]) {
    await slide(name, level);
    await button(`Add ${name} ${level} to the chain`).click();
  }
  await button("Take noise 0.05 % out of the chain").click();
  const chain = "Crop 30 %, simplify 50 %, quantize 10 bits";
  await button("Try the chain").click();
  await done(chain);
  for (const title of ["Noise 0.1 %", "Noise 0.5 %", chain]) {
    const [came, , , , cost, faces] = await row(title).getByRole("cell").allTextContents();
    assert.match(came, /Found|Fits partly|Lost/);
    assert.match(cost, /^RMS 0\.\d+ %at most [\d.]+ %MSDM 0\.\d\d$/);
    assert.match(faces, /^[\d,]+\d+ %$/);
  }
  await view().getByText("Deliberate").first().click();
  await button("Try second mark by another key").click();
  await done("Second mark by another key");
  assert.match(await row("Second mark by another key").textContent(), /✓ Found/);
  await picture("broken");

  const copy = await saved(`Save the copy after ${chain}`);
  assert.equal(basename(copy), "demo.marked.crop-30-simplify-50-quantize-10-bits.glb");
  const again = new Uint8Array(readFileSync(copy));
  assert.ok(meshmark.inspect(again).triangles < 0.5 * meshmark.inspect(meshmark.demoModel()).triangles);
  await drop(copy);
  await done(basename(copy));
  assert.equal(await came(basename(copy)), await came(chain));
  await drop(onDisk("notes.txt", "nothing"));
  await view().getByText("Cannot open: There is no .glb or .gltf file in this.").waitFor();
  await drop(onDisk("nothing.glb", "glTF but no more"));
  await row("nothing.glb").getByText(/^Failed: /).waitFor();

  async function came(title) {
    return (await row(title).getByRole("cell").allTextContents())[0];
  }
});

test("the survival map fills in until it is cancelled, what is asked for comes first, and a cell shows its copy", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await mark();
  await button("Try to break it").click();
  const cells = view().locator(".cell");
  const filled = () => view().locator('.cell[data-state="done"]').count();
  await button("Fill the map").click();
  assert.ok(await eventually(async () => (await filled()) > 2), "nothing fills in");
  await slide("quantize", "10 bits");
  await button("Try quantize 10 bits").click();
  await view().getByRole("row", { name: "Quantize 10 bits" }).and(page.locator('[data-state="done"]')).waitFor();
  await view().locator(".map-state").getByRole("button", { name: "Cancel" }).click();
  await button("Fill the rest").waitFor();
  const some = await filled();
  assert.ok(some > 2 && some < (await cells.count()), `${some}`);
  await page.waitForTimeout(1000);
  assert.equal(await filled(), some, "it goes on");

  const tried = cells.first();
  assert.match(await tried.getAttribute("aria-label"), /^Reorder: found, by chance at most 1 in 10[⁰¹²³⁴⁵⁶⁷⁸⁹]+$/);
  assert.equal(await tried.textContent(), "✓");
  const [, right] = await canvas().all();
  const before = await right.screenshot();
  await tried.press("Enter");
  await view().getByRole("row", { name: "Reorder" }).waitFor();
  await view().locator(".pair", { hasText: "Reorder" }).waitFor();
  assert.ok(await eventually(async () => !(await right.screenshot()).equals(before)), "its copy is not shown");
  const untried = cells.and(page.locator('[data-state="cancelled"], [data-state="idle"]')).first();
  const title = (await untried.getAttribute("aria-label")).split(":")[0];
  await untried.click();
  await view().getByRole("row", { name: title, exact: true }).and(page.locator('[data-state="done"]')).or(view().getByRole("row", { name: `${title} seed 1` })).first().waitFor();

  await button("Another model").click();
  await view().getByRole("heading", { name: "Try to break your mark" }).waitFor();
  assert.ok(await eventually(() => page.workers().length <= 2), "the key's worker lives on");
});

test("the attacked copy and the marked one are seen by one eye", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await mark();
  await button("Try to break it").click();
  await button("Try similarity").click();
  await view().getByRole("row", { name: "Similarity" }).and(page.locator('[data-state="done"]')).waitFor();
  const [left, right] = await canvas().all();
  const look = () => Promise.all([left, right].map((side) => side.screenshot()));
  await left.press("0"); // so that the focus is seen as it will be
  await page.waitForTimeout(500);
  const first = await look();
  await right.press("ArrowLeft");
  assert.ok(await eventually(async () => (await look()).every((side, i) => !side.equals(first[i]))), "one of them stands still");
  await left.press("0");
  assert.ok(await eventually(async () => (await look()).every((side, i) => side.equals(first[i]))), "one of them does not come back");
});

test("what carries no mark of the key cannot be broken, and says so", async () => {
  await page.getByRole("tab", { name: "Break" }).click();
  await button("Begin").click();
  await view().getByText("First drop a model, or choose one.").or(page.getByText("Whose mark is it? Give a name.")).first().waitFor();
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await fillKey();
  await button("Begin").click();
  await result().getByText("There is nothing to break").waitFor();
  const { model } = meshmark.embed(meshmark.demoModel(), TAG, meshmark.deriveKey(OWNER, PASSPHRASE));
  await dropped(onDisk("mine.glb", model));
  await button("Begin").click();
  await view().getByRole("row", { name: "As it was marked" }).waitFor();
});

test("what a tag cannot be is said while it is typed", async () => {
  const tag = page.getByLabel("Tag", { exact: true });
  for (const [text, problem] of [
    ["a b", /no spaces/],
    ["a_b", /cannot hold “_”/],
    ["123456789", /at most 8/],
    ["abc.", /full stop/],
    ["a.b-C9", /^$/],
  ]) {
    await tag.fill(text);
    assert.match(await page.locator("#tag-error").textContent(), problem);
  }
});

test("names in files are text, never markup", async () => {
  const hostile = '<img src=x onerror="alert(1)">.glb';
  await drop(onDisk(hostile, withNames(meshmark.demoModel(), hostile)));
  await facts().getByText(hostile).waitFor();
  await mark();
  await page.getByRole("button", { name: `Download ${hostile.replace(".glb", ".marked.glb")}` }).waitFor();
  assert.equal(await page.locator("img").count(), 0);
});

test("the keyboard does all of it", async () => {
  const press = async (...keys) => {
    for (const key of keys) {
      await page.keyboard.press(key);
    }
  };
  const focused = () => page.evaluate(() => document.activeElement.textContent || document.activeElement.id);
  await press("Tab");
  assert.equal(await focused(), "Protect");
  await press("ArrowRight");
  assert.equal(await focused(), "Check");
  await press("Home", "Tab");
  assert.equal(await focused(), "Choose files");
  await press("Tab", "Tab", "Enter");
  await facts().getByText("demo.glb").waitFor();

  await canvas().focus();
  await preview().getByText("Tried with a key made for this preview.").waitFor(); // nothing else changes the view from here
  const first = await canvas().screenshot();
  const looksAsFirst = async () => (await canvas().screenshot()).equals(first);
  await press("ArrowLeft", "ArrowUp", "+");
  assert.ok(await eventually(async () => !(await looksAsFirst())), "the view did not move");
  await press("0");
  assert.ok(await eventually(looksAsFirst), "the view did not come back");

  await page.locator("#owner").focus();
  await page.keyboard.type(OWNER);
  await press("Tab");
  await page.keyboard.type(PASSPHRASE);
  await press("Tab", "Space");
  assert.equal(await page.locator("#passphrase").getAttribute("type"), "text");
  await press("Tab");
  await page.keyboard.type(TAG);
  await press("Enter");
  await result().waitFor();
  assert.match(await page.locator("#announcer").textContent(), /^Your mark is in the copy/);
});

test("every control has a name", async () => {
  await page.getByRole("button", { name: "Try the demo model" }).click();
  await facts().getByText("demo.glb").waitFor();
  await assertNamed();
  await page.getByRole("tab", { name: "Study" }).click();
  await page.locator("#traced").getByText("Ranked anew").waitFor();
  await assertNamed();
  await page.getByRole("tab", { name: "Protect" }).click();
  await mark();
  await button("Try to break it").click();
  await button("Try noise 0.1 %").click();
  await view().locator('tr[data-state="done"]').waitFor();
  await assertNamed();
});

async function assertNamed() {
  const controls = await page.locator("button:visible, input:visible, select:visible, canvas[tabindex]:visible").all();
  assert.ok(controls.length > 10);
  for (const control of controls) {
    const name = (await control.ariaSnapshot()).match(/"(.+)"/)?.[1];
    assert.ok(name, await control.evaluate((element) => element.outerHTML));
  }
}

for (const [name, options] of [
  ["desktop-light", {}],
  ["desktop-dark", { colorScheme: "dark" }],
  ["mobile", { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }],
  ["narrow", { viewport: { width: 320, height: 640 } }],
]) {
  test(`the page fits ${name}`, async () => {
    await open(options);
    await picture(`${name}-empty`);
    await page.getByRole("button", { name: "Try the demo model" }).click();
    await mark();
    await page.waitForTimeout(500);
    await picture(`${name}-marked`);
    await assertFits();
    await button("Try to break it").click();
    await button("Try noise 0.1 %").click();
    await view().locator('tr[data-state="done"]').waitFor();
    await page.waitForTimeout(500);
    await picture(`${name}-broken`);
    await assertFits();
  });
}

/** Moves an attack's slider to a level, wherever that is among them. */
async function slide(name, level) {
  const slider = page.getByRole("slider", { name: `Level of ${name}`, exact: true });
  const most = Number(await slider.getAttribute("max"));
  for (let i = 0; i <= most; i++) {
    await slider.fill(String(i));
    if ((await slider.getAttribute("aria-valuetext")) === level) {
      return;
    }
  }
  assert.fail(`${name} has no level ${level}`);
}

async function assertFits() {
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(overflow <= 0, `${overflow} px too wide`);
  assert.ok((await page.evaluate(() => innerWidth)) <= page.viewportSize().width, "the page is zoomed out to fit");
}

/** A torus with bumps, its triangles turned outwards. */
function torus() {
  const [around, across] = [48, 24];
  const positions = [];
  const indices = [];
  for (let i = 0; i < around; i++) {
    for (let j = 0; j < across; j++) {
      const [u, v] = [(i / around) * 2 * Math.PI, (j / across) * 2 * Math.PI];
      const radius = 0.4 + 0.02 * Math.sin(7 * u) * Math.cos(3 * v);
      positions.push(...[Math.cos(u) * (1 + radius * Math.cos(v)), Math.sin(u) * (1 + radius * Math.cos(v)), radius * Math.sin(v)].map(Math.fround));
      const corner = (a, b) => ((i + a) % around) * across + ((j + b) % across);
      indices.push(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1));
    }
  }
  return { positions, indices };
}

/** The same .glb with every node, mesh and material named so; the JSON chunk grows, the BIN chunk stays. */
function withNames(glb, name) {
  const jsonLength = Buffer.from(glb).readUInt32LE(12);
  const json = JSON.parse(Buffer.from(glb.subarray(20, 20 + jsonLength)).toString());
  for (const object of [json.nodes, json.meshes, json.materials].flatMap((list) => list ?? [])) {
    object.name = name;
  }
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
  const rest = Buffer.from(glb.subarray(20 + jsonLength));
  const head = Buffer.from(glb.subarray(0, 20));
  head.writeUInt32LE(20 + padded.length + rest.length, 8);
  head.writeUInt32LE(padded.length, 12);
  return Buffer.concat([head, padded, rest]);
}
