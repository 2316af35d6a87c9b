/** What was tried, one a row: what was left of the mark, and what it cost. */
import type { Carrier } from "meshmark";
import type { Quality } from "../../research-wasm/research.js";
import { announce, button, h } from "../dom";
import { isGltf } from "../model";
import { oddsOf } from "../outcome";
import { save } from "../save";
import { count, percent, problem } from "../words";
import type { Attempt, Finding } from "./attempt";
import { cameOf, LEFT } from "./words";

const HEADS = ["What was done", "Mark", "By chance", "Shape", "Connectivity", "Cost", "Triangles", "Copy"];

export interface RowEvents {
  onShow(attempt: Attempt): void;
  onAgain(attempt: Attempt): void;
}

export class Rows {
  readonly root = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "What was tried" });
  readonly #body = h("tbody");
  readonly #rows = new Map<Attempt, HTMLTableRowElement>();
  readonly #events: RowEvents;
  readonly #first: Finding;

  /** @param first what there was before anything was done */
  constructor(first: Finding, events: RowEvents) {
    this.#events = events;
    this.#first = first;
    const heads = HEADS.map((text) => h("th", { scope: "col" }, text));
    const untouched = h("tr", { class: "untouched" }, h("th", { scope: "row" }, "As it was marked"), ...numbers(first, first), h("td"));
    this.root.append(h("table", {}, h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, untouched), this.#body));
  }

  /** Puts an attempt on top of the others, where it will be heard of. */
  add(attempt: Attempt): void {
    const known = this.#rows.get(attempt);
    if (known) {
      this.#body.prepend(known);
      return;
    }
    for (const [other, row] of this.#rows) {
      if (other.isLike(attempt)) {
        row.remove();
        this.#rows.delete(other);
      }
    }
    const row = h("tr");
    this.#rows.set(attempt, row);
    this.#body.prepend(row);
    const title = h("th", { scope: "row" }, attempt.title, h("span", { class: "hint" }, attempt.hint));
    let drawn = "";
    const draw = () => {
      if (drawn !== attempt.state) {
        drawn = attempt.state;
        row.dataset["state"] = drawn;
        const hadFocus = row.contains(document.activeElement);
        row.replaceChildren(title, ...this.#cells(attempt));
        if (hadFocus) {
          row.querySelector("button")?.focus(); // the one that had it is gone
        }
        if (drawn === "done" || drawn === "failed") {
          announce(`${attempt.title}: ${cameOf(attempt)}`);
        }
      }
      const [words, bar] = [row.querySelector(".words"), row.querySelector("progress")];
      if (words && bar) {
        words.textContent = attempt.words;
        if (attempt.fraction === null) {
          bar.removeAttribute("value");
        } else {
          bar.value = attempt.fraction;
        }
      }
    };
    attempt.onChange(draw);
    draw();
  }

  /** The attempt in these rows that would come to the same, if there is one. */
  like(attempt: Attempt): Attempt | undefined {
    return [...this.#rows.keys()].find((other) => other.isLike(attempt));
  }

  /** Marks the row of the copy that is shown. */
  point(shown: Attempt): void {
    for (const [attempt, row] of this.#rows) {
      row.toggleAttribute("data-shown", attempt === shown);
      row.querySelector("[data-show]")?.setAttribute("aria-pressed", String(attempt === shown));
    }
  }

  #cells(attempt: Attempt): HTMLElement[] {
    const { onShow, onAgain } = this.#events;
    const across = (...content: Node[]) => [h("td", { colspan: String(HEADS.length - 1) }, h("div", { class: "under-way" }, ...content))];
    const again = () => button("Try again", () => onAgain(attempt));
    switch (attempt.state) {
      case "waiting":
        return across(h("span", { class: "words" }, "Waiting …"), button("Cancel", () => attempt.cancel()));
      case "running":
        return across(h("span", { class: "words" }), h("progress", { "aria-label": `Progress of ${attempt.title}` }), button("Cancel", () => attempt.cancel()));
      case "idle":
      case "cancelled":
        return across(h("span", {}, "Cancelled."), again());
      case "failed":
        return across(h("span", { class: "problem" }, `Failed: ${problem(attempt.error).text}.`), again());
      case "done": {
        const show = button("Show", () => onShow(attempt));
        show.dataset["show"] = "";
        show.setAttribute("aria-label", `Show ${attempt.title}`);
        const download = button("Save", () => void saveCopy(attempt));
        download.setAttribute("aria-label", `Save the copy after ${attempt.title}`);
        return [...numbers(attempt.finding!, this.#first), h("td", {}, h("div", { class: "both-buttons" }, show, download))];
      }
    }
  }
}

function numbers({ reading, level, quality }: Finding, first: Finding): HTMLElement[] {
  const two = (above: Node | string, ...below: string[]) => h("td", {}, above, ...below.map((line) => h("span", { class: "hint" }, line)));
  const probability = (lnP: number | undefined) => h("td", {}, lnP === undefined ? "–" : oddsOf(lnP));
  const of = (name: Carrier) => probability(reading.carriers.find((carrier) => carrier.name === name)?.lnP);
  const cost = ({ rmsRel, hausdorffRel, msdm }: Quality) => two(`average ${part(rmsRel)}`, `at most ${part(hausdorffRel)}`, `visible ${msdm === null ? "–" : msdm.toFixed(2)}`);
  const share = quality.triangles / first.quality.triangles;
  const cells = [
    h("td", { class: "came", "data-level": level }, h("span", { "aria-hidden": "true" }, `${LEFT[level].sign} `), LEFT[level].words),
    probability(reading.lnP),
    of("solid"),
    of("ring"),
    cost(quality),
    two(count(quality.triangles), `${Math.round(share * 100)} %`),
  ];
  cells.forEach((cell, i) => (cell.dataset["head"] = HEADS[i + 1]!)); // where there is no room for a table
  return cells;
}

/** What a file's numbers are rounded to, as a part of the diagonal. */
const ROUNDING = 1e-7;

/** A distance as a part of the diagonal. */
function part(rel: number | null): string {
  return rel === null ? "–" : rel < ROUNDING ? "0" : percent(rel);
}

async function saveCopy({ copy }: Attempt): Promise<void> {
  if (copy) {
    const model = await copy();
    save(model.name, model.bytes, isGltf(model) ? "model/gltf+json" : "model/gltf-binary");
  }
}
