// docs/PERFORMANCE.md: what was measured, in Markdown.
import { arch, cpus, type } from "node:os";
import { brotliCompressSync, gzipSync } from "node:zlib";

/** What the commands are called, and their stages in order; `null` is all of them. */
const COMMANDS = {
  key: { title: "key derivation", stages: [null] },
  embed: { title: "embed", stages: ["read", "embed", "write", "measure", "test", "forecast", null] },
  extract: { title: "extract", stages: ["read", "measure", "test", null] },
  compare: { title: "half of it, simplified to half, with the original", stages: ["read", "measure", "test", null] },
};

/**
 * @param samples by command, of every run the results `native`, `first` and `second` with `ms` by stage, the latter two also
 * with `memoryBytes`
 * @param rankings of every run the first and the second call's milliseconds by ranking
 * @param stages what `readStages` gives
 * @param large by number of vertices, of every run `ms` and `memoryBytes`
 * @param modules each with `name`, `bytes` and `gzipBudget`
 */
export function markdown({ samples, rankings, large, stages, modules, host, rustc, chromium }) {
  return `# Performance

\`cargo xtask bench\` wrote this on ${new Date().toISOString().slice(0, 10)}.

## Sizes of the WebAssembly modules

| module | bytes | by gzip, level 9 | by brotli, level 11 | budget by gzip |
|---|--:|--:|--:|--:|
${modules.map(moduleRow).join("\n")}

The npm package and the page load the first at once, and \`full\` in its place when what only that has is asked for; the page loads \`research\` for the study and the attacks. The budgets are in \`wasm-pack.toml\`.

## Times

The model is ${host.name}: ${count(host.vertices)} vertices, ${count(host.triangles)} triangles, a .glb of ${count(host.bytes)} bytes. Milliseconds: the median of
${samples.key.length} runs (least–most). Machines are shared and differ, so the ratios, of the Chromium median to the native one, are what
these figures are for.

| | native | Chromium, first call | ratio | Chromium, second call | ratio |
|---|--:|--:|--:|--:|--:|
${rows(samples, ({ title, stages }, runs) => stages.map((stage) => timesRow(title, stage, runs)))}

* Natively: the command line, a new process for every call. In Chromium: the npm package in a worker, a new tab for every
  command. During the first call the engine is still compiling the module; the second call is in the same tab. Native and
  Chromium runs take turns, so that what else the machine does falls on both. Every embedding gave the same bytes, and every
  extraction the tag.
* \`embed\` reads its output back: \`read\` is of the host and of the output, \`measure\` and \`test\` are of the output.
* A stage lasts from its first progress report to the next stage's. So \`forecast\` also has the SHA-256 of both files and,
  natively, the writing of the output.
* \`extract\` ends as soon as it is sure: of a marked model it measures the surface as it is, and no smoothing is undone.
* Native key derivation is how much longer a process lives with a passphrase than with a key file.
* Chromium's clock has steps of 0.1 ms.

## Stages

Natively, on generated models, one stage at a time: medians of \`cargo bench\`, with statistics in \`target/criterion\`. The last
column is for each vertex or, of one more key, for each way of reading that is declared: a turn of the frame, a pitch and a step
of SOLID, an address kind and a cut of RING.

${stages.map(stageTable).join("\n\n")}

## Ranking 50,000 vertices

Milliseconds in Chromium, in a worker, with the mesh's way into the module and the ranking's out of it: the median of
${rankings.length} runs (least–most). The mesh is a bumpy torus of 50,000 vertices and 100,000 triangles; native figures, of a
mesh of as many, are above.

| | first call | second call |
|---|--:|--:|
${Object.keys(rankings[0][0]).map((ranking) => rankingRow(ranking, rankings)).join("\n")}

## Large models

\`meshmark embed\`, natively and in one thread, of bumpy tori: from the process's start to its end, the median of ${large[0].runs.length} runs
(least–most), the sizes by turns; and the most memory that any run of it held, the file read and the one written included.

| vertices | seconds | µs a vertex | against the first | MiB | bytes a vertex |
|--:|--:|--:|--:|--:|--:|
${large.map((size) => largeRow(size, large[0])).join("\n")}

## Memory of the module

| after the first call of | MiB |
|---|--:|
${rows(samples, ({ title }, runs) => [memoryRow(title, runs)])}

WebAssembly memory does not shrink, so this is the most that was needed until then, by a module that did nothing else.

## Where

| | |
|---|---|
| processor | ${cpus()[0].model.trim()}, ${cpus().length} cores |
| system | ${type()}, ${arch()} |
| native compiler | ${rustc.native} |
| WebAssembly compiler | ${rustc.wasm} |
| browser | Chromium ${chromium} |
`;
}

function rows(samples, rowsOf) {
  return Object.entries(COMMANDS)
    .flatMap(([command, names]) => rowsOf(names, samples[command]))
    .join("\n");
}

function timesRow(title, stage, runs) {
  const times = (where) => statistics(runs.map((run) => milliseconds(run[where].ms, stage)));
  const [native, first, second] = ["native", "first", "second"].map(times);
  const ratio = (times) => (times.median / native.median).toFixed(1);
  const name = stage === null ? `**${title}**` : `${title}: ${stage}`;
  return `| ${[name, cell(native), cell(first), ratio(first), cell(second), ratio(second)].join(" | ")} |`;
}

function milliseconds(ms, stage) {
  return stage === null ? Object.values(ms).reduce((sum, value) => sum + value) : ms[stage];
}

function statistics(values) {
  const sorted = values.toSorted((a, b) => a - b);
  const [low, high] = [sorted[(sorted.length - 1) >> 1], sorted[sorted.length >> 1]];
  return { median: (low + high) / 2, least: sorted[0], most: sorted.at(-1) };
}

function cell({ median, least, most }) {
  return `${median.toFixed(1)} (${least.toFixed(1)}–${most.toFixed(1)})`;
}

function moduleRow({ name, bytes, gzipBudget }) {
  const gzip = gzipSync(bytes, { level: 9 }).length;
  const budget = `${count(gzipBudget)}, ${((100 * gzip) / gzipBudget).toFixed(0)} % used`;
  return `| ${[name, count(bytes.length), count(gzip), count(brotliCompressSync(bytes).length), budget].join(" | ")} |`;
}

function rankingRow(ranking, rankings) {
  const cells = [0, 1].map((call) => cell(statistics(rankings.map((calls) => calls[call][ranking]))));
  return `| ${[ranking, ...cells].join(" | ")} |`;
}

function largeRow({ vertices, runs }, first) {
  const times = ({ vertices, runs }) => statistics(runs.map(({ ms }) => ms / vertices));
  const { median, least, most } = times({ vertices, runs });
  const seconds = [median, least, most].map((ms) => ((ms * vertices) / 1000).toFixed(2));
  const bytes = Math.max(...runs.map(({ memoryBytes }) => memoryBytes));
  return `| ${[
    count(vertices),
    `${seconds[0]} (${seconds[1]}–${seconds[2]})`,
    (1000 * median).toFixed(1),
    (median / times(first).median).toFixed(2),
    (bytes / 2 ** 20).toFixed(0),
    count(Math.round(bytes / vertices)),
  ].join(" | ")} |`;
}

function stageTable({ title, stages }) {
  const row = ({ name, ms, elements }) => `| ${name} | ${precise(ms)} | ${precise((1000 * ms) / elements)} |`;
  return [`| ${title} | ms | µs each |`, "|---|--:|--:|", ...stages.map(row)].join("\n");
}

/** Three digits. */
function precise(number) {
  return number >= 100 ? number.toFixed(0) : number.toPrecision(3);
}

function memoryRow(title, runs) {
  const bytes = Math.max(...runs.map(({ first }) => first.memoryBytes));
  return `| ${title} | ${(bytes / 2 ** 20).toFixed(1)} |`;
}

function count(number) {
  return number.toLocaleString("en");
}
