/** What can be kept of a result, as JSON. It never holds the key, the name or the passphrase, nor what follows the key where nothing is found. */
import type { DetailedExtraction, EmbedReport, Extraction } from "meshmark";
import { engine } from "./engine";
import type { Model } from "./model";

export async function embedReport(host: Model, marked: Model, report: EmbedReport): Promise<object> {
  return { kind: "embed", ...(await origin()), host: host.name, marked: marked.name, report };
}

export async function checkReport(suspect: Model, sha256: string | null, expected: string | null, result: DetailedExtraction): Promise<object> {
  return { kind: expected === null ? "extract" : "verify", ...(await origin()), suspect: suspect.name, sha256, expected, result: told(result) };
}

/** Reports of checks are passed on. */
function told(result: DetailedExtraction): Extraction {
  const { lnP, agreement, carriers, ...verdict } = result;
  return result.verdict === "found" ? result : verdict;
}

async function origin(): Promise<{ meshmark: string; made: string }> {
  return { meshmark: await (await engine).version(), made: new Date().toISOString() };
}
