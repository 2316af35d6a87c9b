/** Ledgers: which number was whose, as the command line's `copies` writes them. */
import { sha256 } from "./digest";

/** The buyers of a ledger, by number. */
export interface Ledger {
  file: string;
  /** The file's. */
  bytes: number;
  sha256: string;
  names: Map<number, string>;
  /** How many triangles the model has that all copies are of, where the ledger says so. */
  triangles: number | undefined;
}

const MOST_NUMBER = 2 ** 48 - 1;

/** Reads a ledger: JSON, a list of objects; else CSV with a line of headings, `number` among them. */
export async function readLedger(file: File): Promise<Ledger> {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const text = new TextDecoder().decode(bytes); // which drops the mark that spreadsheets begin with
  const lines = file.name.toLowerCase().endsWith(".json") ? (JSON.parse(text) as unknown) : await fromCsv(text);
  if (!Array.isArray(lines) || lines.length === 0) {
    throw new Error("Nobody is in this ledger.");
  }
  const names = new Map<number, string>();
  const triangles = new Set<number>();
  for (const line of lines as Record<string, unknown>[]) {
    const number = Number(line["number"] === "" ? NaN : line["number"]);
    if (!Number.isInteger(number) || number < 0 || number > MOST_NUMBER) {
      throw new Error("A line of this ledger has no number; its first line has to name the column number.");
    }
    if (names.has(number)) {
      throw new Error(`The number ${number} is in this ledger twice.`);
    }
    names.set(number, String(line["name"] ?? ""));
    triangles.add(Number(line["triangles"] ?? 0));
  }
  const [one = 0, ...others] = triangles;
  const isOne = others.length === 0 && Number.isInteger(one) && one > 0;
  return { file: file.name, bytes: bytes.length, sha256: await sha256(bytes), names, triangles: isOne ? one : undefined };
}

async function fromCsv(text: string): Promise<unknown> {
  const { csvParseRows } = await import("d3-dsv"); // `csvParse` makes functions of headings, which the page's policy forbids
  const [headings = [], ...rows] = csvParseRows(text);
  return rows.map((row) => Object.fromEntries(row.map((value, i) => [headings[i]?.trim() ?? "", value])));
}
