// What becomes of real files on their way: each is compressed as people do, marked by the command line, validated, opened by three.js in Chromium,
// and looked for again after what programs do to a copy. It prints a table. `MESHMARK_CLI` names the command line.
//
// usage: node files.mjs MODEL...    .glb or .gltf
import { spawnSync } from "node:child_process";
import { randomBytes } from "node:crypto";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { unpartition } from "@gltf-transform/functions";
import { openShop } from "./tests/in-chromium.mjs";
import { COMPRESSIONS, io, partsOf, ready, WAYS } from "./tests/programs.mjs";
import { validationErrors } from "./tests/validator.mjs";

if (!process.env.MESHMARK_CLI || process.argv.length < 3) {
  console.error("usage: MESHMARK_CLI=.../meshmark node files.mjs MODEL...    (cargo build --release --package meshmark-cli makes target/release/meshmark)");
  process.exit(2);
}
const folder = mkdtempSync(join(tmpdir(), "meshmark-files-"));
const KEY = ["--key-file", join(folder, "key")];
const WITHIN = 1.03;
const EXPORTED = "exported by three.js";
let shop;

/** What the command line prints. */
function meshmark(...args) {
  const { stdout, stderr, error } = spawnSync(process.env.MESHMARK_CLI, args, { encoding: "utf8", cwd: folder });
  if (error || !stdout) {
    throw error ?? new Error(stderr);
  }
  return JSON.parse(stdout);
}

function stored(place, { model, files }) {
  const root = join(folder, place);
  rmSync(root, { recursive: true, force: true });
  mkdirSync(root);
  writeFileSync(join(root, "model.glb"), model);
  Object.entries(files).forEach(([name, bytes]) => writeFileSync(join(root, name), bytes));
  return join(place, "model.glb");
}

const size = ({ model, files }) => [model, ...Object.values(files)].reduce((sum, { length }) => sum + length, 0);

/** What a program makes of a model, or `null` where it refuses it. */
const made = (program, model) => program(model).catch(() => null);

function isFound(made) {
  return ["found", "present"].includes(meshmark("extract", stored("suspect", made), ...KEY).verdict);
}

/** The row of a file and a compression; `null` where the compressor refuses the file. */
async function row(compress, plain) {
  const host = await made(compress, plain);
  if (!host) {
    return null;
  }
  const report = meshmark("embed", stored("host", host), "marked/model.glb", ...KEY, "--tag", "FILES");
  if (report.error) {
    return { refused: report.error.code };
  }
  const read = (name) => new Uint8Array(readFileSync(join(folder, "marked", name)));
  const copy = { model: read("model.glb"), files: Object.fromEntries(report.stored.written.slice(1).map((name) => [name, read(name)])) };
  const names = (model) => (partsOf(model).json.extensionsUsed ?? []).filter((name) => name.endsWith("_compression")).join();
  const before = await validationErrors(host.model, host.files);
  const errors = (await validationErrors(copy.model, copy.files)).filter((error) => !before.includes(error));
  const [shownHost, shown] = [await made(shop.show, host), await made(shop.show, copy)];
  const isShown = shown !== null && shown.triangles === shownHost?.triangles && Math.abs(shown.seen / shownHost.seen - 1) < 0.05;
  const ways = { [EXPORTED]: shown && isFound({ model: shown.exported, files: {} }) };
  for (const [name, way] of Object.entries(WAYS)) {
    const suspect = await made(way, copy);
    ways[name] = suspect && isFound(suspect);
  }
  return { errors, isShown, ratio: size(copy) / size(host), isCompressed: names(copy.model) === names(host.model), isFragile: report.isFragile, ways };
}

const count = (list, is) => list.filter(is).length;
const percent = (ratio) => `${((ratio - 1) * 100).toFixed(1)} %`;
const cells = (...values) => console.log(`| ${values.join(" | ")} |`);
/** `found of tried`, and how many of those that were lost the report had called fragile. */
function found(rows, name) {
  const tried = rows.filter(({ ways }) => ways[name] !== null);
  const lost = tried.filter(({ ways }) => !ways[name]);
  const fragile = count(lost, ({ isFragile }) => isFragile);
  return tried.length === 0 ? "–" : `${tried.length - lost.length} of ${tried.length}${fragile > 0 ? ` (${fragile} fragile)` : ""}`;
}

writeFileSync(join(folder, "key"), randomBytes(32));
await ready();
shop = await openShop();
const plains = [];
for (const path of process.argv.slice(2)) {
  // As one .glb, and without textures, so that sizes are of geometry.
  const document = await io.read(path);
  document.getRoot().listTextures().forEach((texture) => texture.dispose());
  await document.transform(unpartition());
  plains.push({ name: path.endsWith(".gltf") ? basename(dirname(path)) : basename(path), model: await io.writeBinary(document), files: {} });
}
const ways = [EXPORTED, ...Object.keys(WAYS)];
cells("host", "marked", "refused", "compressed as it", "no new errors", "shown by three.js", "within 3 % of its size", "median", "most");
cells("---", ...Array(8).fill("--:"));
const journeys = [];
const failures = [];
for (const [name, compress] of Object.entries(COMPRESSIONS)) {
  const rows = [];
  const refused = [];
  for (const plain of plains) {
    const result = await row(compress, plain);
    if (result?.refused) {
      refused.push(result);
      failures.push(`${plain.name}, ${name}: refused, ${result.refused}`);
    } else if (result) {
      rows.push(result);
      const lost = ways.filter((way) => result.ways[way] === false);
      const unseen = result.isShown ? [] : ["shown otherwise by three.js"];
      const larger = result.isCompressed && result.ratio > WITHIN ? [`larger by ${percent(result.ratio)}`] : [];
      const faults = [...result.errors, ...unseen, ...larger, ...lost.map((way) => `lost: ${way}`), ...(result.isCompressed ? [] : ["written plain"])];
      failures.push(...faults.map((fault) => `${plain.name}, ${name}${result.isFragile ? " (fragile)" : ""}: ${fault}`));
    }
  }
  const ratios = rows.filter(({ isCompressed }) => isCompressed).map(({ ratio }) => ratio);
  ratios.sort((a, b) => a - b);
  const sizes = ratios.length > 0 ? [percent(ratios[Math.floor(ratios.length / 2)]), percent(ratios.at(-1))] : ["–", "–"];
  const small = `${count(ratios, (ratio) => ratio <= WITHIN)} of ${ratios.length}`;
  const [kept, sound] = [count(rows, ({ isCompressed }) => isCompressed), count(rows, ({ errors }) => errors.length === 0)];
  cells(name, rows.length, refused.length, kept, sound, count(rows, ({ isShown }) => isShown), small, ...sizes);
  journeys.push([name, ...ways.map((way) => found(rows, way))]);
}
console.log("\nFound again after:\n");
cells("host", ...ways);
cells("---", ...ways.map(() => "--:"));
journeys.forEach((journey) => cells(...journey));
console.log(`\n${failures.map((line) => `* ${line}`).join("\n")}`);
await shop.close();
rmSync(folder, { recursive: true });
