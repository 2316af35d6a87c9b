// Times the command line and the module in Chromium by turns, and writes docs/PERFORMANCE.md. `cargo xtask bench` builds
// what is measured and calls this.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { basename } from "node:path";
import { setTimeout } from "node:timers/promises";
import { parseArgs } from "node:util";
import * as meshmark from "meshmark";
import * as attacks from "../app/research-wasm/research.js";
import { glbFromObj, sharedModel } from "../tests/support.mjs";
import { startChromium } from "./chromium.mjs";
import { embedLarge } from "./large.mjs";
import { prepareNative } from "./native.mjs";
import { markdown } from "./report.mjs";
import { torus } from "./torus.mjs";
import { readStages } from "./stages.mjs";

const OWNER = "Bench Owner";
const PASSPHRASE = "a passphrase for benchmarks only";
const TAG = "BENCH";
const LARGE_RUNS = 3;
const SETTLING_MS = 300; // a closed tab's processes take a moment to end; a native run in it was seen to take 20 % longer

const { values: options } = parseArgs({
  options: {
    runs: { type: "string" },
    cli: { type: "string" },
    module: { type: "string", multiple: true },
    "gzip-budget": { type: "string", multiple: true },
    stages: { type: "string" },
    "native-rustc": { type: "string" },
    "wasm-rustc": { type: "string" },
    output: { type: "string" },
  },
});

await meshmark.init();
const host = hostModel();
const key = meshmark.deriveKey(OWNER, PASSPHRASE);
const { model: marked, report } = meshmark.embed(host.bytes, TAG, key);
await attacks.default({ module_or_path: readFileSync(new URL("../app/research-wasm/research_bg.wasm", import.meta.url)) });
const piece = attacks.attack(marked, ["crop 50 %", "simplify 50 %", "similarity"]);
const work = {
  key: { owner: OWNER, passphrase: PASSPHRASE },
  embed: { model: host.bytes, tag: TAG, key },
  extract: { model: marked, key },
  compare: { suspect: piece, original: host.bytes, key },
  rank: { mesh: torus(200, 250), rankings: ["literal", "integrated", "collapse"] },
};

const large = await embedLarge(options.cli, LARGE_RUNS);
const native = prepareNative(options.cli, work);
const chromium = await startChromium(work);
const samples = { key: [], embed: [], extract: [], compare: [] };
const rankings = [];
try {
  for (let run = 1; run <= Number(options.runs); run++) {
    for (const command of Object.keys(samples)) {
      const [first, second] = await chromium.run(command);
      await setTimeout(SETTLING_MS);
      const sample = { native: native.run(command), first, second };
      Object.values(sample).forEach((result) => assertDone(command, result));
      samples[command].push(sample);
    }
    rankings.push(await rank());
    console.log(`run ${run} of ${options.runs}`);
  }
} finally {
  await chromium.close();
}

writeFileSync(
  options.output,
  markdown({
    samples,
    rankings,
    large,
    stages: readStages(options.stages),
    modules: options.module.map((path, i) => ({ name: basename(path, "_bg.wasm"), bytes: readFileSync(path), gzipBudget: Number(options["gzip-budget"][i]) })),
    host: { name: host.name, bytes: host.bytes.length, vertices: report.vertices, triangles: meshmark.inspect(host.bytes).triangles },
    rustc: { native: options["native-rustc"], wasm: options["wasm-rustc"] },
    chromium: chromium.version,
  }),
);

/** The bunny, where the development models are beside the repository; else the demo model. */
function hostModel() {
  const bunny = sharedModel("obj/stanford-bunny.obj", { skip: console.log });
  return bunny
    ? { name: "the Stanford bunny", bytes: glbFromObj(new TextDecoder().decode(bunny)) }
    : { name: "the generated demo model", bytes: meshmark.demoModel() };
}

/** The first and the second call in a new tab, in milliseconds by ranking. */
async function rank() {
  const results = await chromium.run("rank");
  const vertices = work.rank.mesh.positions.length / 3;
  results.forEach(({ ranked }) => ranked.forEach((number) => assert.equal(number, vertices)));
  return results.map(({ ms }) => ms);
}

/** Times of work that was not done, or done otherwise, say nothing. */
function assertDone(command, { sha256, tag, ms }) {
  const stages = { key: ["key"], embed: ["read", "embed", "write", "measure", "test", "forecast"], extract: ["read", "measure", "test"], compare: ["read", "measure", "test"] };
  assert.deepEqual(Object.keys(ms).sort(), stages[command].sort());
  assert.equal(sha256, command === "embed" ? report.markedSha256 : undefined);
  assert.equal(tag, ["extract", "compare"].includes(command) ? TAG : undefined);
}
