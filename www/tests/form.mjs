// A form in which `<meshmark-protect>` stands: served, filled in by Chromium, and what it sent.
import assert from "node:assert/strict";
import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { SLOW } from "./browser.mjs";

const TYPES = { html: "text/html", js: "text/javascript", css: "text/css", wasm: "application/wasm", txt: "text/plain" };

/** Serves folders, each under a path, and keeps the form that was sent last in `sent`. */
export async function serveForm(folders) {
  const server = createServer(async (request, response) => {
    if (request.method === "POST") {
      const chunks = [];
      for await (const chunk of request) chunks.push(chunk);
      result.sent = await new Response(Buffer.concat(chunks), { headers: { "Content-Type": request.headers["content-type"] } }).formData();
      return response.writeHead(200, { "Content-Type": "text/html" }).end("<!doctype html><title>thanks</title>");
    }
    const { pathname } = new URL(request.url, "http://localhost");
    const [prefix, folder] = Object.entries(folders).findLast(([prefix]) => pathname.startsWith(prefix));
    const file = new URL(pathname === "/" ? "index.html" : pathname.slice(prefix.length), folder);
    if (!existsSync(file) || !statSync(file).isFile()) {
      return response.writeHead(404).end();
    }
    response.writeHead(200, { "Content-Type": TYPES[file.pathname.split(".").at(-1)] ?? "application/octet-stream" }).end(readFileSync(file));
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const result = { origin: `http://127.0.0.1:${server.address().port}`, sent: undefined, close: () => server.close() };
  return result;
}

/** Chooses a model in the served form, and sends it: what arrives has the mark, as `meshmark` reads it. */
export async function marksBeforeUpload(browser, server, meshmark, key) {
  const page = await browser.newPage();
  page.setDefaultTimeout(SLOW / 4);
  const said = [];
  page.on("pageerror", (error) => said.push(String(error)));
  try {
    await page.goto(server.origin);
    await page.getByLabel("Model to protect").setInputFiles({ name: "rock.glb", mimeType: "model/gltf-binary", buffer: Buffer.from(meshmark.demoModel()) });
    await page.getByText(/^(Protected\.|Not protected)/).waitFor();
    assert.match(await page.locator("meshmark-protect").getByRole("status").textContent(), /^Protected\./);
    await page.getByRole("button", { name: "Upload" }).click();
    await page.waitForURL(`${server.origin}/upload`);
    const sent = server.sent.get("model");
    assert.equal(sent.name, "rock.glb");
    assert.equal(meshmark.detect(new Uint8Array(await sent.arrayBuffer()), key).tag, "ADA-1");
    assert.deepEqual(said, []);
  } catch (error) {
    throw new Error([error.message, ...said].join("\n"), { cause: error });
  } finally {
    await page.close();
  }
}
