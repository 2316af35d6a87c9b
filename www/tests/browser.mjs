// An installed Chromium, and a server for it: the one that `vite preview` is.
import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { preview } from "vite";

const ARGUMENTS = [
  "--no-sandbox",
  "--use-angle=swiftshader",
  "--use-gl=angle",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  // What is not WebGL is drawn faster without a graphics processor than with one that is simulated.
  "--disable-gpu-rasterization",
  "--disable-gpu-compositing",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

export const SLOW = 120_000;

export function launch() {
  return chromium.launch({ executablePath: process.env.MESHMARK_CHROMIUM ?? installedChromium(), args: ARGUMENTS });
}

function installedChromium() {
  const folders = ["/usr/bin", ...process.env.PATH.split(delimiter)];
  const path = folders.map((folder) => join(folder, "chromium")).find(existsSync);
  if (!path) {
    throw new Error("No Chromium is installed here. Install it, or say in MESHMARK_CHROMIUM where it is.");
  }
  return path;
}

/** Serves a folder of Vite's (its `dist`), or with `options` any other one. */
export async function serve(folder, options = {}) {
  const server = await preview({ root: fileURLToPath(folder), logLevel: "silent", preview: { host: "127.0.0.1", port: 4180 }, ...options });
  return { origin: new URL(server.resolvedUrls.local[0]).origin, close: () => server.close() };
}
