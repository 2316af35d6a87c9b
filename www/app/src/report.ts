/** What can be kept of a result, as JSON. It never holds the key, the name or the passphrase. */
import type { EmbedReport, Extraction } from "meshmark";
import { engine } from "./engine";
import type { Model } from "./model";

export async function embedReport(host: Model, marked: Model, report: EmbedReport): Promise<object> {
  return { kind: "embed", ...(await origin()), host: host.name, marked: marked.name, report };
}

export async function checkReport(suspect: Model, sha256: string | null, expected: string | null, result: Extraction): Promise<object> {
  return { kind: expected === null ? "extract" : "verify", ...(await origin()), suspect: suspect.name, sha256, expected, result };
}

async function origin(): Promise<{ meshmark: string; made: string }> {
  return { meshmark: await (await engine).version(), made: new Date().toISOString() };
}
