// The npm package in Chromium, timed in a worker: every command in a tab of its own, twice.
import { launch, serve } from "../tests/browser.mjs";

const www = new URL("../", import.meta.url);

/** Starts a browser, and a server on loopback, for the commands of `work`. */
export async function startChromium(work) {
  const server = await serve(www, { configFile: false, appType: "mpa", build: { outDir: "." } });
  const browser = await launch();
  return {
    version: browser.version(),
    /** The results of the first and of the second call in a new tab. */
    async run(command) {
      const context = await browser.newContext(); // a process of its own: no code compiled for another tab is there
      const page = await context.newPage();
      await page.route(`${server.origin}/`, (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>bench</title>" }));
      await page.goto(server.origin);
      const results = await page.evaluate(callTwice, { command, ...work[command] });
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
async function callTwice(request) {
  const worker = new Worker("/bench/worker.mjs", { type: "module" });
  const call = () =>
    new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.error ? reject(data.error) : resolve(data.result));
      worker.onerror = ({ message }) => reject(new Error(message));
      worker.postMessage(request);
    });
  return [await call(), await call()];
}
