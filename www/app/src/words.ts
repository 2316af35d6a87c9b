/** Numbers and outcomes in words. */
import type { Carrier, DetailedExtraction, Extraction, Forecast, Stage, Verdict } from "meshmark";
import { MeshmarkError } from "meshmark/client";

/** Natural logarithm of the largest chance at which a mark counts as found: 1e-9. */
const LN_P_FOUND = Math.log(1e-9);

export const VERDICTS: Record<Verdict, string> = {
  found: "Your mark was found",
  present: "Your mark is there, without a tag",
  partial: "A mark fits partly",
  none: "No evidence of this key",
  "cannot-check": "Cannot check",
};

/** Each carrier's name, where its symbols live, and what they survive there. */
export const CARRIERS: Record<Carrier, { name: string; home: string; survives: string }> = {
  solid: { name: "Shape (SOLID)", home: "shape", survives: "In where the surface is, whatever its triangles. Survives noise, smoothing, quantization, simplification and remeshing, but not cropping." },
  ring: { name: "Connectivity (RING)", home: "connectivity", survives: "In where each vertex sits among its neighbours. Survives cropping of irregular meshes, reordering and quantization, but not smoothing, simplification or remeshing." },
};

interface AttackWords {
  /** To follow "It survives". */
  name: string;
  meaning?: string;
}

/** What is tried on a marked model. */
const ATTACKS: Record<string, AttackWords> = {
  none: { name: "no change at all" },
  web: { name: "what web pipelines do", meaning: "They round positions to 14 bits by default, of which one is the sign." },
  noise: { name: "noise of 0.1 %", meaning: "Each vertex is shaken by up to 0.1 % of the model’s radius." },
  quantize: { name: "rounding to 11 bits", meaning: "Of positions, as when a model is compressed." },
  smooth: { name: "10 light steps of smoothing", meaning: "In Blender: Smooth Vertices, smoothing 0.1, repeat 10." },
  "simplify-30": { name: "removing 30 % of its triangles" },
  "simplify-50": { name: "removing half of its triangles" },
  "simplify-70": { name: "removing 70 % of its triangles" },
  crop: { name: "cutting 30 % of it away" },
};

export const LEVELS: Record<Forecast["level"], string> = { green: "Survives", amber: "Maybe", red: "Lost" };

export function attackWords(attack: string): AttackWords {
  return ATTACKS[attack] ?? { name: attack };
}

/** What the mark does not survive, in one sentence; `null` where it survives all that was tried. */
export function losses(forecast: Forecast[]): string | null {
  const lost = forecast.filter(({ level }) => level === "red").map(({ attack }) => attackWords(attack).name);
  return lost.length === 0 ? null : `It will not survive ${new Intl.ListFormat("en", { type: "disjunction" }).format(lost)}.`;
}

/** The library's words with the page's: what it calls a payload is a tag here. */
export function plain(words: string): string {
  return words.replaceAll("payload", "tag");
}

/** Whether a mark is there beyond chance, with a tag or without. */
export function isMark({ verdict }: Pick<Extraction, "verdict">): boolean {
  return verdict === "found" || verdict === "present";
}

/** The carriers that speak for a mark: those that read its tag or, where it has none, that exclude chance alone. */
export function holders({ number, carriers }: DetailedExtraction): Carrier[] {
  return carriers.filter((carrier) => (number === null ? carrier.lnP <= LN_P_FOUND : carrier.number === number)).map(({ name }) => name);
}

/** The same as places: "the shape", "the connectivity", or both; `null` where none speaks. */
export function homes(reading: DetailedExtraction): string | null {
  const spoke = holders(reading).map((name) => `the ${CARRIERS[name].home}`);
  return spoke.length === 0 ? null : new Intl.ListFormat("en").format(spoke);
}

export const STAGES: Record<Stage | "key", string> = {
  key: "Making your key from the passphrase",
  read: "Reading the model",
  embed: "Writing the mark into the geometry",
  write: "Writing the copy",
  measure: "Measuring the geometry",
  test: "Looking for the mark",
  forecast: "Trying what the mark survives",
};

const LN_10 = Math.log(10);

/**
 * A bound of a probability, rounded towards caution: `["100 %", ""]`, `["1 in 1,234", ""]`, or `["1 in 10", "24"]` with an
 * exponent.
 */
export function odds(lnP: number): [text: string, exponent: string] {
  const digits = Math.floor(-lnP / LN_10);
  if (digits < 1) {
    return [`${Math.ceil(Math.exp(lnP) * 100)} %`, ""];
  }
  return digits < 6 ? [`1 in ${count(Math.floor(Math.exp(-lnP)))}`, ""] : ["1 in 10", String(digits)];
}

export function count(n: number): string {
  return n.toLocaleString("en");
}

/** A fraction as a percentage. */
export function percent(fraction: number): string {
  return `${significant(fraction * 100)} %`;
}

/** Two or three significant digits, without an exponent where that can be read. */
export function significant(x: number): string {
  return x !== 0 && (Math.abs(x) < 1e-5 || Math.abs(x) >= 1e7)
    ? x.toExponential(2)
    : x.toLocaleString("en", { minimumSignificantDigits: 2, maximumSignificantDigits: 3, useGrouping: false });
}

export function bytes(n: number): string {
  return n < 1e6 ? `${count(Math.ceil(n / 1e3))} kB` : `${(n / 1e6).toFixed(1)} MB`;
}

/** What went wrong as a sentence without its full stop, and what a program would call it, if the package said it. */
export function problem(error: unknown): { text: string; code: string | null; path: string | null } {
  if (error instanceof MeshmarkError) {
    return { text: error.message.replace(/\.$/, ""), code: error.code, path: error.path };
  }
  return { text: error instanceof Error ? error.message.replace(/\.$/, "") : String(error), code: null, path: null };
}
