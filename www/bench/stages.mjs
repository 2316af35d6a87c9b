// What criterion measured: the files that it leaves for each benchmark.
import { readFileSync, readdirSync, statSync } from "node:fs";
import { join } from "node:path";

/**
 * Groups of benchmarks in the order in which they ran: each has a `title` and `stages` with `name`, median `ms` and the number of
 * `elements` that one run works on, if there is one.
 */
export function readStages(folder) {
  const files = readdirSync(folder, { recursive: true })
    .filter((file) => file.endsWith(join("new", "estimates.json")))
    .map((file) => join(folder, file))
    .sort((a, b) => statSync(a).mtimeMs - statSync(b).mtimeMs);
  const groups = new Map();
  for (const file of files) {
    const { group_id: title, function_id: name, throughput } = read(join(file, "..", "benchmark.json"));
    const { median } = read(file);
    if (name === null) continue; // not of a group
    const stage = { name, ms: median.point_estimate / 1e6, elements: throughput?.Elements };
    groups.set(title, [...(groups.get(title) ?? []), stage]);
  }
  return [...groups].map(([title, stages]) => ({ title, stages }));
}

function read(file) {
  return JSON.parse(readFileSync(file, "utf8"));
}
