// A copy for each buyer, made in Protect, and whose copy a model is, told in Check.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { strFromU8, unzipSync } from "fflate";
import { before } from "node:test";
import * as attacks from "../app/research-wasm/research.js";
import { button, check, dropped, fillKey, folder, headline, onDisk, onPage, page, picture, result, saved, view } from "./page.mjs";
import { smallModel } from "./support.mjs";

let small;
before(async () => {
  small = await smallModel();
});

onPage("copies are made for buyers, and a leaked one is traced", async () => {
  await dropped(onDisk("rock.glb", small));
  await view().getByText("One copy for each buyer").click();
  await button("Make the copies").click();
  await view().getByText("Give the names of the buyers.").waitFor();
  await page.getByLabel("Names of the buyers").fill('Grace, "the first"\n\nLin <b>x</b>\n');
  await page.getByLabel("Number of the first").fill("7");
  await fillKey();
  await button("Make the copies").click();
  await view().getByText("2 copies, each read back with its number").waitFor();
  await picture("copies");
  const files = unzipSync(readFileSync(await saved("Download all (.zip)")));
  assert.deepEqual(Object.keys(files).sort(), ["ledger.csv", "ledger.json", "rock.7.glb", "rock.8.glb"]);
  assert.match(strFromU8(files["ledger.csv"]), /^number,name,file,sha256,date,triangles\n7,"Grace, ""the first""",rock\.7\.glb,[0-9a-f]{64},[^,]*,\d+\n/);

  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(onDisk("leaked.glb", files["rock.8.glb"]));
  for (const ledger of ["ledger.csv", "ledger.json"]) {
    const path = join(folder, ledger);
    writeFileSync(path, files[ledger]);
    await page.getByLabel("Ledger of buyers").setInputFiles(path);
    await check();
    assert.equal(await headline(), "Whose copy it is");
    assert.deepEqual(await result().locator("li strong").allTextContents(), ["Lin <b>x</b>"]);
  }
  await picture("traced");
  const report = readFileSync(await saved("Save report (HTML)"), "utf8");
  assert.match(report, /Lin &lt;b&gt;x/);
  assert.doesNotMatch(report, /Grace/);
  const digest = createHash("sha256").update(files["ledger.json"]).digest("hex");
  assert.ok(report.includes(digest), "the ledger that it was read with");
  assert.match(report, /100 % of the [^<]+ that the ledger gives/);

  // A piece with other triangles says nothing alone: with the original it does, and is seen where it was cut out.
  const piece = attacks.attack(files["rock.8.glb"], ["crop 30 %", "simplify 50 %", "quantize 10 bits", "similarity"]);
  await dropped(onDisk("piece.glb", piece));
  await check();
  assert.equal(await headline(), "No evidence of this key");
  await page.getByLabel("Original, or record").setInputFiles(onDisk("rock.glb", small));
  await page.locator("#given-state").getByText("rock.glb").waitFor();
  await check();
  assert.equal(await headline(), "Whose copy it is");
  assert.deepEqual(await result().locator("li strong").allTextContents(), ["Lin <b>x</b>"]);
  assert.match(await result().locator(".answers dd").textContent(), /^Yes: /);
  assert.ok(await view().getByRole("slider", { name: /^Line between/ }).isVisible(), "the piece is not laid on the original");
  await picture("traced-with-original");
  const informed = readFileSync(await saved("Save report (HTML)"), "utf8");
  for (const words of ['<img alt="Three pictures', "--ledger ledger.json --original rock.glb", "Show that it is older.", digest]) {
    assert.ok(informed.includes(words), words);
  }
  await button("Check without it").click();

  writeFileSync(join(folder, "no.csv"), "name\nGrace\n");
  await page.getByLabel("Ledger of buyers").setInputFiles(join(folder, "no.csv"));
  await view().getByText("A line of this ledger has no number").waitFor();
});
