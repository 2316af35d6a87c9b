/** The attacks' names and what came of them, in words. */
import type { Attack, Family } from "../../research-wasm/research.js";
import { odds } from "../words";
import type { Attempt, Level } from "./attempt";
import { SECOND_MARK } from "./bench";

export const FAMILIES: Record<Family, { name: string; hint: string }> = {
  benchmark: { name: "Standard tests", hint: "The attacks of the benchmark that watermarks in meshes are compared by (LIRIS, 2010)." },
  smoothing: { name: "Smoothing", hint: "Other ways to smooth, those of the seed paper among them." },
  retessellation: { name: "Other triangles", hint: "The same surface, meshed anew." },
  wild: { name: "Everyday edits", hint: "What happens to files that nobody means harm." },
  deliberate: { name: "Deliberate", hint: "What somebody does who knows that there is a mark, and has no key." },
};

/** A sign and a word for each level, so that colour says nothing alone. */
export const LEFT: Record<Level, { sign: string; words: string; legend: string }> = {
  green: { sign: "✓", words: "Found", legend: "found: by chance at most 1 in 10⁹" },
  amber: { sign: "◐", words: "Fits partly", legend: "fits partly: not enough to name it" },
  red: { sign: "✕", words: "Lost", legend: "lost: no evidence of the key" },
};

/** An attack at one of its levels. */
export interface Step {
  /** What the module calls it. */
  name: string;
  /** What a person does: "noise 0.1 %", "Laplacian 10 ×". */
  words: string;
  /** "0.1 %", "10 ×"; nothing where there is nothing to choose. */
  level: string;
}

export interface Choice {
  name: string;
  family: Family;
  /** Weakest first. */
  steps: Step[];
}

/** The catalogue, and what takes a key. */
export function choices(catalogue: Attack[]): Choice[] {
  const secondMark = { name: SECOND_MARK, family: "deliberate" as const, unit: "", levels: [], steps: [SECOND_MARK] };
  return [...catalogue, secondMark].map(({ name, family, unit, levels, steps }) => {
    const level = (i: number) => (levels[i] === undefined ? "" : `${levels[i]}${unit || " ×"}`);
    return { name, family, steps: steps.map((step, i) => ({ name: step, words: `${name} ${level(i)}`.trim(), level: level(i) })) };
  });
}

/** With a capital, but for the one name that begins without. */
export function capital(text: string): string {
  return text.startsWith("glTF") ? text : text.charAt(0).toUpperCase() + text.slice(1);
}

/** Steps as one sees them: "Crop 30 %, simplify 50 %". */
export function stepsWords(steps: Step[]): string {
  return capital(steps.map(({ words }) => words).join(", "));
}

/** Digits as an exponent, in plain text. */
function raised(digits: string): string {
  return digits.replaceAll(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]!);
}

/** What came of an attempt, in one line. */
export function cameOf({ state, finding }: Attempt): string {
  if (state === "done" && finding) {
    if (finding.level === "red") {
      return LEFT.red.legend;
    }
    const [text, exponent] = odds(finding.reading.lnP);
    return `${LEFT[finding.level].words.toLowerCase()}, by chance at most ${text}${raised(exponent)}`;
  }
  return { idle: "not tried", cancelled: "cancelled", waiting: "waiting", running: "being tried", done: "", failed: "failed" }[state];
}
