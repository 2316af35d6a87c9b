/** Several steps that are done one upon the other: chips, each of which can be taken away. */
import { announce, button, find, h } from "../dom";
import { capital, type Step } from "./words";

export class Chain {
  readonly #list: HTMLElement;
  readonly #hint: HTMLElement;
  readonly #buttons: HTMLButtonElement[];
  #steps: Step[] = [];

  constructor(root: HTMLElement, onTry: (steps: Step[]) => void) {
    this.#list = find("ol", root);
    this.#hint = find(".hint", root);
    const attempt = button("Try the chain", () => onTry(this.#steps), "primary");
    this.#buttons = [attempt, button("Clear", () => this.#become([], "The chain is empty."))];
    find(".actions", root).append(...this.#buttons);
    this.#become([]);
  }

  add(step: Step): void {
    this.#become([...this.#steps, step], `${step.words} is step ${this.#steps.length + 1} of the chain.`);
  }

  clear(): void {
    this.#become([]);
  }

  #become(steps: Step[], said = ""): void {
    this.#steps = steps;
    const chip = ({ words }: Step, i: number) => {
      const remove = button("×", () => {
        this.#become(steps.toSpliced(i, 1), `${words} is no longer in the chain.`);
        (this.#list.children[i] ?? this.#list.lastElementChild)?.querySelector("button")?.focus();
      });
      remove.setAttribute("aria-label", `Take ${words} out of the chain`);
      return h("li", { class: "chip" }, h("span", {}, capital(words)), remove);
    };
    this.#list.replaceChildren(...steps.map(chip));
    this.#list.hidden = steps.length === 0;
    this.#hint.hidden = steps.length > 0;
    this.#buttons.forEach((control) => (control.disabled = steps.length === 0));
    if (said) {
      announce(said);
    }
  }
}
