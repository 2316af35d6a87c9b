/** What can be kept of a check, as JSON. It never holds the key, the name or the passphrase, nor what follows the key where nothing is found. */
import type { DetailedExtraction, Extraction } from "meshmark";
import type { Line } from "./answers";
import type { Compared } from "./comparing";
import { engine } from "./engine";
import type { Given } from "./given";
import { isMark, problem } from "./words";

/** @param sha256 of the suspect's main file */
export async function checkReport(suspect: string, sha256: string | null, expected: string | null, result: DetailedExtraction): Promise<object> {
  return { kind: expected === null ? "extract" : "verify", ...(await origin()), suspect, sha256, expected, result: told(result) };
}

/** Of a suspect that was compared. What was seen of it is in the other report. */
export async function comparisonReport(suspect: string, sha256: string | null, given: Given, expected: string | null, compared: Compared): Promise<object> {
  const { lnP, overlay, statement, ...told } = compared;
  return { kind: "compare", ...(await origin()), suspect, sha256, [given.kind]: given.name, expected, result: isMark(compared) ? { ...told, lnP } : told };
}

/** Of several suspects, or several keys, whose number has been charged. */
export async function checksReport(numSuspects: number, numKeys: number, expected: string | null, lines: Line[]): Promise<object> {
  const line = (line: Line) => ("answer" in line ? { suspect: line.suspect, key: line.key, result: told(line.answer.reading) } : { suspect: line.suspect, error: problem(line.error).text });
  return { kind: "checks", ...(await origin()), numSuspects, numKeys, expected, answers: lines.map(line) };
}

/** Reports of checks are passed on. */
function told(result: DetailedExtraction): Extraction {
  const { lnP, agreement, carriers, ...verdict } = result;
  return isMark(result) ? result : verdict;
}

async function origin(): Promise<{ meshmark: string; made: string }> {
  return { meshmark: await (await engine).version(), made: new Date().toISOString() };
}
