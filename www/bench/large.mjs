// What embedding takes as models grow: time, and the memory of the process.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { glbOf } from "../tests/support.mjs";
import { torus } from "./torus.mjs";

/** Vertices around and across of tori of 100,000 and of 1,000,000 vertices. */
const SIZES = [[400, 250], [1250, 800]];
/** The kernel keeps the peak, so only what grows in the last moments can be missed. */
const POLL_MS = 20;

/** By number of vertices, `ms` and `memoryBytes` of `runs` embeddings by the command line at `cli`. */
export async function embedLarge(cli, runs) {
  const folder = mkdtempSync(join(tmpdir(), "meshmark-bench-"));
  try {
    const key = join(folder, "key");
    writeFileSync(key, new Uint8Array(32).fill(1));
    const sizes = SIZES.map(([around, across]) => {
      const { positions, triangles } = torus(around, across);
      const host = join(folder, `${positions.length}.glb`);
      writeFileSync(host, glbOf({ positions, indices: triangles }));
      return { vertices: positions.length / 3, host, runs: [] };
    });
    for (let run = 0; run < runs; run++) {
      for (const { host, runs } of sizes) {
        runs.push(await call(cli, ["embed", host, join(folder, "output.glb"), "--key-file", key, "--tag", "BENCH"]));
      }
    }
    return sizes.map(({ vertices, runs }) => ({ vertices, runs }));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

async function call(cli, args) {
  const since = performance.now();
  const child = spawn(cli, args, { stdio: "ignore" });
  let memoryBytes = 0;
  const poll = setInterval(() => (memoryBytes = Math.max(memoryBytes, peakBytes(child.pid))), POLL_MS);
  const [status] = await once(child, "exit");
  clearInterval(poll);
  assert.equal(status, 0);
  return { ms: performance.now() - since, memoryBytes };
}

/** The most memory that a process has held; 0 where the system does not tell, or of a process that has ended. */
function peakBytes(pid) {
  try {
    return 1024 * Number(/VmHWM:\s*(\d+) kB/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))?.[1] ?? 0);
  } catch {
    return 0;
  }
}
