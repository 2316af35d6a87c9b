/** Answers about several suspects, or by several keys: one line each, and what their number does to the chances. */
import { h } from "./dom";
import { chance } from "./outcome";
import type { Answer } from "./reading";
import { count, isMark, problem, VERDICTS } from "./words";

/** What came of one suspect and one key; or of one suspect, why nothing came of it. */
export type Line = { suspect: string; key: string | null; answer: Answer } | { suspect: string; error: unknown };

export function isFound(line: Line): boolean {
  return "answer" in line && isMark(line.answer.reading) && !line.answer.isOther;
}

/** What was found, above what was not. */
export function answersList(lines: Line[]): HTMLElement {
  const sorted = [...lines.filter(isFound), ...lines.filter((line) => !isFound(line))];
  return h("ul", { class: "copies" }, ...sorted.map((line) => h("li", {}, h("strong", {}, nameOf(line)), "answer" in line ? words(line.answer) : h("p", { class: "problem" }, `Cannot check: ${problem(line.error).text}.`))));
}

function nameOf(line: Line): string {
  return "answer" in line && line.key !== null ? `${line.suspect}, ${line.key}` : line.suspect;
}

function words({ reading, isOther }: Answer): HTMLElement {
  if (reading.verdict !== "found") {
    return h("p", { class: "hint" }, VERDICTS[reading.verdict], ...(reading.verdict === "present" ? ["; by chance ", chance(reading.lnP!)] : []));
  }
  const tag = h("code", {}, reading.tag ?? String(reading.number));
  const from = reading.input === "evidence" ? "; read from evidence" : "";
  return h("p", {}, isOther ? "Found, with another tag: " : "Found, with tag ", tag, "; by chance ", chance(reading.lnP), from);
}

/** What the number of suspects and keys does to the chances. */
export function chargeWords(numSuspects: number, numKeys: number): string {
  const keys = numKeys > 1 ? `That there are ${count(numKeys)} keys is charged in each chance.` : "";
  const suspects = numSuspects > 1 ? `Each model was tested by itself: that a mark is found in any of ${count(numSuspects)} that carry none has a chance of at most ${count(numSuspects)} in 1,000,000,000.` : "";
  return [keys, suspects].filter(Boolean).join(" ");
}
