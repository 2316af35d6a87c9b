/** A finished copy, and what it was made with, so that it can say so wherever it goes. Never the key. */
import type { Carrier, EmbedReport, Embedding, Strength } from "meshmark";
import { engine } from "./engine";
import type { KeySource } from "./key-form";
import { copyName, renamed, sizeOf, type Model } from "./model";

/** What is random in a forecast is drawn from it: the same copy has the same forecast. */
const FORECAST_SEED = 1;

export type Preset = Extract<Strength, string>;

/** What a form asks for beside the key. */
export interface Asked {
  tag: string;
  strength: Preset;
  carriers: Carrier[];
}

export interface Copy {
  /** The same for the same bytes under the same name. */
  id: string;
  /** When it was finished, as ISO 8601 has it. */
  made: string;
  /** Of the original. */
  host: string;
  hostBytes: number;
  marked: Model;
  /** The buffers that changed, which go with the main file. */
  files: string[];
  report: EmbedReport;
  /** Whose key it was; `null` for a key file. */
  owner: string | null;
  /** The title of the work whose key it was; `null` for none. */
  work: string | null;
  asked: Asked;
}

export function copyOf(host: Model, { model, files, report }: Embedding, key: KeySource, asked: Asked): Copy {
  const marked: Model = { name: copyName(host, "marked"), bytes: model as Model["bytes"], buffers: { ...host.buffers, ...files }, images: host.images };
  const made = new Date().toISOString();
  return { id: `${report.markedSha256} ${marked.name}`, made, host: host.name, hostBytes: sizeOf(host), marked, files: Object.keys(files), report, owner: key.owner, work: key.work, asked };
}

/** What is to be downloaded, by its name: the model, or an archive of it with all that it names. */
export function downloads({ marked }: Copy): string[] {
  return [isAlone(marked) ? marked.name : renamed(marked.name, "zip")];
}

/** The bytes of a download. */
export async function bytesOf({ marked }: Copy): Promise<Uint8Array> {
  if (isAlone(marked)) {
    return marked.bytes;
  }
  const { zipSync } = await import("fflate");
  return zipSync(filesOf(marked), { level: 0 });
}

/** The main file and all that it names, by their paths. What lies outside of its folder is left out. */
export function filesOf({ name, bytes, images, buffers }: Model): Record<string, Uint8Array> {
  const named = Object.entries({ ...images, ...buffers }).filter(([path]) => !path.split("/").includes(".."));
  return { [name]: bytes, ...Object.fromEntries(named) };
}

export function isAlone(model: Model): boolean {
  return Object.keys(filesOf(model)).length === 1;
}

/** All of it that can be kept beside the original, as JSON. */
export async function reportOf({ made, host, hostBytes, marked, owner, work, asked, report }: Copy): Promise<object> {
  const meshmark = await (await engine).version();
  return { kind: "embed", meshmark, made, owner, work, host, hostBytes, marked: marked.name, markedBytes: sizeOf(marked), asked, forecastSeed: FORECAST_SEED, report };
}

/** Whose the copy is and what a check will read, for a person: "the tag ADA-1 of Ada". */
export function whose({ owner, asked, report }: Copy): string {
  const of = owner === null ? "of a key file" : `of ${owner}`;
  return report.number === null ? `the mark ${of}, without a tag` : `the tag ${asked.tag} ${of}`;
}
