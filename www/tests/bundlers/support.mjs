// The packed package, installed beside bundlers and frameworks: what `npm publish` would publish.
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

/** A file of this folder. */
export const path = (name) => fileURLToPath(new URL(name, import.meta.url));

export function run(command, args, options = {}) {
  return execFileSync(command, args, { cwd: path("."), encoding: "utf8", stdio: ["ignore", "pipe", "pipe"], ...options });
}

export function install() {
  installBundlers();
  installPackage();
}

/** What the lock file says, unless that is what is there. */
function installBundlers() {
  const [lock, installed] = [path("package-lock.json"), path("node_modules/.installed.json")];
  if (!existsSync(installed) || readFileSync(installed, "utf8") !== readFileSync(lock, "utf8")) {
    run("npm", ["ci", "--no-audit", "--no-fund"]);
    copyFileSync(lock, installed);
  }
}

/** What `npm publish` would publish, installed beside the bundlers, where every project finds it. */
function installPackage() {
  const packed = mkdtempSync(join(tmpdir(), "meshmark-packed-"));
  const [{ filename }] = JSON.parse(run("npm", ["pack", "--json", "--silent", "--pack-destination", packed], { cwd: path("../../meshmark") }).replace(/^[^[]*/, ""));
  run("npm", ["install", "--no-save", "--offline", "--no-audit", "--no-fund", join(packed, filename)]);
  rmSync(packed, { recursive: true });
}

/** Removes what an earlier run left. */
export function clean(folder) {
  rmSync(path(folder), { recursive: true, force: true });
}

/** Builds a page of Next's, as static files in `out`. */
export function buildNext(folder, option) {
  clean(`${folder}/.next`);
  clean(`${folder}/out`);
  run(process.execPath, [path("node_modules/next/dist/bin/next"), "build", path(folder), option], { env: { ...process.env, NEXT_TELEMETRY_DISABLED: "1" } });
}
