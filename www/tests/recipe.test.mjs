// The recipe for plain HTML (docs/RECIPES.md). Those that take a framework are tried in `npm run test:bundlers`.
import { after, before, test } from "node:test";
import * as meshmark from "meshmark";
import { launch, SLOW } from "./browser.mjs";
import { marksBeforeUpload, serveForm } from "./form.mjs";

let browser;

before(async () => {
  await meshmark.init();
  browser = await launch();
});

after(() => browser?.close());

test("plain HTML, without a bundler", { timeout: SLOW }, async () => {
  const recipes = new URL("bundlers/recipes/", import.meta.url);
  const server = await serveForm({ "/": new URL("html/", recipes), "/key.js": new URL("key.js", recipes), "/meshmark/": new URL("../meshmark/", import.meta.url) });
  try {
    await marksBeforeUpload(browser, server, meshmark, new Uint8Array(32).fill(9));
  } finally {
    server.close();
  }
});
