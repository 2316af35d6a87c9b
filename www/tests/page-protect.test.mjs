// Protect: a model and a key in, a marked copy out.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { before } from "node:test";
import { NodeIO } from "@gltf-transform/core";
import * as meshmark from "meshmark";
import { button, check, drop, dropped, facts, fillKey, folder, headline, mark, onDisk, onPage, page, picture, result, saved, savedReport, submitted, unseen, view } from "./page.mjs";
import { assertNoNewErrors, CUBE, glbFromObj, OWNER, PASSPHRASE, RARELY, sharedModel, smallModel, TAG } from "./support.mjs";

/** The cube as a thin rod: neither its shape nor its connectivity can hold a mark. */
const ROD = CUBE.replaceAll(/^v (\d) (\d) (\d)$/gm, (_, x, y, z) => `v ${x} ${y / 100} ${z / 100}`);
/** Longer than the page waits, in milliseconds, before it tries what was chosen. */
const REST_AND_MORE = 1000;

let small;
before(async () => {
  small = await smallModel();
});

const scale = async (unit) => (await view().locator(`[data-legend="${unit}"] span`).allTextContents()).join(" ");
const preview = () => page.locator("#preview");
/** The preview's RMS displacement, in percent of the diagonal. */
const previewRms = async () => parseFloat(await preview().locator("dd").first().textContent());

for (const [name, source, skip] of [
  ["demo.glb", () => meshmark.demoModel()],
  ["chr_knight.glb", (t) => sharedModel("gltf/chr_knight.glb", t), RARELY],
]) {
  onPage(`${name} is dropped, marked, downloaded, and its mark found with this key alone`, async (t) => {
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
    const report = await savedReport();
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
    const passedOn = (await savedReport()).result;
    assert.deepEqual(Object.keys(passedOn).sort(), ["caution", "foundIn", "input", "number", "reason", "sentence", "tag", "verdict"]);
    await picture(`none-${name}`);

    await page.getByLabel(/Tag to look for/).fill(TAG);
    await check();
    assert.equal(await headline(), "Your mark was found");
  }, { skip });
}

unseen("a work has a key of its own, and is found with its title alone", async () => {
  await dropped(onDisk("rock.glb", small));
  await page.getByLabel(/Title of the work/).fill("Rock");
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  await result().getByText("Checking a copy needs it, as it is written here.").waitFor();
  const copy = await saved(/^Download/);
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(copy);
  await check();
  assert.equal(await headline(), "Your mark was found");
  await page.getByLabel(/Title of the work/).fill("");
  await check();
  assert.equal(await headline(), "No evidence of this key");
});

unseen("a .gltf with its folder is dropped, marked, and downloaded as an archive", async () => {
  const io = new NodeIO();
  const { json, resources } = await io.writeJSON(await io.readBinary(small), { basename: "scene" });
  const scene = join(folder, "scene");
  mkdirSync(scene);
  writeFileSync(join(scene, "scene.gltf"), JSON.stringify(json));
  for (const [uri, bytes] of Object.entries(resources)) {
    writeFileSync(join(scene, uri), bytes);
  }
  await drop(scene);
  await facts().getByText("scene.gltf").waitFor();
  await view().getByText("There is no picture: this browser draws no 3D (it offers no WebGL 2). All else works without it.").waitFor();
  assert.equal(await view().locator(".toolbar button:enabled").count(), 0, "tools that do nothing can be pressed");
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const archive = await saved("Download scene.marked.zip");

  await page.getByRole("tab", { name: "Check" }).click();
  await drop(archive);
  await facts().getByText("scene.marked.gltf").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
});

unseen("a model that is too small is told so before and after it is tried, in numbers", async () => {
  const refused = /^No preview: the model is too small or too regular.* give \d+ distinct places.* a mark needs \d+; no carrier and no strength up to strong helps/;
  await dropped(onDisk("rod.glb", glbFromObj(ROD)));
  await preview().getByText(refused).waitFor();
  await mark();
  assert.match(await headline(), /^Cannot mark: .*too small or too regular.*\d/);
  await result().getByText("carrier.too-few-addresses").waitFor();
  await picture("too-small");

  await dropped(onDisk("cube.glb", glbFromObj(CUBE)));
  await preview().getByText(refused).waitFor();
  await mark();
  assert.match(await headline(), /^Cannot mark: .*\d/);
});

unseen("the carriers can be chosen, and one always stays", async () => {
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
  const { report } = await savedReport();
  assert.equal(await result().locator("dl div", { hasText: "Read from" }).locator("dd").first().textContent(), "Connectivity (RING)");
  assert.deepEqual(report.readBack.carriers.map(({ name, tag }) => [name, tag]), [["solid", null], ["ring", TAG]]);

  const [warning, download] = [result().locator(".warning"), result().getByRole("button", { name: /^Download/ })];
  assert.match(await warning.textContent(), /^It will not survive removing .* triangles\.$/);
  assert.ok((await warning.boundingBox()).y < (await download.boundingBox()).y, "the warning comes after the download");
  await picture("warning");
  await submitted("Mark again, strong");
  assert.equal((await savedReport()).asked.strength, "strong");

  await page.getByRole("button", { name: "Check this copy" }).click();
  await facts().getByText("demo.marked.glb").waitFor();
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().getByText("Read from the connectivity.").waitFor();
});

onPage("a strength is tried on the model before it is chosen, the last one wins, and what was tried is not done again", async () => {
  const embeddings = () => page.evaluate(() => asked.filter((name) => name === "embed").length);
  const tried = () => page.waitForFunction(() => document.querySelector("#preview")?.ariaBusy === "false");
  await page.clock.install(); // its time passes as any, until it is told to go faster
  await dropped(onDisk("small.glb", small));
  await preview().getByText("Tried with a key made for this preview.").waitFor();
  const balanced = await previewRms();
  for (const row of await preview().locator("li").allTextContents()) {
    assert.match(row, /\w.*(Survives|Maybe|Lost)$/);
  }
  assert.equal(await preview().locator("li").count(), 9);
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
  const { report } = await savedReport();
  assert.equal(report.tag, TAG);
  assert.ok(Math.abs(report.rmsRel * 100 - subtle) < 0.0005, `${report.rmsRel} and ${subtle} %`);

  await page.getByLabel("Tag", { exact: true }).fill("OTHER");
  await submitted("Mark this model");
  await result().locator("code", { hasText: "OTHER" }).first().waitFor();
  assert.equal(await embeddings(), count + 1, "another tag needs another copy");

  await page.getByLabel("Strength").selectOption("strong");
  await result().getByText("The form says something else now: the strength strong.").waitFor();
  await page.getByRole("tab", { name: "Check" }).click();
  const last = await embeddings();
  await page.clock.fastForward(REST_AND_MORE);
  assert.equal(await embeddings(), last, "something is tried behind another view");
});

unseen("work can be cancelled at any stage, and started again", async () => {
  await dropped(onDisk("small.glb", small));
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

unseen("what a person waits for goes on behind another view, with the form locked", async () => {
  await dropped(onDisk("small.glb", small));
  await fillKey();
  const tag = page.getByLabel("Tag", { exact: true });
  await tag.fill(TAG);
  const wasLocked = tag.evaluate((field) => new Promise((resolve) => field.form.addEventListener("submit", () => resolve(field.matches(":disabled")))));
  await button("Mark this model").click();
  assert.ok(await wasLocked, "what it is made with can be changed meanwhile");
  await page.getByRole("tab", { name: "Check" }).click();
  await page.getByRole("tab", { name: "Protect" }).click();
  await result().waitFor();
  assert.equal(await headline(), "Your mark is in the copy");
  assert.ok(await tag.isEnabled());
});

unseen("a made key file marks and finds, and a file of another length is refused", async () => {
  await page.getByRole("button", { name: "Try the demo model" }).click();
  await facts().getByText("demo.glb").waitFor();
  await page.locator("label", { hasText: "Key file" }).first().click();
  const keyFile = await saved("Make a key file");
  assert.equal(readFileSync(keyFile).length, 32);
  await page.getByLabel("Tag", { exact: true }).fill(TAG);
  await submitted("Mark this model");
  await page.getByRole("button", { name: "Check this copy" }).click();
  await page.locator("input#key-file").setInputFiles(onDisk("short.key", Buffer.alloc(31)));
  await page.getByText("A key file has exactly 32 bytes; this one has 31.").waitFor();
  await page.locator("input#key-file").setInputFiles(keyFile);
  await page.getByText("This key file is in use.").waitFor();
  await page.getByRole("button", { name: "Check this model" }).click();
  await result().waitFor();
  assert.equal(await headline(), "Your mark was found");
});

unseen("what a tag cannot be is said while it is typed", async () => {
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

onPage("names in files are text, never markup", async () => {
  const hostile = '<img src=x onerror="alert(1)">.glb';
  await drop(onDisk(hostile, withNames(small, hostile)));
  await facts().getByText(hostile).waitFor();
  await mark();
  await page.getByRole("button", { name: `Download ${hostile.replace(".glb", ".marked.glb")}` }).waitFor();
  assert.equal(await page.locator("img").count(), 0);
});

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
