// How the page looks, by mouse and by keyboard, on large screens and small ones, with a network and without.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { assertFits, assertNamed, button, canvas, comeToLook, drawn, dropped, facts, headline, isSame, looks, mark, NARROW, onDisk, onPage, PHONE, context, page, picture, result, view } from "./page.mjs";
import { glbOf, OWNER, PASSPHRASE, RARELY, TAG } from "./support.mjs";

onPage("raking light shows the geometry's own normals, whatever seams and normals the file has", async () => {
  const { positions, indices } = torus();
  const split = indices.flatMap((corner) => positions.slice(corner * 3, corner * 3 + 3));
  const up = split.map((_, i) => Number(i % 3 === 1));
  const whole = onDisk("whole.glb", glbOf({ positions, indices }));
  const seams = onDisk("seams.glb", glbOf({ positions: split, indices: indices.map((_, i) => i), normals: up }));
  const normals = () => view().getByRole("group", { name: "Normals" });
  await page.getByRole("tab", { name: "Check" }).click();
  await dropped(whole);
  const surface = await looks();
  assert.ok((await middleOf(surface[0], 0.2)) < 180, "what has no material is lost on a light ground");
  await button("Raking light").press("Enter");
  assert.ok(await comeToLook((now) => !isSame(now, surface)), "the light is the same");
  const raking = await looks();
  await picture("raking");
  assert.equal(await normals().isVisible(), false, "this file has no normals");

  await dropped(seams);
  await drawn();
  assert.equal(await normals().isVisible(), false, "it is not their turn");
  await button("Raking light").press("Enter");
  assert.equal(await normals().isVisible(), true);
  assert.ok(await comeToLook((now) => isSame(now, raking)), "seams or the file's normals show");
  await button("File’s own").press("Enter");
  assert.ok(await comeToLook((now) => !isSame(now, raking)), "the file's normals do not show");
  await button("Surface").press("Enter");
  assert.equal(await normals().isVisible(), false);
});

onPage("after one visit the page works without a network, through a reload", async () => {
  await page.getByText("Ready to work offline").waitFor();
  await context.setOffline(true);
  await page.goto(new URL("index.html", page.url()).href);
  await page.getByRole("button", { name: "Try the demo model" }).click();
  await facts().getByText("demo.glb").waitFor();
  await drawn();
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  await page.getByRole("tab", { name: "Study" }).click();
  await page.locator("#traced").getByText("Ranked anew").waitFor();
  await page.getByRole("tab", { name: "Break" }).click();
  await button("Try noise 0.1 %").click();
  await view().locator('tr[data-state="done"]').waitFor();

  await context.setOffline(false);
  const worker = new URL("../app/dist/sw.js", import.meta.url);
  const script = readFileSync(worker, "utf8");
  writeFileSync(worker, `${script}// another version`);
  try {
    await page.evaluate(() => navigator.serviceWorker.ready.then((registration) => registration.update()));
    await page.getByText("A new version waits").waitFor();
  } finally {
    writeFileSync(worker, script);
  }
});

onPage("the keyboard does all of it", async () => {
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
  assert.match(await focused(), /^demo\.glb/, "the focus is lost with the button");

  await canvas().focus();
  await page.locator("#preview").getByText("Tried with a key made for this preview.").waitFor(); // nothing else changes the view from here
  const first = await looks();
  await press("ArrowLeft", "ArrowUp", "+");
  assert.ok(await comeToLook((now) => !isSame(now, first)), "the view did not move");
  await press("0");
  assert.ok(await comeToLook((now) => isSame(now, first)), "the view did not come back");

  await page.locator("#owner").focus();
  await page.keyboard.type(OWNER);
  await press("Tab");
  await page.keyboard.type(PASSPHRASE);
  await press("Tab", "Space");
  assert.equal(await page.locator("#passphrase").getAttribute("type"), "text");
  await press("Tab", "Tab"); // past the title of a work to the tag: what is shown is not typed twice
  await page.keyboard.type(TAG);
  await press("Enter");
  await result().waitFor();
  assert.match(await page.locator("#announcer").textContent(), /^Your mark is in the copy/);
  assert.equal(await focused(), "Your mark is in the copy");
  await press("Tab");
  assert.equal(await focused(), "Download demo.marked.glb");
  await Promise.all([page.waitForEvent("download"), press("Enter")]);
  assert.equal(await focused(), "Download demo.marked.glb");

  const tabTo = async (name) => {
    for (let i = 0; i < 50 && (await focused()) !== name; i++) {
      await press("Tab");
    }
    assert.equal(await focused(), name);
  };
  await tabTo("Check this copy");
  await press("Enter");
  assert.equal(await focused(), "Check");
  await tabTo("Check this model");
  await press("Enter");
  await result().waitFor();
  assert.equal(await focused(), "Your mark was found");
  await tabTo("Dismiss");
  await press("Enter");
  assert.equal(await focused(), "Check this model");
});

for (const [name, options] of [
  ["desktop-light", { skip: RARELY }],
  ["desktop-dark", { colorScheme: "dark" }],
  ["mobile", PHONE],
  ["narrow", { ...NARROW, skip: RARELY }],
]) {
  const fits = async () => {
    await picture(`${name}-empty`);
    await page.getByRole("button", { name: "Try the demo model" }).click();
    await mark();
    await drawn();
    await picture(`${name}-marked`);
    await assertFits();
    for (const seen of [result().getByRole("heading", { level: 2 }), button("Download demo.marked.glb")]) {
      const { y, height } = await seen.boundingBox();
      assert.ok(y >= 0 && y + height <= page.viewportSize().height, `what came of it is out of sight, at ${y} px`);
    }
    await assertNamed();
    if (options.forcedColors) {
      const [chosen, other] = await Promise.all(["Marked", "Original"].map((name) => button(name).evaluate((control) => getComputedStyle(control).backgroundColor)));
      assert.notEqual(chosen, other, "what is chosen is not seen");
    }
    if (options.hasTouch) {
      await assertTouch();
    }
    await button("Try to break it").click();
    await button("Try noise 0.1 %").click();
    await view().locator('tr[data-state="done"]').waitFor();
    const now = page.locator("#break-now", { hasText: /^Noise 0\.1 %Found/ });
    assert.equal(await now.isVisible(), page.viewportSize().width < 860, "on a small screen it is seen that something was tried");
    await drawn();
    await picture(`${name}-broken`);
    await assertFits();
    await assertNamed();
  };
  onPage(`the page fits ${name}`, fits, options);
}

/** One finger scrolls the page past the model; after a tap it turns the model. */
async function assertTouch() {
  await canvas().scrollIntoViewIfNeeded();
  const { x, y, width, height } = await canvas().boundingBox();
  const session = await context.newCDPSession(page);
  const touch = (type, ...touchPoints) => session.send("Input.dispatchTouchEvent", { type, touchPoints });
  const finger = (moved) => ({ x: x + width / 2, y: y + height / 2 - moved });
  const before = await page.evaluate(() => scrollY);
  await touch("touchStart", finger(0));
  for (const moved of [20, 40, 60, 80, 100]) {
    await touch("touchMove", finger(moved));
  }
  await touch("touchEnd");
  await page.waitForFunction((before) => scrollY > before + 20, before); // it gets past the model
  await canvas().scrollIntoViewIfNeeded();
  await canvas().tap();
  assert.equal(await canvas().evaluate((canvas) => getComputedStyle(canvas).touchAction), "none");
  await page.evaluate(() => document.activeElement.blur());
}

/** How light the picture is at its middle, or beside it by a share of its width: 0 to 255. */
function middleOf(png, aside) {
  return page.evaluate(
    async ([base64, aside]) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes]));
      const context = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(image.width * (0.5 + aside), image.height / 2, 1, 1).data[1];
    },
    [png.toString("base64"), aside],
  );
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
