/** One copy for each buyer: names in, an archive of copies and their ledger out. */
import { filesOf, isAlone, type Preset } from "./copy";
import { engine } from "./engine";
import type { KeyMaker } from "./key-form";
import { copyName, type Model } from "./model";
import { withKey } from "./reading";
import type { Task } from "./task";


/** A line of the ledger, as the command line writes it. */
interface Entry {
  number: number;
  name: string;
  file: string;
  sha256: string;
  date: string;
  triangles: number;
}

/** What came of all buyers. */
export interface Copies {
  zip: Uint8Array;
  numCopies: number;
  /** How many hold less than the one that was forecasted. */
  numWeaker: number;
}

/** Names, one in a line. */
export function namesIn(text: string): string[] {
  return text
    .split("\n")
    .map((name) => name.trim())
    .filter((name) => name !== "");
}

/** Makes the copies, the first with a number; the first name gets it. */
export async function copiesFor(model: Model, names: string[], first: number, strength: Preset, makeKey: KeyMaker, task: Task): Promise<Copies> {
  const client = await engine;
  const numbers = names.map((_, i) => first + i);
  const entries: Entry[] = [];
  const files: Record<string, Uint8Array> = {};
  let numWeaker = 0;
  await withKey(client, makeKey, task, async (key) => {
    const options = { files: model.buffers, strength, signal: task.signal, onProgress: task.onProgress };
    for await (const { model: bytes, files: changed, report } of client.copies(model.bytes, numbers, key, options)) {
      const name = names[report.number - first]!;
      const copy: Model = { ...model, bytes: bytes as Model["bytes"], buffers: { ...model.buffers, ...changed } };
      // A model of several files names them: each copy has a folder of its own, and its files their names.
      const [folder, main] = isAlone(copy) ? ["", copyName(model, String(report.number))] : [`${report.number}/`, model.name];
      for (const [path, content] of Object.entries(filesOf({ ...copy, name: main }))) {
        files[folder + path] = content;
      }
      const file = folder + main;
      numWeaker += Number(report.isWeaker);
      entries.push({ number: report.number, name, file, sha256: report.markedSha256, date: new Date().toISOString(), triangles: report.triangles });
      task.say(`Copy ${entries.length} of ${names.length}: ${name}`, entries.length / names.length);
    }
  });
  const [{ csvFormat }, { strToU8, zipSync }] = await Promise.all([import("d3-dsv"), import("fflate")]);
  files["ledger.csv"] = strToU8(`${csvFormat(entries)}\n`);
  files["ledger.json"] = strToU8(`${JSON.stringify(entries, null, 2)}\n`);
  return { zip: zipSync(files, { level: 0 }), numCopies: entries.length, numWeaker };
}
