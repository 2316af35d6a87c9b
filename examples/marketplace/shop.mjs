// The shop's pages. A seller's upload is marked in their browser with their own key; each download is stamped for its buyer with the
// shop's key; an upload that is a copy that was sold here is refused, and traced.
import { readFileSync } from "node:fs";
import { createHash } from "node:crypto";
import { fileURLToPath } from "node:url";
import { Hono } from "hono";
import { html } from "hono/html";
import { call } from "./meshmark.mjs";

const POLICY =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; style-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/** Uploads are not larger than this. */
const MOST_BYTES = 50e6;

const TYPES = { js: "text/javascript", css: "text/css", wasm: "application/wasm" };

/** The shop: its database, and the key that stamps downloads. */
export function shop(db, key) {
  db.exec(`
    CREATE TABLE IF NOT EXISTS models (id INTEGER PRIMARY KEY, title TEXT NOT NULL, seller TEXT NOT NULL, plan BLOB NOT NULL);
    CREATE TABLE IF NOT EXISTS sales (number INTEGER PRIMARY KEY AUTOINCREMENT, model INTEGER NOT NULL REFERENCES models, buyer TEXT NOT NULL,
      date TEXT NOT NULL, sha256 TEXT NOT NULL DEFAULT '');`);
  const app = new Hono();

  app.use(async (context, next) => {
    if (Number(context.req.header("content-length") ?? 0) > MOST_BYTES) {
      return context.text("The file is too large.", 413);
    }
    await next();
    context.header("Content-Security-Policy", POLICY);
    context.header("X-Content-Type-Options", "nosniff");
  });

  app.get("/", (context) => {
    const models = db.prepare("SELECT id, title, seller FROM models ORDER BY id DESC").all();
    return context.html(
      page(
        "Models",
        html`<ul>
            ${models.map(
              ({ id, title, seller }) =>
                html`<li>
                  ${title}, by ${seller}
                  <form method="post" action="/models/${id}/copies">
                    <label>Your name <input name="buyer" required maxlength="80" /></label><button>Buy and download</button>
                  </form>
                </li>`,
            )}
          </ul>
          <h2>Sell a model</h2>
          <form method="post" action="/models" enctype="multipart/form-data">
            <label>Title <input name="title" required maxlength="80" /></label>
            <label>Your name <input name="seller" id="seller" required maxlength="80" /></label>
            <label>Your passphrase; it stays in this page <input type="password" id="passphrase" autocomplete="off" /></label>
            <meshmark-protect name="model" tag="SHOP" required></meshmark-protect>
            <button>Sell</button>
          </form>`,
      ),
    );
  });

  app.post("/models", async (context) => {
    const { title, seller, model } = await context.req.parseBody();
    if (!(model instanceof File) || !title || !seller) {
      return context.text("A model needs a title, a seller and a file.", 400);
    }
    const bytes = new Uint8Array(await model.arrayBuffer());
    const { tracing } = await traced(db, key, model.name, bytes);
    if (tracing.traced === "named" || tracing.traced === "nobody") {
      return context.html(page("Refused", html`<p>This is a copy of a model that is sold here. It was not published.</p>`), 409);
    }
    const { plan } = await call("prepare", bytes, key, { strength: "balanced" });
    db.prepare("INSERT INTO models (title, seller, plan) VALUES (?, ?, ?)").run(title, seller, Buffer.from(plan));
    return context.redirect("/", 303);
  });

  app.post("/models/:id/copies", async (context) => {
    const { buyer } = await context.req.parseBody();
    const model = db.prepare("SELECT id, plan FROM models WHERE id = ?").get(context.req.param("id"));
    if (!model || !buyer) {
      return context.text("There is no such model, or you gave no name.", 404);
    }
    // The number is written down before the copy exists: no copy is without a line in the ledger.
    const add = db.prepare("INSERT INTO sales (model, buyer, date) VALUES (?, ?, ?)");
    const number = Number(add.run(model.id, buyer, new Date().toISOString()).lastInsertRowid);
    const copy = await call("stamp", new Uint8Array(model.plan), number);
    db.prepare("UPDATE sales SET sha256 = ? WHERE number = ?").run(copy.report.markedSha256, number);
    return context.body(copy.model, 200, {
      "Content-Type": "model/gltf-binary",
      "Content-Disposition": `attachment; filename="model-${model.id}.glb"`,
    });
  });

  app.get("/moderation", (context) =>
    context.html(
      page(
        "Moderation",
        html`<form method="post" action="/moderation" enctype="multipart/form-data">
          <label>A model that was found elsewhere <input type="file" name="suspect" required /></label><button>Whose copy is it?</button>
        </form>`,
      ),
    ),
  );

  // The statement is a page of its own, without scripts: to print, to keep, to send.
  app.post("/moderation", async (context) => {
    const { suspect } = await context.req.parseBody();
    if (!(suspect instanceof File)) {
      return context.text("Choose a file.", 400);
    }
    const bytes = new Uint8Array(await suspect.arrayBuffer());
    const { tracing } = await traced(db, key, suspect.name, bytes);
    return new Response(tracing.statement, {
      headers: {
        "Content-Type": "text/html; charset=utf-8",
        "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
      },
    });
  });

  app.get("/assets/:name{.+}", (context) => {
    const name = context.req.param("name");
    const file = asset(name);
    const type = TYPES[name.split(".").at(-1)];
    return file && type ? context.body(readFileSync(file), 200, { "Content-Type": type }) : context.notFound();
  });

  app.onError((error, context) => context.html(page("This did not work", html`<p>${error.message}</p>`), error.code ? 422 : 500));
  return app;
}

/** Whose copy a file is, among all sales. */
async function traced(db, key, name, bytes) {
  const sales = db.prepare("SELECT number, buyer FROM sales").all();
  const statement = {
    owner: "the shop",
    date: new Date().toISOString(),
    files: [{ role: "Suspect", name, bytes: bytes.length, sha256: createHash("sha256").update(bytes).digest("hex") }],
    commands: ["meshmark trace SUSPECT --ledger LEDGER.csv --key-file data/key"],
    names: Object.fromEntries(sales.map(({ number, buyer }) => [number, buyer])),
  };
  const numbers = Float64Array.from(sales, ({ number }) => number);
  return { tracing: await call("trace", bytes, key, numbers, { statement }) };
}

/** The page's own files, and the package's: nothing else. */
function asset(name) {
  const own = ["shop.js", "shop.css"];
  if (own.includes(name)) {
    return fileURLToPath(new URL(`public/${name}`, import.meta.url));
  }
  const [, path] = /^meshmark\/((?:dist|wasm|wasm-codecs|wasm-copies)\/\w+\.(?:js|wasm))$/.exec(name) ?? [];
  return path && fileURLToPath(new URL(`../${path}`, import.meta.resolve("meshmark")));
}

function page(title, content) {
  return html`<!doctype html>
    <html lang="en">
      <head>
        <meta charset="utf-8" />
        <title>${title}</title>
        <link rel="stylesheet" href="/assets/shop.css" />
        <script type="module" src="/assets/shop.js"></script>
      </head>
      <body>
        <nav><a href="/">Models</a> <a href="/moderation">Moderation</a></nav>
        <h1>${title}</h1>
        ${content}
      </body>
    </html>`;
}
