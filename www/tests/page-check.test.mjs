// Check: a suspect and a key in, an answer out; and what cannot be read.
import assert from "node:assert/strict";
import { before } from "node:test";
import { check, drop, dropped, facts, headline, mark, onDisk, onPage, page, picture, pictureOf, result, submitted, unseen, view } from "./page.mjs";
import { smallModel } from "./support.mjs";

let small;
before(async () => {
  small = await smallModel();
});

onPage("a truncated file is refused in words, and a good one afterwards is not", async () => {
  const model = small;
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

unseen("how many of the things that may have been done to a copy were tried is said while they are", async () => {
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("small.glb", small));
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

unseen("each carrier's part is told by its name, with what it survives, in both views", async () => {
  await dropped(onDisk("two.glb", small));
  const read = async () => {
    await result().locator("summary").click();
    assert.deepEqual(await result().locator("tbody th").allTextContents(), ["Shape (SOLID)", "Connectivity (RING)"]);
    const hints = await result().locator(".carriers .hint").allTextContents();
    assert.match(hints.join(" "), /Shape \(SOLID\): .*Survives noise.* Connectivity \(RING\): .*Survives cropping/);
  };
  await mark();
  await read();
  await pictureOf(result(), "details-protect");
  await page.getByRole("button", { name: "Check this copy" }).click();
  await facts().getByText("two.marked.glb").waitFor();
  await submitted("Check this model");
  await read();
  await pictureOf(result(), "details-check");
});

unseen("compressed geometry is refused in words", async () => {
  const compressed = { asset: { version: "2.0" }, extensionsUsed: ["KHR_draco_mesh_compression"], extensionsRequired: ["KHR_draco_mesh_compression"] };
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("compressed.gltf", JSON.stringify(compressed)));
  await result().waitFor();
  assert.match(await headline(), /^Cannot check: .*(Draco|compress)/i);
});

unseen("files without a model are refused in words", async () => {
  await drop(onDisk("notes.txt", "nothing"));
  await result().waitFor();
  assert.equal(await headline(), "Cannot open: There is no .glb, .gltf or .vrm file in this.");
});
