// Study: the paper's experiment on a model.
import assert from "node:assert/strict";
import * as meshmark from "meshmark";
import { assertNamed, button, comeToLook, drop, dropped, facts, headline, isSame, looks, onDisk, onPage, page, result, unseen, view, workersAre } from "./page.mjs";
import { CUBE, glbFromObj } from "./support.mjs";

onPage("the study begins with the model in Protect, in a worker that was not there before, and is measured until it is cancelled", async () => {
  await dropped(onDisk("demo.glb", meshmark.demoModel()));
  await workersAre(1);
  await page.getByRole("tab", { name: "Study" }).click();
  const traced = page.locator("#traced");
  await traced.getByText("Ranked anew").waitFor();
  await workersAre(2);
  assert.match(await facts().textContent(), /demo\.glb.*11,7\d\d triangles.*from 12,\d+ vertices · 2\d,\d+ triangles/);

  const found = async () => parseInt(await traced.locator("dd").first().textContent(), 10);
  const once = await found();
  assert.ok(once > 0 && once < 1000, `${once}`);
  await page.locator("label", { hasText: /^0$/ }).click();
  await traced.getByText("1,000 of 1,000").waitFor();
  await page.getByLabel("Ranking").selectOption("literal");
  await page.locator("label", { hasText: /^1$/ }).click();
  await page.waitForFunction((once) => parseInt(document.querySelector("#traced dd").textContent, 10) < once, once); // the literal ranking finds fewer

  const before = await looks();
  await button("Smoothed").click();
  await page.getByRole("combobox", { name: "Hosts", exact: true }).selectOption("fate");
  await view().getByText(/\d+ found again/).waitFor();
  assert.ok(await comeToLook((now) => !isSame(now, before)), "hosts are not shown");
  for (const [field, said] of [["stability", "place in the ranking"], ["gaussian", "1/units²"], ["mean", "1/units;"], ["deviation", "% of the diagonal"]]) {
    await page.getByLabel("Colours of the surface").selectOption(field);
    await view().locator(".legend", { hasText: said }).waitFor();
  }

  await assertNamed();

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

unseen("what is wrong with a study is said in words", async () => {
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
  await result().getByText(/^Cannot study: /).waitFor(); // a cube has no thousand hosts
});
