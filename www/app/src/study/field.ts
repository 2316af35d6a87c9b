/** One number at every vertex, as colours with a scale. */
import type { Fields, Tracing } from "../../research-wasm/research.js";
import { percent, significant } from "../words";

export type FieldName = "stability" | "gaussian" | "mean" | "deviation";

/** What is larger than this share of all has the colour of the scale's end: a few vertices would leave no colour for the rest. */
const SHOWN = 0.9;

export interface Field {
  title: string;
  /** NaN where there is none. */
  values: Float64Array;
  /** The values at the ends of the scale. */
  range: [least: number, most: number];
  /** Rows of marks under the scale, from its one end to the other. */
  marks: string[][];
}

/** What a surface is coloured by; `null` where that is not known. */
export function fieldOf(name: FieldName, fields: Fields | undefined, tracing: Tracing | undefined, diagonal: number): Field | null {
  if (name === "deviation") {
    return tracing ? deviation(tracing, diagonal) : null;
  }
  if (!fields) {
    return null;
  }
  switch (name) {
    case "stability":
      return { title: "Stability: place in the ranking", values: fields.stability, range: [0, 1], marks: [["last", "", "first"]] };
    case "gaussian":
      return signed("Gaussian curvature, in 1/units²", fields.gaussian);
    case "mean":
      return signed("Mean curvature, in 1/units; positive bulges", fields.mean);
  }
}

/** New vertices of a subdivision come from nowhere: they have moved by nothing that could be said. */
function deviation({ deviation, positions }: Tracing, diagonal: number): Field {
  const values = new Float64Array(positions.length / 3).fill(NaN);
  values.set(deviation);
  const most = shown(deviation);
  const row = (text: (of: number) => string) => (most === 0 ? ["0", "", ""] : ["0", text(most / 2), `≥ ${text(most)}`]);
  return { title: "Deviation in units, and in % of the diagonal", values, range: [0, most], marks: [row((of) => significant(of * diagonal)), row(percent)] };
}

function signed(title: string, values: Float64Array): Field {
  const end = shown(values.map(Math.abs));
  return { title, values, range: [-end, end], marks: [[`≤ −${significant(end)}`, "0", `≥ ${significant(end)}`]] };
}

/** The end of a scale for sizes. */
function shown(sizes: Float64Array): number {
  return sizes.slice().sort()[Math.floor(SHOWN * (sizes.length - 1))] ?? 0;
}
