/** What can be kept of a check, as JSON. It never holds the key, the name or the passphrase, nor what follows the key where nothing is found. */
import type { DetailedExtraction, Extraction } from "meshmark";
import { engine } from "./engine";

/** @param sha256 of the suspect's main file */
export async function checkReport(suspect: string, sha256: string | null, expected: string | null, result: DetailedExtraction): Promise<object> {
  const meshmark = await (await engine).version();
  return { kind: expected === null ? "extract" : "verify", meshmark, made: new Date().toISOString(), suspect, sha256, expected, result: told(result) };
}

/** Reports of checks are passed on. */
export function told(result: DetailedExtraction): Extraction {
  const { lnP, agreement, carriers, ...verdict } = result;
  return result.verdict === "found" ? result : verdict;
}
