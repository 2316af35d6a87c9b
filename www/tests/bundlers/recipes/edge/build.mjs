import { copyFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

await build({
  entryPoints: ["worker.js"],
  bundle: true,
  format: "esm",
  outdir: "dist",
  external: ["*.wasm", "*.plan"], // the runtime's own modules
});
await copyFile(fileURLToPath(import.meta.resolve("meshmark/full.wasm")), "dist/full.wasm");
