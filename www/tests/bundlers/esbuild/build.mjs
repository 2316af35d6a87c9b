import { copyFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

await build({
  entryPoints: { main: "main.js", "meshmark-worker": "meshmark/worker" },
  bundle: true,
  format: "esm",
  outdir: "dist",
});
await copyFile(fileURLToPath(import.meta.resolve("meshmark/meshmark.wasm")), "dist/meshmark.wasm");
