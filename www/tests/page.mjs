// The built page in Chromium, as a person uses it: real files, real clicks, no network but its own origin.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import { launch, serve, SLOW } from "./browser.mjs";
import { OWNER, PASSPHRASE, repository, TAG } from "./support.mjs";

const DESKTOP = { width: 1280, height: 800 };
export const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
export const NARROW = { viewport: { width: 320, height: 640 }, forcedColors: "active" };

const pictures = new URL("test-output/", repository);
/** For files that are dropped and saved. */
export const folder = mkdtempSync(join(tmpdir(), "meshmark-page-"));
let server;
let browser;
export let context;
export let page;
/** What must stay empty: requests to elsewhere, policy violations, script errors, dialogs but the one before leaving. */
let offences;

before(async () => {
  mkdirSync(pictures, { recursive: true });
  await meshmark.init();
  server = await serve(new URL("../app", import.meta.url));
  browser = await launch();
});

after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, { recursive: true });
});

/** A test with the page just opened. To draw by software what nobody looks at takes seconds: see `unseen`. */
export function onPage(name, body, { skip = false, ...options } = {}) {
  test(name, { skip }, async (t) => {
    await open(options);
    try {
      await body(t);
      assert.deepEqual([...offences, ...(await page.evaluate(() => globalThis.violations))], []);
    } finally {
      await context.close();
    }
  });
}

/** The same in a browser without WebGL 2, for what has to do with no picture: the page goes without a preview. */
export function unseen(name, body, options = {}) {
  onPage(name, body, { ...options, webgl: false });
}

/** @param options Playwright's of a context; `webgl`: whether there is WebGL */
async function open({ webgl = true, ...options }) {
  offences = [];
  context = await browser.newContext({ viewport: DESKTOP, colorScheme: "light", ...options });
  context.on("request", (request) => {
    const url = new URL(request.url());
    if (url.origin !== server.origin && url.protocol !== "blob:") {
      offences.push(`request to ${request.url()}`);
    }
  });
  await context.addInitScript(() => {
    globalThis.violations = [];
    globalThis.asked = []; // what workers were asked to do
    globalThis.held = null; // what they do not come to hear of, so that it goes on until it is ended
    globalThis.workers = new Set(); // those that were not ended
    globalThis.Worker = class extends Worker {
      constructor(...args) {
        super(...args);
        workers.add(this);
      }
      postMessage(message, ...rest) {
        asked.push(message.name);
        if (message.name !== held) {
          super.postMessage(message, ...rest);
        }
      }
      terminate() {
        workers.delete(this);
        super.terminate();
      }
    };
    addEventListener("securitypolicyviolation", (event) => globalThis.violations.push(`${event.violatedDirective} ${event.blockedURI}`));
  });
  if (!webgl) {
    await context.addInitScript(() => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest);
      };
    });
  }
  page = await context.newPage();
  page.setDefaultTimeout(SLOW);
  page.on("pageerror", (error) => offences.push(`error ${error.message}`));
  page.on("dialog", (dialog) => dialog.type() !== "beforeunload" && offences.push(`dialog ${dialog.message()}`));
  page.on("console", (message) => /content security policy/i.test(message.text()) && offences.push(message.text()));
  await page.goto(server.origin);
}

/** Drops files or folders from disk on the middle of the page, as the desktop does. */
export async function drop(...paths) {
  const session = await context.newCDPSession(page);
  const data = { items: [], files: paths, dragOperationsMask: 1 };
  const { width, height } = page.viewportSize();
  for (const type of ["dragEnter", "dragOver", "drop"]) {
    await session.send("Input.dispatchDragEvent", { type, x: width / 2, y: height / 2, data });
  }
}

export function onDisk(name, bytes) {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
}

export const view = () => page.locator(".view:visible");
/** What was said or finished last. */
export const result = () => view().locator(".result").first();
export const headline = () => result().getByRole("heading", { level: 2 }).textContent();
export const facts = () => view().locator(".facts");
export const canvas = () => view().getByRole("application");
export const button = (name) => view().getByRole("button", { name, exact: true });
export const picture = (name) => page.screenshot({ path: fileURLToPath(new URL(`${name}.png`, pictures)) });
export const pictureOf = (locator, name) => locator.screenshot({ path: fileURLToPath(new URL(`${name}.png`, pictures)) });

/** From now on workers do not hear of a function: what calls it goes on until it is ended. `null`: they hear of all. */
export const hold = (name) => page.evaluate((name) => void (globalThis.held = name), name);

/** Waits until so many workers are at work. */
export const workersAre = (count) => page.waitForFunction((count) => workers.size === count, count);
/** Waits until models and eyes stand still in this view, and that is on the screen: a busy one is some frames behind. */
export async function drawn() {
  await page.waitForFunction(() => {
    const viewing = document.querySelector(".view:not([hidden]) .viewing");
    const canvases = [...viewing.querySelectorAll("canvas[role=application]")];
    return viewing.ariaBusy !== "true" && canvases.every(({ dataset }) => dataset.state === "still");
  });
  await page.evaluate(async () => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    for (const canvas of document.querySelectorAll(".view:not([hidden]) .viewing canvas[role=application]")) {
      canvas.getContext("webgl2").finish();
    }
    await frame().then(frame);
  });
}
const MOST_PICTURES = 50;

/** What is to be seen on each canvas of this view, once it stands still: the same in two pictures, one after the other. */
export async function looks() {
  let last = [];
  for (let i = 0; i < MOST_PICTURES; i++) {
    await drawn();
    const now = await Promise.all((await canvas().all()).map((one) => one.screenshot()));
    if (isSame(now, last)) {
      return now;
    }
    last = now;
  }
  return assert.fail("it does not stand still");
}

/** Whether what is to be seen comes to pass a test: on a busy machine pictures are behind. */
export async function comeToLook(isRight) {
  for (let i = 0; i < MOST_PICTURES; i++) {
    if (isRight(await looks())) {
      return true;
    }
  }
  return false;
}

/** Whether each canvas looks as it did. */
export function isSame(now, before) {
  return now.length === before.length && now.every((picture, i) => picture.equals(before[i]));
}

export async function fillKey(passphrase = PASSPHRASE) {
  await page.getByLabel("Owner’s name").fill(OWNER);
  await page.getByLabel("Passphrase", { exact: true }).and(page.locator("input:not([type=radio])")).fill(passphrase);
  const again = page.getByLabel("The same passphrase again");
  if (await again.isVisible()) {
    await again.fill(passphrase); // where a new one is chosen
  }
}

export async function mark(tag = TAG) {
  await fillKey();
  await page.getByLabel("Tag", { exact: true }).fill(tag);
  await submitted("Mark this model");
}

export async function check(passphrase = PASSPHRASE) {
  await fillKey(passphrase);
  await submitted("Check this model");
}

/** Presses the button of a form, and waits until what it begins has come to its end. */
export async function submitted(name) {
  await button(name).click();
  await view().locator(".working").waitFor({ state: "detached" });
  await result().waitFor();
}

/** Presses a button that saves a file, by its name or itself; returns where it is. */
export async function saved(control) {
  const button = typeof control === "string" || control instanceof RegExp ? page.getByRole("button", { name: control }) : control;
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

/** Presses the button that saves a report; returns what is in it. */
export async function savedReport() {
  return JSON.parse(readFileSync(await saved("Save report (JSON)"), "utf8"));
}

export async function dropped(path) {
  await drop(path);
  await facts().getByText(basename(path), { exact: true }).waitFor();
}

/** Nothing is wider than the window. */
export async function assertFits() {
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(overflow <= 0, `${overflow} px too wide`);
  assert.ok((await page.evaluate(() => innerWidth)) <= page.viewportSize().width, "the page is zoomed out to fit");
}

/** Each control that can be reached has a name. */
export async function assertNamed() {
  const seen = await page.locator("body").ariaSnapshot();
  const controls = seen.match(/^ *- (button|textbox|combobox|checkbox|radio|slider|spinbutton|tab|application)\b.*$/gm);
  assert.ok(controls.length > 10, seen);
  assert.deepEqual(controls.filter((control) => !/"[^"]+"/.test(control)), []);
}

/** Moves an attack's slider to a level, wherever that is among them. */
export async function slide(name, level) {
  const slider = page.getByRole("slider", { name: `Level of ${name}`, exact: true });
  const most = Number(await slider.getAttribute("max"));
  for (let i = 0; i <= most; i++) {
    await slider.fill(String(i));
    if ((await slider.getAttribute("aria-valuetext")) === level) {
      return;
    }
  }
  assert.fail(`${name} has no level ${level}`);
}
