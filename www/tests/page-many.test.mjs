// Many models, many keys, and whatever else is dropped: several copies in one go, evidence in a model's place, files in any order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { before } from "node:test";
import { NodeIO } from "@gltf-transform/core";
import { unzipSync } from "fflate";
import * as meshmark from "meshmark";
import { assertFits, button, check, drop, dropped, facts, fillKey, headline, mark, NARROW, onDisk, page, PHONE, picture, result, saved, submitted, unseen, view } from "./page.mjs";
import { CUBE, glbFromObj, OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

let small;
let key;
let marked;
before(async () => {
  small = await smallModel();
  key = meshmark.deriveKey(OWNER, PASSPHRASE);
  marked = meshmark.embed(small, TAG, key).model;
});

unseen("several models are marked in one go, and are had in one archive with their reports", async () => {
  await drop(onDisk("a.glb", small), onDisk("cube.glb", glbFromObj(CUBE)), onDisk("b.glb", marked), onDisk("c.vrm", small));
  await view().getByText("All with the same answers above: a.glb, cube.glb, b.glb, and c.vrm. The first is shown.").waitFor();
  await fillKey();
  await page.getByLabel("Tag", { exact: true }).fill("LOT-1");
  await button("Mark these 4 models").click();
  const list = page.getByRole("region", { name: "Finished copies" });
  await list.getByRole("heading", { name: "2 of 4 models marked" }).waitFor();
  await list.getByText(/^Not marked: .*too small or too regular/).waitFor();
  await list.getByText(`Not marked: it carries your mark already, with the tag ${TAG}; drop it alone to mark it again.`).waitFor();
  await picture("many-marked");
  await assertFits();
  const archive = unzipSync(readFileSync(await saved("Download all 2 (.zip)")));
  assert.deepEqual(Object.keys(archive).sort(), ["a.marked.glb", "a.marked.report.json", "c.marked.report.json", "c.marked.vrm"]);
  assert.equal(meshmark.detect(archive["c.marked.vrm"], key).tag, "LOT-1");
  const { owner, asked, hostBytes, forecastSeed, report } = JSON.parse(Buffer.from(archive["a.marked.report.json"]).toString());
  assert.deepEqual([owner, asked, hostBytes, forecastSeed], [OWNER, { tag: "LOT-1", strength: "balanced", carriers: ["solid", "ring"] }, small.length, 1]);
  assert.equal(report.forecast.length, 9);
  await page.reload(); // nothing is left, so nothing is asked

  await dropped(onDisk("a.glb", small));
  await mark();
  const keyFile = readFileSync(await saved("Save key file"));
  assert.deepEqual(new Uint8Array(keyFile), key);
}, NARROW);

unseen("several suspects are checked in one go, with several keys, and evidence in a model’s place", async () => {
  await page.getByRole("tab", { name: "Check" }).click();
  await drop(onDisk("mine.glb", marked), onDisk("other.glb", small), onDisk("torn.glb", small.slice(0, 99)));
  await fillKey();
  await submitted("Check these 3 models");
  assert.equal(await headline(), "Your mark was found in 1 of 3 models");
  assert.match((await result().getByRole("listitem").allTextContents()).join("\n"), /^mine\.glbFound, with tag TEST-42; by chance at most 1 in 10\d+\nother\.glbNo evidence of this key\ntorn\.glbCannot check: /);
  await result().getByText("has a chance of at most 3 in 1,000,000,000").waitFor();
  await picture("many-checked");
  await assertFits();

  await dropped(onDisk("mine.glb", marked));
  await view().getByText("Check without sending the model").click();
  const evidence = await saved("Save evidence of this model");
  assert.equal(basename(evidence), "mine.mmev");
  await dropped(evidence);
  await view().getByText("Evidence has no picture").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
  await result().getByText("Evidence was read, which says what whoever measured it likes").waitFor();

  const hex = (bytes) => Buffer.from(bytes).toString("hex");
  const keys = onDisk("keys.txt", `# owners\n${hex(new Uint8Array(32).fill(1))} Somebody\n${hex(key)} ${OWNER}\n${hex(new Uint8Array(32).fill(2))}\n`);
  await dropped(onDisk("forged.glb", readFileSync(evidence)));
  await result().getByText(/^Cannot check: /).waitFor(); // it does not pass for a model
  await drop(evidence, onDisk("mine.glb", marked));
  await page.locator("label", { hasText: "Key file" }).first().click();
  await page.locator("input#key-file").setInputFiles(keys);
  await page.getByText("3 keys are in use.").waitFor();
  await submitted("Check these 2 models");
  assert.equal(await headline(), "2 marks found: 3 keys in 2 models");
  assert.match((await result().getByRole("listitem").allTextContents()).join("\n"), /^mine\.mmev, Test OwnerFound, with tag TEST-42; .*; read from evidence\nmine\.glb, Test OwnerFound, with tag TEST-42; by chance at most 1 in 10\d+\nmine\.mmev, SomebodyNo evidence of this key\nmine\.mmev, line 4No evidence/);
  await result().getByText("That there are 3 keys is charged in each chance.").waitFor();
}, PHONE);

unseen("files are taken in any order, and what is no model is told for what it is", async () => {
  const io = new NodeIO();
  const { json, resources } = await io.writeJSON(await io.readBinary(small), { basename: "scene" });
  json.images = [{ uri: "wood.png" }];
  const [bin] = Object.values(resources);
  await drop(onDisk("scene.gltf", JSON.stringify(json)));
  await result().getByText(/^Cannot mark: /).waitFor();
  await facts().getByText("without wood.png, which it names").waitFor();
  await drop(onDisk("scene.bin", bin));
  await facts().getByText(/3,\d+ vertices/).waitFor();
  const size = async () => parseInt((await facts().textContent()).match(/([\d,]+) kB/)[1].replace(",", ""), 10);
  assert.ok((await size()) * 1000 > bin.length, "its buffer is not counted");
  await drop(onDisk("wood.png", "no picture, but its name is right"));
  await facts().getByText("wood.png").waitFor({ state: "detached" });

  for (const [name, words] of [
    ["face.png", /“face\.png” is a picture\. If a \.gltf names it, drop both together/],
    ["tree.stl", /“tree\.stl” is a model, but not of glTF\. It can be checked as it is; to mark it, open it in a program such as Blender/],
    ["all.rar", /“all\.rar” is an archive\. Unpack it/],
  ]) {
    await drop(onDisk(name, "x"));
    await result().getByText(words).waitFor();
    assert.equal(await result().getByText("Code").count(), 0);
  }
  await dropped(onDisk("binary.gltf", small));
  await mark();
  await button("Download binary.marked.glb").waitFor();
});
