// The form controls in Chromium, without a bundler, under a strict policy: in a form, in a frame, and what they send.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { after, before, beforeEach, test } from "node:test";
import * as meshmark from "meshmark";
import { launch } from "./browser.mjs";
import { smallModel } from "./support.mjs";

const packageFolder = new URL("../meshmark/", import.meta.url);
const POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; frame-src 'self'; form-action 'self'";
const KEY = new Uint8Array(32).fill(9);
const FORM = `<!doctype html><title>shop</title><script type="module" src="/page.js"></script>
<form method="post" action="/upload" enctype="multipart/form-data">
<meshmark-protect name="model" tag="ADA-1" required></meshmark-protect>
<meshmark-check name="verdict"></meshmark-check><button>Send</button></form>`;
// What is set before the elements are defined counts too, as where a framework renders first.
const PAGE = `for (const element of document.querySelectorAll("meshmark-protect, meshmark-check")) {
  element.ownerKey = () => new Uint8Array(32).fill(9);
  element.strings = { working: "One moment…" };
}
await import("/dist/elements.js");
globalThis.heard = [];
for (const name of ["meshmark-protected", "meshmark-verdict", "meshmark-error"]) document.addEventListener(name, (event) => heard.push([name, event.detail]));`;

let small;
let server;
let origin;
let browser;
let page;
let uploaded;
const offences = [];

before(async () => {
  small = await smallModel();
  server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const send = (type, body) => response.writeHead(200, { "Content-Type": type, "Content-Security-Policy": POLICY }).end(body);
    if (request.method === "POST") {
      const chunks = [];
      for await (const chunk of request) chunks.push(chunk);
      uploaded = await new Response(Buffer.concat(chunks), { headers: { "Content-Type": request.headers["content-type"] } }).formData();
      return send("text/html", "<!doctype html><title>thanks</title>");
    }
    const pages = { "/": ["text/html", FORM], "/page.js": ["text/javascript", PAGE], "/framed": ["text/html", `<!doctype html><iframe src="/"></iframe>`] };
    if (pages[pathname]) {
      return send(...pages[pathname]);
    }
    try {
      const bytes = readFileSync(new URL(`.${pathname}`, packageFolder));
      send(pathname.endsWith(".wasm") ? "application/wasm" : "text/javascript", bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  origin = `http://127.0.0.1:${server.address().port}`;
  browser = await launch();
});

after(async () => {
  await browser?.close();
  server?.close();
});

beforeEach(async () => {
  await page?.close();
  page = await browser.newPage();
  offences.length = 0;
  page.on("pageerror", (error) => offences.push(String(error)));
  page.on("console", (message) => message.type() === "error" && offences.push(message.text()));
  page.on("request", (request) => request.url().startsWith(origin) || request.url().startsWith("blob:") || offences.push(request.url()));
});

const file = (name, bytes) => ({ name, mimeType: "model/gltf-binary", buffer: Buffer.from(bytes) });
const heard = (frame, name) => frame.waitForFunction((name) => heard.find((event) => event[0] === name), name, { timeout: 120_000 });

test("a model is marked before the form sends it", { timeout: 240_000 }, async () => {
  await page.goto(origin);
  await page.getByRole("button", { name: "Send" }).click();
  assert.equal(new URL(page.url()).pathname, "/", "nothing is sent before there is a model");
  const protect = page.locator("meshmark-protect");
  assert.equal(await protect.evaluate((element) => element.validity.valueMissing), true);
  await page.getByLabel("Model to protect").setInputFiles(file("rock.glb", small));
  assert.equal(await protect.evaluate((element) => element.checkValidity()), false, "not while it works");
  assert.equal(await protect.getByRole("status").textContent(), "One moment…");
  await protect.getByRole("progressbar").waitFor();
  await heard(page, "meshmark-protected");
  assert.match(await protect.getByRole("status").textContent(), /^Protected\./);
  assert.equal(await protect.getByRole("progressbar").count(), 0);
  const [, detail] = await page.evaluate(() => heard.find(([name]) => name === "meshmark-protected"));
  assert.equal(detail.report.tag, "ADA-1");
  await page.getByLabel("Model to check").setInputFiles(file("rock.glb", meshmark.embed(small, "ADA-2", KEY).model));
  await heard(page, "meshmark-verdict");
  assert.match(await page.locator("meshmark-check").getByRole("status").textContent(), /^Your mark was found\./);
  await page.getByRole("button", { name: "Send" }).click();
  await page.waitForURL(`${origin}/upload`);
  const model = new Uint8Array(await uploaded.get("model").arrayBuffer());
  assert.equal(uploaded.get("model").name, "rock.glb");
  assert.equal(meshmark.detect(model, KEY).tag, "ADA-1");
  assert.equal(uploaded.get("verdict"), "found");
  assert.deepEqual(offences, []);
});

test("what cannot be marked is said, and not sent", { timeout: 120_000 }, async () => {
  await page.goto(origin);
  const protect = page.locator("meshmark-protect");
  await protect.evaluate((element) => (element.strings = { failed: "Pas protégé : {message}", choose: () => "Modèle à protéger" }));
  const field = page.getByLabel("Modèle à protéger");
  await field.setInputFiles(file("not.glb", "<script>alert(1)</script>"));
  await heard(page, "meshmark-error");
  assert.match(await protect.getByRole("status").textContent(), /^Pas protégé : ./);
  assert.deepEqual(await field.evaluate((input) => [input.ariaInvalid, input.required, input.getRootNode().getElementById(input.getAttribute("aria-describedby")).role]), ["true", true, "status"]);
  assert.equal(await protect.evaluate((element) => element.checkValidity()), false);
  assert.equal(await protect.evaluate((element) => new FormData(element.form).get("model")), null);
  await protect.evaluate((element) => element.form.reset());
  assert.equal(await protect.getByRole("status").textContent(), "");
  await protect.evaluate((element) => (element.ownerKey = undefined));
  await field.setInputFiles(file("rock.glb", small));
  await page.waitForFunction(() => heard.filter(([name]) => name === "meshmark-error").length === 2);
  assert.match(await protect.getByRole("status").textContent(), /No key was given/);
  await protect.evaluate((element) => ((element.ownerKey = new Uint8Array(32).fill(9)), void element.again()));
  await heard(page, "meshmark-protected");
  await protect.evaluate((element) => element.toggleAttribute("disabled"));
  assert.equal(await field.isDisabled(), true);
  assert.equal(await protect.evaluate((element) => new FormData(element.form).get("model")), null, "what is disabled sends nothing");
  assert.deepEqual(offences, []);
});

test("a server can import them to render a page", async () => {
  const { MeshmarkProtect } = await import("meshmark/elements");
  assert.equal(typeof MeshmarkProtect, "function");
});

test("the keyboard reaches them, and stops at what is missing", { timeout: 60_000 }, async () => {
  await page.goto(origin);
  await page.waitForFunction(() => globalThis.heard);
  const focused = () => page.evaluate(() => [document.activeElement.localName, document.activeElement.shadowRoot?.activeElement?.type]);
  await page.keyboard.press("Tab");
  assert.deepEqual(await focused(), ["meshmark-protect", "file"]);
  await page.keyboard.press("Tab");
  assert.deepEqual(await focused(), ["meshmark-check", "file"]);
  await page.getByRole("button", { name: "Send" }).press("Enter");
  assert.deepEqual(await focused(), ["meshmark-protect", "file"], "the browser leads to the field that is missing");
});

test("what was not found is not shown as good news", { timeout: 120_000 }, async () => {
  await page.goto(origin);
  await page.waitForFunction(() => globalThis.heard);
  await page.getByLabel("Model to check").setInputFiles(file("rock.glb", small));
  await heard(page, "meshmark-verdict");
  const status = page.locator("meshmark-check").getByRole("status");
  assert.match(await status.textContent(), /^No evidence of this key\./);
  const colours = await status.evaluate((status) => [getComputedStyle(status).color, getComputedStyle(status.getRootNode().host).color]);
  assert.equal(colours[0], colours[1]);
});

test("they work in a frame", { timeout: 240_000 }, async () => {
  await page.goto(`${origin}/framed`);
  const frame = page.frames()[1];
  await frame.waitForFunction(() => globalThis.heard);
  await frame.getByLabel("Model to protect").setInputFiles(file("rock.glb", small));
  await heard(frame, "meshmark-protected");
  assert.deepEqual(offences, []);
});
