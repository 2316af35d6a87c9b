/** A line chart in SVG: a few series over a few places, each point with its least and most. */
import { h } from "../dom";
import { svg } from "./svg";

export interface Series {
  /** Of the style sheet: its colour, and in the legend the same. */
  kind: string;
  name: string;
  points: { at: number; mean: number; least: number; most: number }[];
}

export interface Plot {
  title: string;
  /** Under each place. */
  marks: string[];
  across: string;
  up: string;
  /** The top of the scale, and a line across that says what chance is. */
  most: number;
  chance: number;
  series: Series[];
}

const [WIDTH, HEIGHT] = [540, 250];
const [LEFT, RIGHT, TOP, BOTTOM] = [56, 12, 12, 46];
const STEPS = 6;

export function plot({ title, marks, across, up, most, chance, series }: Plot): HTMLElement {
  const x = (at: number) => LEFT + ((at + 0.5) / marks.length) * (WIDTH - LEFT - RIGHT);
  const y = (value: number) => HEIGHT - BOTTOM - (value / most) * (HEIGHT - TOP - BOTTOM);
  const line = (y: number, className: string) => svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y, class: className });
  const label = (x: number, y: number, anchor: string, text: string) => svg("text", { x, y, "text-anchor": anchor }, text);
  const levels = Array.from({ length: STEPS + 1 }, (_, i) => (most * i) / STEPS);
  const aside = (i: number) => (i - (series.length - 1) / 2) * 5; // so that points at one height do not hide each other

  const drawing = svg(
    "svg",
    { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${title}. The numbers are in the table below.` },
    ...levels.flatMap((level) => [line(y(level), "grid"), label(LEFT - 7, y(level) + 4, "end", `${Math.round(level * 100)} %`)]),
    ...marks.map((mark, i) => label(x(i), HEIGHT - BOTTOM + 18, "middle", mark)),
    label((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6, "middle", across),
    line(y(chance), "chance"),
    ...series.map(({ kind, points }, i) =>
      svg(
        "g",
        { class: `series ${kind}` },
        svg("polyline", { points: points.map(({ at, mean }) => `${x(at) + aside(i)},${y(mean)}`).join(" ") }),
        ...points.flatMap(({ at, mean, least, most }) => [
          svg("line", { x1: x(at) + aside(i), x2: x(at) + aside(i), y1: y(least), y2: y(most) }),
          svg("circle", { cx: x(at) + aside(i), cy: y(mean), r: 3.2 }),
        ]),
      ),
    ),
  );
  return h("figure", { class: "plot" }, h("figcaption", {}, h("strong", {}, title), ` · ${up}`), drawing);
}

/** What each colour stands for. */
export function plotLegend(series: Pick<Series, "kind" | "name">[]): HTMLElement {
  const sign = (kind: string) => svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true", class: `series ${kind}` }, svg("polyline", { points: "0,5 22,5" }), svg("circle", { cx: 11, cy: 5, r: 3.2 }));
  return h("ul", { class: "plot-legend" }, ...series.map(({ kind, name }) => h("li", {}, sign(kind), name)));
}
