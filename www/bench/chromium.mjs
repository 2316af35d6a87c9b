// The npm package in Chromium, timed in a worker: every command in a tab of its own, twice.
import { launch, serve } from "../tests/browser.mjs";

const www = new URL("../", import.meta.url);

/** Starts a browser and a server on loopback for the commands of `work`. */
export async function startChromium(work) {
  const server = await serve(www, { configFile: false, appType: "mpa", build: { outDir: "." } });
  const browser = await launch();
  return {
    version: browser.version(),
    /** The results of the first and of the second call in a new tab. */
    async run(command) {
      const context = await browser.newContext(); // its own process: no code compiled for another tab is there
      const page = await context.newPage();
      await page.route(`${server.origin}/`, (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>bench</title>" }));
      await page.goto(server.origin);
      const { model, ...rest } = work[command];
      if (model) {
        await page.route(`${server.origin}/model.glb`, (route) => route.fulfill({ body: Buffer.from(model) }));
      }
      const results = await page.evaluate(callTwice, { ...rest, command, key: rest.key && [...rest.key], hasModel: Boolean(model) });
      await context.close();
      return results;
    },
    async close() {
      await browser.close();
      await server.close();
    },
  };
}

/** Runs in the page. */
async function callTwice({ hasModel, key, ...request }) {
  const model = hasModel ? new Uint8Array(await (await fetch("/model.glb")).arrayBuffer()) : undefined;
  const worker = new Worker("/bench/worker.mjs", { type: "module" });
  const call = () =>
    new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.error ? reject(new Error(data.error)) : resolve(data));
      worker.onerror = ({ message }) => reject(new Error(message));
      worker.postMessage({ ...request, model, key: key && new Uint8Array(key) });
    });
  return [await call(), await call()];
}
