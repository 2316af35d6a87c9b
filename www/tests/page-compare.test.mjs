// Check with the original, or with the record of marking it: both answers, and the suspect as it lies on the original.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before } from "node:test";
import * as meshmark from "meshmark";
import * as attacks from "../app/research-wasm/research.js";
import { assertFits, assertNamed, button, check, comeToLook, drop, dropped, fillKey, headline, hold, isSame, looks, NARROW, onDisk, onPage, page, PHONE, picture, result, saved, savedReport, unseen, view } from "./page.mjs";
import { CUBE, glbFromObj, OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

let original;
let piece;
let record;

before(async () => {
  original = await smallModel(); // it loads the attacks too
  await meshmark.initFull();
  const key = meshmark.deriveKey(OWNER, PASSPHRASE);
  const { model, report } = meshmark.embed(original, TAG, key, { strength: "strong" });
  record = meshmark.record(original, report, key, { owner: OWNER, date: "2026-11-29" });
  piece = attacks.attack(model, ["crop 30 %", "simplify 50 %", "quantize 10 bits", "similarity"]);
});

const given = () => page.getByLabel("Original, or record");
const state = () => page.locator("#given-state");
const answer = (question) => result().locator(".answers > div", { hasText: question }).locator("dd").textContent();
const slider = () => view().getByRole("slider", { name: /^Line between/ });
const tools = () => view().getByRole("group", { name: "Suspect and original" });

async function open(suspect, name = "suspect.glb") {
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk(name, suspect));
}

async function give(name, content) {
  await given().setInputFiles(onDisk(name, content));
  await state().getByText(name).waitFor();
}

onPage("a piece that was cut out, simplified and turned is found with its original, and seen lying on it", async () => {
  await open(piece, "piece.glb");
  await give("rock.glb", original);
  assert.equal(await state().textContent(), "rock.glb is taken for the original.");
  assert.equal(await tools().isVisible(), false, "there is nothing to see yet");
  await check();
  assert.equal(await headline(), "Your mark was found");
  assert.match(await answer("Is your mark in it?"), /^Yes, with the tag TEST-42\. .* at most 1 in 10\d+\.$/);
  assert.match(await answer("Is the shape the original’s?"), /^Yes: (9\d|100) % of the suspect lies on the original and shows [5-8]\d % of it\./);
  const middle = await looks();
  await picture("compared");
  await button("Suspect").press("Enter");
  assert.ok(await comeToLook((now) => !isSame(now, middle)), "the suspect is not seen alone");
  const alone = await looks();
  await button("On the original").press("Enter");
  assert.ok(await comeToLook((now) => isSame(now, middle)), "the original does not come back");
  assert.equal(await slider().getAttribute("aria-valuetext"), "50 % original, 50 % suspect");
  await slider().press("ArrowRight");
  assert.equal(await slider().getAttribute("aria-valuetext"), "51 % original, 49 % suspect");
  await slider().press("End");
  assert.ok(await comeToLook((now) => !isSame(now, middle)), "the line does not move");
  const whole = await looks();
  await slider().press("Home");
  assert.ok(await comeToLook((now) => !isSame(now, whole)), "the suspect looks as the original");

  await button("Difference").press("Enter");
  assert.equal(await slider().isVisible(), false);
  const legend = view().locator(".laid-legend");
  assert.match(await legend.textContent(), /in % of the original’s diagonal.*0 %.*% or more.*Not in the suspect/s);
  const difference = await looks();
  await picture("difference");
  await button("Evidence").press("Enter");
  assert.match(await legend.textContent(), /says for your mark.*1 ×.*× or more/s);
  assert.ok(await comeToLook((now) => !isSame(now, difference)), "the maps are one");
  await picture("evidence");
  await button("Suspect").press("Enter");
  assert.ok(await comeToLook((now) => isSame(now, alone)), "the suspect does not come back");

  const report = await savedReport();
  assert.deepEqual([report.kind, report.original, report.result.verdict, report.result.shape, report.result.tag], ["compare", "rock.glb", "found", "same", TAG]);
  assert.ok(!("overlay" in report.result), "maps that follow the key");
  const html = readFileSync(await saved("Save report (HTML)"), "utf8");
  for (const words of ["Your mark was found.", "The shape is the original’s.", '<img alt="Three pictures', "What this does not prove", "rock.glb", "--original rock.glb"]) {
    assert.ok(html.includes(words), words);
  }

  await button("Check without it").click();
  await result().getByText("The form says something else now: no original.").waitFor();
  await button("Dismiss").click();
  assert.equal(await tools().isVisible(), false, "a comparison that is gone is still seen");
});

onPage("a record that is dropped stands for the original", async () => {
  await open(piece, "piece.glb");
  await drop(onDisk("rock.meshmark.json", record));
  await state().getByText(`rock.meshmark.json is a record: owner ${OWNER}, tag ${TAG}, date 2026-11-29.`).waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
  assert.match(await answer("Is the shape the original’s?"), /^Yes: \d+ % of the suspect lies on the shape in the record/);
  await button("Difference").click();
  await view().getByText("A record keeps few triangles").waitFor();
  assert.equal((await savedReport()).record, "rock.meshmark.json");
});

unseen("a tag that is looked for is tested with the original, and another one is named", async () => {
  await open(piece, "piece.glb");
  await give("rock.glb", original);
  await page.getByLabel("Tag to look for").fill(TAG);
  await check();
  assert.equal(await headline(), "Your mark was found");
  await result().getByText(`looked at for the tag ${TAG}.`).waitFor();
  assert.match(await answer("Is your mark in it?"), /^Yes, with the tag TEST-42/);
  const report = await savedReport();
  assert.deepEqual([report.expected, report.result.tag], [TAG, TAG]);
  assert.ok(readFileSync(await saved("Save report (HTML)"), "utf8").includes(`meshmark verify piece.glb --tag ${TAG}`));
  await page.getByLabel("Tag to look for").fill("OTHER");
  await check();
  assert.equal(await headline(), `Your key’s mark, with tag ${TAG}, not OTHER`);
  assert.match(await answer("Is your mark in it?"), /^Yes, with the tag TEST-42/);
});

unseen("the mark and the shape are two answers: an unmarked copy, and another shape", async () => {
  await open(original);
  await give("rock.glb", original);
  await check();
  assert.equal(await headline(), "The original’s shape, without your mark");
  assert.match(await answer("Is your mark in it?"), /^No: /);
  assert.match(await answer("Is the shape the original’s?"), /^Yes: 100 % /);
  assert.ok(!("lnP" in (await savedReport()).result), "a number that follows the key");
  await dropped(onDisk("cube.glb", glbFromObj(CUBE)));
  await check();
  assert.equal(await headline(), "Another shape, without your mark");
  assert.match(await answer("Is the shape the original’s?"), /^No, it is another shape/);
  assert.equal(await tools().isVisible(), false);
});

unseen("a record that is damaged, or of another key, is refused by name", async () => {
  await open(piece);
  const sealed = JSON.parse(record);
  sealed.tag = "FORGED";
  await give("forged.meshmark.json", JSON.stringify(sealed));
  await check();
  assert.match(await headline(), /^Cannot check: “forged\.meshmark\.json”: the record is not as it was written/);
  await result().getByText("record.damaged").waitFor();
  await give("cut.meshmark.json", record.slice(0, record.length / 2));
  await check();
  assert.match(await headline(), /^Cannot check: “cut\.meshmark\.json”: this is no record/);
  await give("rock.meshmark.json", record);
  await check("another passphrase than that one");
  assert.match(await headline(), /^Cannot check: “rock\.meshmark\.json”: the record was made with another key/);
});

unseen("what is neither a model nor a record, and what cannot be compared, is said at the field", async () => {
  await open(piece);
  const problem = page.locator("#given-error");
  await given().setInputFiles(onDisk("notes.txt", "nothing"));
  await problem.getByText("There is no .glb, .gltf or .vrm file in this.").waitFor();
  await fillKey();
  await button("Check this model").click();
  assert.equal(await page.evaluate(() => document.activeElement.id), "given");
  await give("rock.glb", original);
  assert.equal(await problem.textContent(), "");
  await dropped(onDisk("piece.mmev", meshmark.measure(piece)));
  await button("Check this model").click();
  await problem.getByText(/one model is checked with one key/).waitFor();
});

unseen("a comparison can be cancelled", async () => {
  await open(piece);
  await give("rock.glb", original);
  await fillKey();
  await hold("compare");
  await button("Check this model").click();
  await view().getByRole("heading", { name: "Comparing suspect.glb with rock.glb" }).waitFor();
  await button("Cancel").click();
  await view().getByText("Cancelled. Nothing was changed.").waitFor();
});

for (const [name, options] of [["a phone", PHONE], ["a narrow screen with forced colours", NARROW]]) {
  onPage(`what lies on the original fits ${name}`, async () => {
    await open(piece);
    await give("rock.glb", original);
    await check();
    await looks();
    await assertFits();
    await assertNamed();
    await slider().scrollIntoViewIfNeeded();
    await picture(`compared-${name.split(" ")[1]}`);
    await button("Difference").click();
    await looks();
    await assertFits();
  }, options);
}
