// The shop's pages. A seller's upload is marked in their browser with their own key; each download is stamped for its buyer with the
// shop's key; an upload that is a copy that was sold here is refused, and traced.
import { readFileSync } from "node:fs";
import { createHash } from "node:crypto";
import { fileURLToPath } from "node:url";
import { Hono } from "hono";
import { bodyLimit } from "hono/body-limit";
import { html, raw } from "hono/html";
import { call } from "./meshmark.mjs";

const POLICY =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; img-src 'self'; style-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/** Uploads are not larger than this. */
const MOST_BYTES = 50e6;

/** So many sales are shown to moderators. */
const SHOWN_SALES = 50;

const TYPES = { js: "text/javascript", css: "text/css", svg: "image/svg+xml", wasm: "application/wasm" };

/** The shop: its database, and the key that stamps downloads. */
export function shop(db, key) {
  db.exec(`
    CREATE TABLE IF NOT EXISTS models (id INTEGER PRIMARY KEY, title TEXT NOT NULL, seller TEXT NOT NULL, plan BLOB NOT NULL);
    CREATE TABLE IF NOT EXISTS sales (number INTEGER PRIMARY KEY AUTOINCREMENT, model INTEGER NOT NULL REFERENCES models, buyer TEXT NOT NULL,
      date TEXT NOT NULL, sha256 TEXT NOT NULL DEFAULT '');`);
  const app = new Hono();

  app.use(async (context, next) => {
    await next();
    if (!context.res.headers.has("Content-Security-Policy")) {
      context.header("Content-Security-Policy", POLICY);
    }
    context.header("X-Content-Type-Options", "nosniff");
  });
  app.use(bodyLimit({ maxSize: MOST_BYTES, onError: (context) => context.html(page("Too large", html`<p>Files of up to ${MOST_BYTES / 1e6} MB are taken.</p>`), 413) }));

  app.get("/", (context) => {
    const models = db.prepare("SELECT id, title, seller FROM models ORDER BY id DESC").all();
    return context.html(
      page(
        "Models",
        html`${models.length === 0 ? html`<p>Nothing is for sale yet.</p>` : ""}
          <ul>
            ${models.map(
              ({ id, title, seller }) =>
                html`<li>
                  <h3>${title}</h3>
                  <p>by ${seller}</p>
                  <form method="post" action="/models/${id}/copies">
                    <label>Your name <input name="buyer" required maxlength="80" /></label><button>Buy and download</button>
                  </form>
                </li>`,
            )}
          </ul>
          <h2>Sell a model</h2>
          <form class="form" method="post" action="/models" enctype="multipart/form-data">
            <label>Title <input name="title" required maxlength="80" /></label>
            <label>Your name as the seller <input name="seller" id="seller" required maxlength="80" /></label>
            <label>
              Your passphrase <small>It makes your key, with your name, and stays in this page. Without it your mark cannot be found again.</small>
              <input type="password" id="passphrase" autocomplete="off" required />
            </label>
            <meshmark-protect name="model" tag="SHOP" required></meshmark-protect>
            <button>Sell</button>
          </form>`,
      ),
    );
  });

  app.post("/models", async (context) => {
    const { title, seller, model } = await context.req.parseBody();
    if (!(model instanceof File) || !title || !seller) {
      return context.html(page("Something is missing", html`<p>A model needs a title, a seller and a file.</p>`), 400);
    }
    const bytes = new Uint8Array(await model.arrayBuffer());
    const { tracing } = await traced(db, key, model.name, bytes);
    if (tracing.traced === "named" || tracing.traced === "nobody") {
      return context.html(page("Refused", html`<p>This is a copy of a model that is sold here. It was not published. If it is your own model, sell the file that you made it in, not a copy that was bought here.</p>`), 409);
    }
    const { plan } = await call("prepare", bytes, key, { strength: "balanced" });
    db.prepare("INSERT INTO models (title, seller, plan) VALUES (?, ?, ?)").run(title, seller, Buffer.from(plan));
    return context.redirect("/", 303);
  });

  app.post("/models/:id/copies", async (context) => {
    const { buyer } = await context.req.parseBody();
    const model = db.prepare("SELECT id, plan FROM models WHERE id = ?").get(context.req.param("id"));
    if (!model || !buyer) {
      return context.html(page("No copy", html`<p>There is no such model, or you gave no name.</p>`), 404);
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

  app.get("/moderation", (context) => {
    const sales = db.prepare(`SELECT number, buyer, title, date FROM sales JOIN models ON models.id = model ORDER BY number DESC LIMIT ${SHOWN_SALES}`).all();
    return context.html(
      page(
        "Moderation",
        html`<form class="form" method="post" action="/moderation" enctype="multipart/form-data">
            <label>A model that was found elsewhere <small>.glb. The answer is a page that you can print.</small><input type="file" name="suspect" accept=".glb" required /></label>
            <button>Whose copy is it?</button>
          </form>
          <h2>The last sales</h2>
          <p>The whole ledger, which the answer is read with: <a href="/moderation/ledger.csv">ledger.csv</a></p>
          <table>
            <thead><tr><th>Copy</th><th>Buyer</th><th>Model</th><th>Date</th></tr></thead>
            <tbody>
              ${sales.map(({ number, buyer, title, date }) => html`<tr><td>${number}</td><td>${buyer}</td><td>${title}</td><td>${date.slice(0, 10)}</td></tr>`)}
            </tbody>
          </table>`,
      ),
    );
  });

  app.get("/moderation/ledger.csv", (context) =>
    context.body(ledgerOf(db), 200, { "Content-Type": "text/csv; charset=utf-8", "Content-Disposition": "attachment" }),
  );

  // The statement is a page of its own, without scripts: to print, to keep, to send.
  app.post("/moderation", async (context) => {
    const { suspect } = await context.req.parseBody();
    if (!(suspect instanceof File)) {
      return context.html(page("Something is missing", html`<p>Choose a file.</p>`), 400);
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

  app.notFound((context) => context.html(page("Not found", html`<p>There is nothing here.</p>`), 404));
  app.onError((error, context) => context.html(page("This did not work", html`<p>${error.message}</p>`), error.code ? 422 : 500));
  return app;
}

/** All sales, as the command line's `trace --ledger` reads them. */
function ledgerOf(db) {
  const sales = db.prepare("SELECT number, buyer, date, sha256 FROM sales ORDER BY number").all();
  const lines = sales.map(({ number, buyer, date, sha256 }) => `${number},"${buyer.replaceAll('"', '""')}",${date},${sha256}\n`);
  return `number,name,date,sha256\n${lines.join("")}`;
}

/** Whose copy a file is, among all sales. */
async function traced(db, key, name, bytes) {
  const sales = db.prepare("SELECT number, buyer FROM sales").all();
  const stated = (role, name, bytes) => ({ role, name, bytes: bytes.length, sha256: createHash("sha256").update(bytes).digest("hex") });
  const statement = {
    owner: "the shop",
    date: new Date().toISOString(),
    files: [stated("Suspect", name, bytes), stated("Ledger", "ledger.csv", Buffer.from(ledgerOf(db)))],
    commands: ["meshmark trace SUSPECT --ledger ledger.csv --key-file data/key"],
    names: Object.fromEntries(sales.map(({ number, buyer }) => [number, buyer])),
  };
  const numbers = Float64Array.from(sales, ({ number }) => number);
  return { tracing: await call("trace", bytes, key, numbers, { statement }) };
}

/** The page's own files, and the package's: nothing else. */
function asset(name) {
  const own = ["shop.js", "shop.css", "icon.svg"];
  if (own.includes(name)) {
    return fileURLToPath(new URL(`public/${name}`, import.meta.url));
  }
  const [, path] = /^meshmark\/((?:dist|wasm|wasm-full)\/\w+\.(?:js|wasm))$/.exec(name) ?? [];
  return path && fileURLToPath(new URL(`../${path}`, import.meta.resolve("meshmark")));
}

const PAGES = [
  ["/", "Models"],
  ["/moderation", "Moderation"],
];

function page(title, content) {
  return html`<!doctype html>
    <html lang="en">
      <head>
        <meta charset="utf-8" />
        <meta name="viewport" content="width=device-width" />
        <title>${title} · A shop with meshmark</title>
        <link rel="icon" href="/assets/icon.svg" />
        <link rel="stylesheet" href="/assets/shop.css" />
        <script type="module" src="/assets/shop.js"></script>
      </head>
      <body>
        <header>
          <strong>A shop with meshmark</strong>
          ${PAGES.map(([path, name]) => html`<a href="${path}" ${raw(name === title ? 'aria-current="page"' : "")}>${name}</a>`)}
        </header>
        <main>
          <h1>${title}</h1>
          ${content}
        </main>
      </body>
    </html>`;
}
