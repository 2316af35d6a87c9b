// A copy for each buyer, made in Protect, and whose copy a model is, told in Check.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { strFromU8, unzipSync } from "fflate";
import { before } from "node:test";
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
  assert.match(strFromU8(files["ledger.csv"]), /^number,name,file,sha256,date\n7,"Grace, ""the first""",rock\.7\.glb,[0-9a-f]{64},/);

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

  writeFileSync(join(folder, "no.csv"), "name\nGrace\n");
  await page.getByLabel("Ledger of buyers").setInputFiles(join(folder, "no.csv"));
  await view().getByText("A line of this ledger has no number").waitFor();
});
