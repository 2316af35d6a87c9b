/** The survival map: every attack at every level, filled in while it is tried. */
import type { Family } from "../../research-wasm/research.js";
import { announce, button, h } from "../dom";
import type { Attempt } from "./attempt";
import { cameOf, capital, FAMILIES, LEFT, type Choice, type Step } from "./words";

export interface MapEvents {
  /** An attempt at one step, not begun. */
  attempt(step: Step): Attempt;
  onFill(attempts: Attempt[]): void;
  onChoose(attempt: Attempt): void;
}

export class SurvivalMap {
  readonly root = h("div", { class: "map" });
  readonly #families = h("div", { class: "families" });
  #attempts: Attempt[] = [];
  readonly #words = h("span", { class: "words" });
  readonly #bar = h("progress", { "aria-label": "Progress of the map" });
  readonly #fill: HTMLButtonElement;
  readonly #cancel: HTMLButtonElement;
  readonly #anew: HTMLButtonElement;
  readonly #events: MapEvents;

  constructor(
    readonly choices: Choice[],
    events: MapEvents,
  ) {
    this.#events = events;
    this.#fill = button("Fill the map", () => this.#begin(), "primary");
    this.#cancel = button("Cancel", () => this.#stop());
    this.#anew = button("Start over", () => this.reset());
    const legend = Object.values(LEFT).map(({ sign, legend }, i) => h("li", { "data-level": Object.keys(LEFT)[i]! }, h("span", { "aria-hidden": "true" }, sign), legend));
    this.root.append(h("div", { class: "map-state" }, this.#fill, this.#cancel, this.#anew, this.#bar, this.#words), h("ul", { class: "map-legend" }, ...legend), this.#families);
    this.reset();
  }

  /** Whether nothing has been tried or asked for. */
  get isUntouched(): boolean {
    return this.#attempts.every(({ state }) => state === "idle");
  }

  /** Begins anew, with attempts that are made now. */
  reset(): void {
    this.#attempts.forEach((attempt) => attempt.cancel());
    this.#attempts = [];
    this.#families.replaceChildren(...(Object.keys(FAMILIES) as Family[]).map((family) => this.#family(family)));
    this.#tell();
  }

  #begin(): void {
    this.#events.onFill(this.#open());
    this.#cancel.focus();
  }

  #stop(): void {
    this.#attempts.forEach((attempt) => attempt.cancel());
    this.#fill.focus();
  }

  #open(): Attempt[] {
    return this.#attempts.filter(({ isOpen }) => isOpen);
  }

  #family(family: Family): HTMLElement {
    const { name } = FAMILIES[family];
    const rows = this.choices.filter((choice) => choice.family === family).map((choice) => this.#row(choice));
    return h("section", { "aria-label": name }, h("h3", {}, name), h("ul", {}, ...rows));
  }

  #row({ name, steps }: Choice): HTMLElement {
    return h("li", {}, h("span", { class: "name" }, capital(name)), h("span", { class: "cells" }, ...steps.map((step) => this.#cell(step))));
  }

  #cell(step: Step): HTMLElement {
    const attempt = this.#events.attempt(step);
    this.#attempts.push(attempt);
    const sign = h("span", { class: "sign", "aria-hidden": "true" });
    const cell = h("button", { type: "button", class: "cell" }, sign, h("span", {}, step.level));
    cell.addEventListener("click", () => this.#events.onChoose(attempt));
    let last = "";
    const draw = () => {
      if (last !== attempt.state) {
        last = attempt.state;
        const level = attempt.state === "done" ? attempt.finding?.level : undefined;
        cell.dataset["state"] = attempt.state;
        cell.dataset["level"] = level ?? "";
        sign.textContent = level ? LEFT[level].sign : { idle: "·", cancelled: "·", waiting: "·", running: "…", done: "", failed: "!" }[attempt.state];
        cell.title = `${attempt.title}: ${cameOf(attempt)}`;
        cell.setAttribute("aria-label", cell.title);
        this.#tell();
      }
    };
    attempt.onChange(draw);
    draw();
    return cell;
  }

  /** Says how full the map is. */
  #tell(): void {
    const isBusy = this.#attempts.some(({ state }) => state === "waiting" || state === "running");
    const [left, total] = [this.#open().length, this.#attempts.length];
    const ended = this.#attempts.filter(({ state }) => state === "done" || state === "failed");
    const failed = ended.filter(({ state }) => state === "failed").length;
    const green = ended.filter(({ state, finding }) => state === "done" && finding?.level === "green").length;
    const wasBusy = !this.#cancel.hidden;
    this.#fill.hidden = isBusy || left === 0;
    this.#fill.textContent = ended.length > 0 ? "Fill the rest" : "Fill the map";
    this.#cancel.hidden = this.#bar.hidden = !isBusy;
    this.#anew.hidden = isBusy || ended.length === 0;
    this.#bar.max = total;
    this.#bar.value = ended.length;
    this.#words.textContent = ended.length > 0 ? `${ended.length} of ${total} tried · found after ${green}${failed > 0 ? ` · ${failed} failed` : ""}` : `${total} to try`;
    if (wasBusy && !isBusy && left === 0) {
      announce(`The map is full: found after ${green} of ${total}.`);
    }
  }
}
