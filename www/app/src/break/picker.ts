/** The attacks to choose from: by family, each with its levels on a slider. */
import type { Family } from "../../research-wasm/research.js";
import { button, h } from "../dom";
import { capital, FAMILIES, type Choice, type Step } from "./words";

export interface PickerEvents {
  onTry(step: Step): void;
  onAdd(step: Step): void;
}

/** One folding list for each family, the first one open. */
export function picker(choices: Choice[], events: PickerEvents): HTMLElement[] {
  const families = (Object.keys(FAMILIES) as Family[]).filter((family) => choices.some((choice) => choice.family === family));
  return families.map((family, i) => {
    const rows = choices.filter((choice) => choice.family === family).map((choice) => row(choice, events));
    const { name, hint } = FAMILIES[family];
    const list = h("details", { class: "family", name: "attacks" }, h("summary", {}, name), h("p", { class: "hint" }, hint), h("ul", {}, ...rows));
    list.open = i === 0;
    return list;
  });
}

function row({ name, steps }: Choice, { onTry, onAdd }: PickerEvents): HTMLElement {
  let step = steps[0]!;
  const level = h("output", { class: "level" });
  const attempt = button("Try", () => onTry(step));
  const add = button("+", () => onAdd(step), "add");
  add.title = "Add to the chain";
  const choose = (i: number) => {
    step = steps[i]!;
    level.textContent = step.level;
    attempt.setAttribute("aria-label", `Try ${step.words}`);
    add.setAttribute("aria-label", `Add ${step.words} to the chain`);
  };
  const middle = Math.floor((steps.length - 1) / 2);
  choose(middle);
  const slider = steps.length > 1 ? [levelSlider(name, steps, middle, choose)] : [];
  return h("li", {}, h("span", { class: "name" }, capital(name)), level, ...slider, attempt, add);
}

function levelSlider(name: string, steps: Step[], first: number, choose: (i: number) => void): HTMLInputElement {
  const slider = h("input", { type: "range", min: "0", max: String(steps.length - 1), value: String(first), "aria-label": `Level of ${name}` });
  const tell = () => slider.setAttribute("aria-valuetext", steps[slider.valueAsNumber]!.level);
  slider.addEventListener("input", () => {
    choose(slider.valueAsNumber);
    tell();
  });
  tell();
  return slider;
}
