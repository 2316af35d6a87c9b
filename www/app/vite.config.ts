import { createHash } from "node:crypto";
import { readFile, readdir, writeFile } from "node:fs/promises";
import { join, relative, sep } from "node:path";
import { fileURLToPath } from "node:url";
import { defineConfig, type Plugin } from "vite";
import { CONTENT_SECURITY_POLICY } from "./csp.ts";

/** Response headers for every file, whoever serves them. */
const HEADERS = {
  "Content-Security-Policy": CONTENT_SECURITY_POLICY,
  "X-Content-Type-Options": "nosniff",
  "Referrer-Policy": "no-referrer",
};

/** The policy in the page itself, and the headers in a `_headers` file, which static hosts read; `vite preview` sends them itself. */
function securityHeaders(): Plugin {
  return {
    name: "security-headers",
    apply: "build",
    transformIndexHtml: () => [
      { tag: "meta", attrs: { "http-equiv": "Content-Security-Policy", content: CONTENT_SECURITY_POLICY }, injectTo: "head-prepend" },
    ],
    generateBundle() {
      const lines = Object.entries(HEADERS).map(([name, value]) => `  ${name}: ${value}\n`);
      this.emitFile({ type: "asset", fileName: "_headers", source: `/*\n${lines.join("")}` });
    },
  };
}

/** In the mode `early`, words in the place of the modules that come later: the page is there with its first one. */
function standIns(): Plugin {
  let isEarly = false;
  return {
    name: "stand-ins",
    enforce: "pre", // before Vite looks for the file
    config: (_, { mode }) => void (isEarly = mode === "early"),
    resolveId: (source) => (isEarly && /\/(research-wasm|wasm-full)\/\w+\.js$/.test(source) ? fileURLToPath(new URL("src/building.ts", import.meta.url)) : null),
  };
}

/** `sw.js` with the list of the build's files and a version that changes with any of them. */
function serviceWorker(): Plugin {
  return {
    name: "service-worker",
    apply: "build",
    async writeBundle({ dir: outDir = "" }) {
      const entries = await readdir(outDir, { recursive: true, withFileTypes: true });
      const paths = entries.filter((entry) => entry.isFile() && entry.name !== "_headers").map((entry) => join(entry.parentPath, entry.name));
      const hash = createHash("sha256");
      const files: string[] = [];
      for (const path of paths.sort()) {
        hash.update(await readFile(path));
        files.push(relative(outDir, path).split(sep).join("/").replace(/^index\.html$/, "./"));
      }
      const template = await readFile(new URL("src/sw.js", import.meta.url), "utf8");
      const code = template.replace("__VERSION__", hash.digest("hex").slice(0, 16)).replace('["__FILES__"]', JSON.stringify(files));
      await writeFile(join(outDir, "sw.js"), code);
    },
  };
}

export default defineConfig({
  base: "./", // can be hosted under any path
  appType: "mpa", // a missing file is a 404, not the page
  plugins: [standIns(), securityHeaders(), serviceWorker()],
  build: {
    target: "es2022",
    assetsInlineLimit: 0, // data: URIs would need holes in the policy
    chunkSizeWarningLimit: 800, // three.js, loaded with the first model
  },
  worker: { format: "es", plugins: () => [standIns()] },
  preview: { headers: HEADERS },
});
