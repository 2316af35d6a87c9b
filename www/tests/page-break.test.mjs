// Break: a marked model and its key in, and what is left of the mark after whatever is done to it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { before } from "node:test";
import * as meshmark from "meshmark";
import { button, canvas, comeToLook, drop, dropped, fillKey, isSame, looks, mark, onDisk, onPage, page, picture, result, saved, slide, unseen, view, workersAre } from "./page.mjs";
import { OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

let small;
before(async () => {
  small = await smallModel();
});

unseen("the mark just made is attacked, once and in a chain, by hand and over the map, and every copy can be had", async () => {
  await dropped(onDisk("small.glb", small));
  await mark();
  await workersAre(1);
  await button("Try to break it").click();
  const row = (title) => view().getByRole("row", { name: title });
  const done = (title) => row(title).and(page.locator('[data-state="done"]')).waitFor();
  assert.match(await row("As it was marked").textContent(), /✓ Found.*1 in 10\d+/);
  await workersAre(3); // to mark, to attack, to read

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
    assert.match(cost, /^average 0\.\d+ %at most [\d.]+ %visible 0\.\d\d$/);
    assert.match(faces, /^[\d,]+\d+ %$/);
  }
  await view().getByText("Deliberate").first().click();
  await button("Try second mark by another key").click();
  await done("Second mark by another key");
  assert.match(await row("Second mark by another key").textContent(), /✓ Found/);
  await picture("broken");

  const copy = await saved(`Save the copy after ${chain}`);
  assert.equal(basename(copy), "small.marked.crop-30-simplify-50-quantize-10-bits.glb");
  const again = new Uint8Array(readFileSync(copy));
  assert.ok(meshmark.inspect(again).triangles < 0.5 * meshmark.inspect(small).triangles);
  await drop(copy);
  await done(basename(copy));
  assert.equal(await came(basename(copy)), await came(chain));
  await drop(onDisk("notes.txt", "nothing"));
  await view().getByText("Cannot open: There is no .glb, .gltf or .vrm file in this.").waitFor();
  await drop(onDisk("nothing.glb", "glTF but no more"));
  await row("nothing.glb").getByText(/^Failed: /).waitFor();

  async function came(title) {
    return (await row(title).getByRole("cell").allTextContents())[0];
  }
});

onPage("the survival map fills in until it is cancelled, what is asked for comes first, and a cell shows its copy", async () => {
  await dropped(onDisk("small.glb", small));
  await mark();
  await button("Try to break it").click();
  const cells = view().locator(".cell");
  const filled = () => view().locator('.cell[data-state="done"]').count();
  await button("Fill the map").click();
  await view().locator('.cell[data-state="done"]').nth(2).waitFor();
  await slide("quantize", "10 bits");
  await button("Try quantize 10 bits").click();
  await view().getByRole("row", { name: "Quantize 10 bits" }).and(page.locator('[data-state="done"]')).waitFor();
  await view().locator(".map-state").getByRole("button", { name: "Cancel" }).click();
  await button("Fill the rest").waitFor();
  const some = await filled();
  assert.ok(some > 2 && some < (await cells.count()), `${some}`);
  assert.equal(await view().locator('.cell[data-state="waiting"], .cell[data-state="running"]').count(), 0, "it goes on");

  const tried = cells.first();
  assert.match(await tried.getAttribute("aria-label"), /^Reorder: found, by chance at most 1 in 10[⁰¹²³⁴⁵⁶⁷⁸⁹]+$/);
  assert.equal(await tried.textContent(), "✓");
  const [, before] = await looks();
  await tried.press("Enter");
  await view().getByRole("row", { name: "Reorder" }).waitFor();
  await view().locator(".pair", { hasText: "Reorder" }).waitFor();
  await view().locator('.pair .came[data-level="green"]').waitFor();
  assert.ok(await comeToLook(([, now]) => !now.equals(before)), "its copy is not shown");
  const untried = cells.and(page.locator('[data-state="cancelled"], [data-state="idle"]')).first();
  const title = (await untried.getAttribute("aria-label")).split(":")[0];
  await untried.click();
  await view().locator(`.cell[aria-label^="${title}:"][data-state="done"]`).waitFor();
  await view().getByRole("row", { name: title }).first().waitFor();
  assert.equal(await filled(), some + 1, "it went on");

  await button("Another model").click();
  await view().getByRole("heading", { name: "Try to break your mark" }).waitFor();
  await workersAre(2); // the key's own is gone
});

onPage("the attacked copy and the marked one are seen by one eye", async () => {
  await dropped(onDisk("small.glb", small));
  await mark();
  await button("Try to break it").click();
  await button("Try similarity").click();
  await view().getByRole("row", { name: "Similarity" }).and(page.locator('[data-state="done"]')).waitFor();
  const [left, right] = await canvas().all();
  await left.press("0"); // so that the focus is seen as it will be
  const first = await looks();
  await right.press("ArrowLeft");
  assert.ok(await comeToLook((now) => now.every((side, i) => !side.equals(first[i]))), "one of them stands still");
  await left.press("0");
  assert.ok(await comeToLook((now) => isSame(now, first)), "one of them does not come back");
});

unseen("what carries no mark of the key cannot be broken, and says so", async () => {
  await page.getByRole("tab", { name: "Break" }).click();
  await button("Begin").click();
  await view().getByText("First drop a model, or choose one.").or(page.getByText("Whose mark is it? Give a name.")).first().waitFor();
  await dropped(onDisk("small.glb", small));
  await fillKey();
  await button("Begin").click();
  await result().getByText("There is nothing to break").waitFor();
  const { model } = meshmark.embed(small, TAG, meshmark.deriveKey(OWNER, PASSPHRASE));
  await dropped(onDisk("mine.glb", model));
  await button("Begin").click();
  await view().getByRole("row", { name: "As it was marked" }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Chain", "the focus is lost with the button");

  const rows = view().getByRole("row", { name: "Similarity" });
  for (const tries of [1, 2]) {
    await button("Try similarity").click();
    await rows.and(page.locator('[data-state="done"]')).waitFor();
    assert.equal(await rows.count(), 1, `${tries} tries with one seed`);
  }
  await button("Another").click();
  await button("Try similarity").click();
  await rows.nth(1).and(page.locator('[data-state="done"]')).waitFor();
});
