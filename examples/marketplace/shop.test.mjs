// The shop as people use it: a model is sold, two buy it, mix their copies and leak that; a moderator learns who.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import * as meshmark from "meshmark";
import { chromium } from "playwright-core";

const data = mkdtempSync(join(tmpdir(), "meshmark-shop-"));
let server;
let origin;
let browser;

before(async () => {
  await meshmark.init();
  server = spawn(process.execPath, ["server.mjs"], {
    cwd: fileURLToPath(new URL(".", import.meta.url)),
    env: { ...process.env, PORT: "0", SHOP_DATA: data },
    stdio: ["ignore", "pipe", "inherit"],
  });
  for await (const chunk of server.stdout) {
    [origin] = /http:\S+/.exec(chunk) ?? [];
    if (origin) break;
  }
  browser = await chromium.launch({ executablePath: process.env.MESHMARK_CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
});

after(async () => {
  await browser?.close();
  server?.kill();
  rmSync(data, { recursive: true, force: true });
});

const glb = (bytes) => new File([bytes], "copy.glb", { type: "model/gltf-binary" });

async function post(path, fields) {
  const body = new FormData();
  for (const [name, value] of Object.entries(fields)) {
    body.append(name, value);
  }
  return fetch(origin + path, { method: "POST", body, redirect: "manual" });
}

/** Where the positions of a .glb lie. */
function positions(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  const accessor = json.accessors[json.meshes[0].primitives[0].attributes.POSITION];
  const start = 28 + length + (json.bufferViews[accessor.bufferView].byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  return { view, start, count: 3 * accessor.count };
}

function averaged(a, b) {
  const mixed = a.slice();
  const [to, other] = [positions(mixed), positions(b)];
  for (let i = 0; i < to.count; i++) {
    const at = (place) => place.start + 4 * i; // their texts are not equally long: they hold bounds
    to.view.setFloat32(at(to), (to.view.getFloat32(at(to), true) + other.view.getFloat32(at(other), true)) / 2, true);
  }
  return mixed;
}

/** A page that minds what the browser complains of. */
async function opened(path, offences) {
  const page = await browser.newPage();
  page.setDefaultTimeout(120_000);
  page.on("pageerror", (error) => offences.push(String(error)));
  page.on("console", (message) => message.type() === "error" && offences.push(message.text()));
  await page.goto(origin + path);
  return page;
}

async function bought(page, buyer) {
  const offer = page.getByRole("listitem");
  await offer.getByLabel("Your name").fill(buyer);
  const [download] = await Promise.all([page.waitForEvent("download"), offer.getByRole("button").click()]);
  assert.equal(download.suggestedFilename(), "model-1.glb");
  return new Uint8Array(readFileSync(await download.path()));
}

/** What the moderators' page answers of a model. */
async function moderated(page, bytes) {
  await page.goto(`${origin}/moderation`);
  await page.getByLabel("A model that was found elsewhere").setInputFiles({ name: "leaked.glb", mimeType: "model/gltf-binary", buffer: Buffer.from(bytes) });
  await page.getByRole("button", { name: "Whose copy is it?" }).click();
  await page.getByText("What this does not prove").waitFor();
  return page.textContent("body");
}

test("a model is sold, bought, leaked and traced", { timeout: 300_000 }, async () => {
  const offences = [];
  const page = await opened("/", offences);
  await page.getByLabel("Title").fill("Rock <script>alert(1)</script>");
  await page.getByLabel("Your name as the seller").fill("Ada");
  await page.getByLabel("Your passphrase").fill("a slip of the keyboard");
  await page.getByLabel("Model to protect").setInputFiles({ name: "rock.glb", mimeType: "model/gltf-binary", buffer: Buffer.from(meshmark.demoModel()) });
  await page.getByText("Protected.").waitFor();
  // Another passphrase is another key: the model is marked again.
  await page.getByLabel("Your passphrase").fill("correct horse battery staple");
  await page.getByLabel("Your passphrase").blur();
  await page.getByText("Protected.").waitFor();
  await page.getByRole("button", { name: "Sell" }).click();
  await page.getByText("by Ada").waitFor();
  assert.match(await page.textContent("li"), /Rock <script>/);

  const grace = await bought(page, 'Grace "the Admiral"');
  const [lin, eve] = [await bought(page, "Lin"), await bought(page, "Eve")];
  // The seller's own mark is in every copy, below the shop's.
  const key = meshmark.deriveKey("Ada", "correct horse battery staple");
  assert.equal(meshmark.detect(grace, key).tag, "SHOP");
  assert.notDeepEqual(grace, lin);

  const statement = await moderated(page, averaged(grace, lin));
  assert.match(statement, /Grace "the Admiral"/);
  assert.match(statement, /Lin/);
  assert.doesNotMatch(statement, /Eve/);
  const ledger = await (await fetch(`${origin}/moderation/ledger.csv`)).text();
  assert.match(ledger, /^number,name,date,sha256\n1,"Grace ""the Admiral""",[\dT:.Z-]+,[0-9a-f]{64}\n2,"Lin",/);
  // Who sells it again is refused; who sells something else is not named.
  const again = await post("/models", { title: "Mine", seller: "Mallory", model: glb(eve) });
  assert.equal(again.status, 409);
  assert.match(await moderated(page, meshmark.demoModel()), /No evidence of this key/);
  assert.deepEqual(offences, []);
});

test("what is no model, or not there, is refused in words", async () => {
  assert.equal((await post("/models", { title: "x", seller: "y", model: glb("not a model") })).status, 422);
  assert.equal((await post("/models/99/copies", { buyer: "Grace" })).status, 404);
  assert.equal((await post("/models", { title: "x" })).status, 400);
  assert.equal((await fetch(`${origin}/assets/../server.mjs`)).status, 404);
  assert.equal((await fetch(`${origin}/assets/meshmark/dist/..%2f..%2fpackage.json`)).status, 404);
});
