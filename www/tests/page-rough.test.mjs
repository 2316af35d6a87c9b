// The page under rough use: slips, wrong files, second thoughts. A result says what it was made with, and nothing finished is lost.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before } from "node:test";
import * as meshmark from "meshmark";
import { assertFits, button, check, drop, dropped, fillKey, headline, hold, mark, NARROW, onDisk, page, PHONE, result, saved, submitted, unseen, view } from "./page.mjs";
import { OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

let small;
before(async () => {
  small = await smallModel();
});

const passphrase = () => page.locator("#passphrase");
const again = () => page.locator("#passphrase-again");
const tag = () => page.getByLabel("Tag", { exact: true });
const flag = () => view().locator(".result[data-verdict=found] .flag");
const download = () => view().getByRole("button", { name: "Download small.marked.glb" });
/** Waits until the browser keeps so many copies. */
const keeps = (number) =>
  page.waitForFunction(async (number) => {
    const done = (request) => new Promise((resolve) => (request.onsuccess = () => resolve(request.result)));
    const database = await done(indexedDB.open("meshmark"));
    const count = await done(database.transaction("copies").objectStore("copies").count());
    database.close();
    return count === number;
  }, number);
const focused = () => page.evaluate(() => document.activeElement.textContent);

unseen("a slip in the passphrase is seen before, and after: a copy says what it was made with, and that the form says something else", async () => {
  await dropped(onDisk("small.glb", small));
  await page.getByLabel("Owner’s name").fill(OWNER);
  await tag().fill(TAG);
  await passphrase().fill(" ");
  await page.getByText(/^Very weak: .* It is spaces alone\./).waitFor();
  await passphrase().fill("password1");
  await page.getByText(/^Very weak: at 10,000 guesses a second it is found in /).waitFor();
  await again().fill("password2");
  await button("Mark this model").click();
  await page.getByText("The two passphrases differ.").waitFor();
  await again().fill("password1");
  await submitted("Mark this model"); // weak, and not refused
  assert.equal(await headline(), "Your mark is in the copy");
  await result().getByText(`small.marked.glb carries the tag ${TAG} of ${OWNER}`).waitFor();
  assert.equal(await flag().isVisible(), false);

  await fillKey();
  assert.match(await flag().textContent(), /^The form says something else now: another key\./);
  await tag().fill("NEXT");
  assert.match(await flag().textContent(), /another key and the tag NEXT\./);
  await fillKey("password1");
  await tag().fill(TAG);
  assert.equal(await flag().isVisible(), false, "it is of what the form says again");
  await button("Show the passphrase").click();
  assert.equal(await again().isVisible(), false, "what is seen need not be typed again");
  await assertFits();
}, NARROW);

unseen("nothing that is finished disappears but by its owner’s act, and leaving asks first", async () => {
  const leave = async (answer) => {
    const [dialog] = await Promise.all([page.waitForEvent("dialog"), page.evaluate(() => setTimeout(() => location.reload()))]);
    assert.equal(dialog.type(), "beforeunload");
    await (answer ? Promise.all([page.waitForEvent("load"), dialog.accept()]) : dialog.dismiss());
  };
  await hold("inspect");
  await drop(onDisk("small.glb", small));
  await view().getByText("Opening small.glb …").waitFor();
  assert.equal(await page.locator("#announcer").textContent(), "Opening small.glb");
  await page.reload();
  await dropped(onDisk("small.glb", small));
  await mark();
  assert.equal(await focused(), "Your mark is in the copy");
  await drop(onDisk("notes.txt", "nothing"));
  await view().getByText("Cannot open: There is no .glb, .gltf or .vrm file in this.").waitFor();
  assert.ok(await download().isVisible(), "a wrong file takes the copy away");

  await hold("embed");
  await tag().fill("NEXT");
  await button("Mark this model").click();
  await drop(onDisk("tree.obj", "v 0 0 0"));
  await view().getByText("“tree.obj” is a model, but not of glTF.").waitFor();
  assert.ok(await button("Cancel").isVisible(), "a wrong file takes the progress away");
  await leave(false);
  await button("Cancel").click();
  await view().getByText("Cancelled. Nothing was changed.").waitFor();
  assert.equal(await focused(), "Mark this model");
  assert.ok(await download().isVisible(), "what is cancelled takes the copy before it away");

  await button("Mark this model").click();
  await dropped(onDisk("small.glb", small));
  await view().getByText("What was going on has been ended: another model came.").waitFor();
  assert.ok(await tag().isEnabled());

  await hold(null);
  await submitted("Mark this model");
  const copies = page.getByRole("region", { name: "Finished copies" }).getByRole("listitem").filter({ hasText: "small.marked.glb" });
  await copies.nth(1).waitFor();
  await keeps(2);
  await leave(true);
  await view().getByText(/not downloaded since\. This browser keeps it/).waitFor();
  assert.equal(await copies.count(), 2, "they do not survive a reload");
  await assertFits();
  await result().getByText(`small.marked.glb carries the tag NEXT of ${OWNER}`).waitFor();
  const stored = new Uint8Array(readFileSync(await saved(result().getByRole("button", { name: /^Download/ }))));
  assert.equal(await focused(), "Download small.marked.glb", "the focus is lost with the download");
  assert.equal(meshmark.detect(stored, meshmark.deriveKey(OWNER, PASSPHRASE)).tag, "NEXT");
  await copies.first().getByRole("button", { name: "Show small.marked.glb" }).click();
  await result().getByRole("button", { name: "Dismiss" }).click();
  await keeps(0);
  await page.reload();
  await page.getByText("Put your mark into a model").waitFor();
  assert.equal(await result().count(), 0, "what was downloaded or dismissed comes back");
}, PHONE);

unseen("tabs are entries of the history", async () => {
  const tab = (name) => page.getByRole("tab", { name });
  const isOpen = (name) => page.getByRole("tab", { name, selected: true }).waitFor();
  await tab("Check").click();
  await tab("Study").click();
  await page.goBack();
  await isOpen("Check");
  await page.reload();
  await isOpen("Check");
  await page.goBack();
  await isOpen("Protect");
  await page.goForward();
  await isOpen("Check");
});

unseen("an answer is about one model, key and tag, and a wrong tag is named for what it is", async () => {
  const key = meshmark.deriveKey(OWNER, PASSPHRASE);
  const { model } = meshmark.embed(small, "NFC", key);
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("suspect.glb", model));
  assert.equal(await again().isVisible(), false, "a passphrase that exists is typed once");
  await page.getByLabel(/Tag to look for/).fill("WRONG");
  await check();
  assert.equal(await headline(), "Your key’s mark, with tag NFC, not WRONG");
  const said = await result().textContent();
  assert.ok(!/fits partly|none read|Agreement0 %/.test(said), said);
  await page.getByLabel(/Tag to look for/).fill("");
  await result().getByText("The form says something else now: no tag to look for.").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
  await result().getByText(`suspect.glb, with the key of ${OWNER}.`).waitFor();
  await result().getByText("It does not say who made the model first").waitFor();
  await fillKey("another one");
  await result().getByText("The form says something else now: another key. This answer is to what it said before.").waitFor();
  await dropped(onDisk("other.glb", small));
  await result().getByText("the model other.glb and another key").waitFor();

  await page.getByRole("tab", { name: "Protect" }).click();
  await dropped(onDisk("suspect.glb", model));
  await fillKey();
  await tag().fill(TAG);
  await submitted("Mark this model");
  assert.equal(await headline(), "This model carries your mark already");
  await result().getByText("It carries your key’s mark, with the tag NFC. A second one, with the tag TEST-42, takes the place of that tag, and moves the surface as far again.").waitFor();
  await submitted("Mark it all the same");
  assert.equal(await headline(), "Your mark is in the copy");
});
