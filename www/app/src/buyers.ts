/** One copy for each buyer: names in, an archive of copies and their ledger out. */
import { csvFormat } from "d3-dsv";
import { engine } from "./engine";
import type { KeyMaker } from "./key-form";
import { renamed, type Model } from "./model";
import { withKey } from "./reading";
import type { Task } from "./task";
import type { Preset } from "./copy";

/** A line of the ledger, as the command line writes it. */
interface Entry {
  number: number;
  name: string;
  file: string;
  sha256: string;
  date: string;
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
    for await (const { model: copy, report } of client.copies(model.bytes, numbers, key, { strength, signal: task.signal, onProgress: task.onProgress })) {
      const name = names[report.number - first]!;
      const extension = model.name.slice(model.name.lastIndexOf(".") + 1);
      const file = renamed(model.name, `${report.number}.${extension}`);
      files[file] = copy;
      numWeaker += Number(report.isWeaker);
      entries.push({ number: report.number, name, file, sha256: report.markedSha256, date: new Date().toISOString() });
      task.say(`Copy ${entries.length} of ${names.length}: ${name}`, entries.length / names.length);
    }
  });
  const { strToU8, zipSync } = await import("fflate");
  files["ledger.csv"] = strToU8(`${csvFormat(entries)}\n`);
  files["ledger.json"] = strToU8(`${JSON.stringify(entries, null, 2)}\n`);
  return { zip: zipSync(files, { level: 0 }), numCopies: entries.length, numWeaker };
}
