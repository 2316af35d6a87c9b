// The command line, timed: one process per call.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { glbFromObj } from "../tests/support.mjs";

const TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3";
const DONE = 0;
const NOT_FOUND = 1;

/** Runs the commands of `work` with the program at `cli`, in a temporary folder that goes with this process. */
export function prepareNative(cli, work) {
  const folder = mkdtempSync(join(tmpdir(), "meshmark-bench-"));
  process.once("exit", () => rmSync(folder, { recursive: true }));
  const file = (name, bytes) => {
    const path = join(folder, name);
    writeFileSync(path, bytes);
    return path;
  };
  const host = file("host.glb", work.embed.model);
  const marked = file("marked.glb", work.extract.model);
  const piece = file("piece.glb", work.compare.suspect);
  const triangle = file("triangle.glb", glbFromObj(TRIANGLE));
  const byKey = ["--key-file", file("key", work.embed.key)];
  const byPassphrase = ["--owner", work.key.owner, "--passphrase-file", file("passphrase", work.key.passphrase)];

  const commands = {
    /** The program does not time its key derivation: this is what a passphrase takes longer than a key file. */
    key() {
      const [derived, given] = [byPassphrase, byKey].map((key) => call(cli, ["extract", triangle, ...key], NOT_FOUND).outsideStages);
      return { ms: { key: derived - given } };
    },
    embed() {
      const { report } = call(cli, ["embed", host, join(folder, "output.glb"), ...byKey, "--tag", work.embed.tag], DONE);
      return { ms: report.ms, sha256: report.markedSha256 };
    },
    extract() {
      const { report } = call(cli, ["extract", marked, ...byKey], DONE);
      return { ms: report.ms, tag: report.tag };
    },
    compare() {
      const { report } = call(cli, ["extract", piece, "--original", host, ...byKey], DONE);
      return { ms: report.ms, tag: report.tag };
    },
  };
  return { run: (command) => commands[command]() };
}

/** The report, and the milliseconds that the process lived beyond its stages. */
function call(cli, args, expectedStatus) {
  const since = performance.now();
  const { status, stdout, stderr, error } = spawnSync(cli, args, { encoding: "utf8" });
  const lived = performance.now() - since;
  if (error) {
    throw error;
  }
  assert.equal(status, expectedStatus, stdout + stderr);
  const report = JSON.parse(stdout);
  return { report, outsideStages: Object.values(report.ms).reduce((sum, ms) => sum - ms, lived) };
}
