/** Fig. 5: how often bits are wrong, against the smoothing and against the strength, as points come in. */
import type { Errors, Finding, Hosts } from "../../research-wasm/research.js";
import { h } from "../dom";
import { percent } from "../words";
import { plot, plotLegend, type Series } from "./plot";
import { FINDINGS, HOSTS, MEASURES, times } from "./words";

/** Where both halves of the figure have their points. */
export interface Places {
  iterations: number[];
  strengths: number[];
  /** At which smoothings are compared, and how often strengths are smoothed. */
  strength: number;
  smoothedOnce: number;
}

type Measure = keyof typeof MEASURES;
type Way = keyof typeof FINDINGS;

export class Figure {
  readonly root = h("div", { class: "figure" });
  readonly #points: Errors[] = [];
  readonly #plots = h("div", { class: "plots" });
  readonly #numbers = h("div", { class: "scroll" });
  readonly #hint = h("p", { class: "hint" });
  #way: Way = "traced";
  #measure: Measure = "raw";

  constructor(readonly places: Places) {
    const ways = segments("How hosts are found again", FINDINGS, this.#way, (way) => {
      this.#way = way;
      this.#draw();
    });
    const measures = segments("Before or after decoding", MEASURES, this.#measure, (measure) => {
      this.#measure = measure;
      this.#draw();
    });
    const numbers = h("details", {}, h("summary", {}, "Numbers"), this.#numbers);
    this.root.append(h("div", { class: "choosers" }, ways, measures), this.#hint, this.#plots, numbers);
    this.#draw();
  }

  add(points: Errors[]): void {
    this.#points.push(...points);
    this.#draw();
  }

  #draw(): void {
    const { iterations, strengths, strength, smoothedOnce } = this.places;
    const { hint } = FINDINGS[this.#way];
    const { axis } = MEASURES[this.#measure];
    this.#hint.textContent = `${hint} Cells need no hosts to be found: each vertex holds a bit of its direction.`;
    const bySmoothing = this.#series((point) => (point.strength === strength ? iterations.indexOf(point.iterations) : -1));
    const byStrength = this.#series((point) => (point.iterations === smoothedOnce ? strengths.indexOf(point.strength) : -1));
    const common = { up: axis, most: 0.6, chance: 0.5 };
    this.#plots.replaceChildren(
      plot({ ...common, title: "Against smoothing", marks: iterations.map(String), across: `iterations, at a strength of ${percent(strength)}`, series: bySmoothing }),
      plot({ ...common, title: "Against strength", marks: strengths.map((s) => percent(s)), across: `RMS displacement, of the diagonal; ${times(smoothedOnce)}`, series: byStrength }),
      plotLegend([...bySmoothing, { kind: "chance-level", name: "Chance" }]),
    );
    this.#numbers.replaceChildren(numbersTable(this.#points));
  }

  #series(placeOf: (point: Errors) => number): Series[] {
    return (Object.keys(HOSTS) as Hosts[])
      .filter((hosts) => hosts !== "random" || this.#way !== "ranked") // random hosts have no ranking to be found by
      .map((hosts) => {
        const finding: Finding = hosts === "all" ? "cells" : this.#way;
        const points = this.#points
          .filter((point) => point.hosts === hosts && point.finding === finding)
          .map((point) => ({ ...point[this.#measure], at: placeOf(point) }))
          .filter(({ at }) => at >= 0)
          .sort((a, b) => a.at - b.at);
        return { kind: hosts, name: HOSTS[hosts], points };
      });
  }
}

function numbersTable(points: Errors[]): HTMLElement {
  const heads = ["Hosts", "Found", "Iterations", "Strength", "Raw", "Decoded", "Texts read"].map((text) => h("th", { scope: "col" }, text));
  const row = ({ hosts, finding, iterations, strength, raw, payload, read }: Errors) => {
    const way = finding === "cells" ? "By direction" : FINDINGS[finding].name;
    const shares = [raw.mean, payload.mean, read].map((share) => `${(share * 100).toFixed(1)} %`);
    return h("tr", {}, h("th", { scope: "row" }, HOSTS[hosts]), ...[way, String(iterations), percent(strength), ...shares].map((text) => h("td", {}, text)));
  };
  return h("table", {}, h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, ...points.map(row)));
}

/** Toggle buttons of which one is pressed. */
function segments<K extends string>(label: string, choices: Record<K, { name: string }>, first: K, choose: (choice: K) => void): HTMLElement {
  const group = h("div", { class: "segments", role: "group", "aria-label": label });
  for (const choice of Object.keys(choices) as K[]) {
    const button = h("button", { type: "button", "aria-pressed": String(choice === first) }, choices[choice].name);
    button.addEventListener("click", () => {
      [...group.children].forEach((other) => other.setAttribute("aria-pressed", String(other === button)));
      choose(choice);
    });
    group.append(button);
  }
  return group;
}
