// Starts the shop: `npm start`. Its database and its key are in `data`, which is made with the first start.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { randomBytes } from "node:crypto";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { serve } from "@hono/node-server";
import Database from "libsql";
import { shop } from "./shop.mjs";

const folder = process.env.SHOP_DATA ?? fileURLToPath(new URL("data", import.meta.url));
mkdirSync(folder, { recursive: true, mode: 0o700 });
const keyFile = join(folder, "key");
if (!existsSync(keyFile)) {
  writeFileSync(keyFile, randomBytes(32), { mode: 0o600 });
}
const db = new Database(join(folder, "shop.db"));
const app = shop(db, new Uint8Array(readFileSync(keyFile)));
serve({ fetch: app.fetch, port: Number(process.env.PORT ?? 3000), hostname: "127.0.0.1" }, ({ port }) => {
  console.log(`The shop is open: http://localhost:${port}`);
});
