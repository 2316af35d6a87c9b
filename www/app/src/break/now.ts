/** What is tried now, at the edge of a small screen: models and rows are out of sight there when an attack is chosen. */
import { button, h } from "../dom";
import type { Level } from "./attempt";

export class Now {
  readonly #title = h("strong");
  readonly #came = h("span", { class: "came" });

  /** @param onSee a person wants to see more of it */
  constructor(
    readonly root: HTMLElement,
    onSee: () => void,
  ) {
    root.append(h("p", {}, this.#title, this.#came), button("See", onSee));
  }

  /** @param level what is left of the mark, once it is known */
  tell(title: string, came: string, level: Level | null): void {
    this.root.hidden = false;
    this.#title.textContent = title;
    this.#came.textContent = came;
    this.#came.dataset["level"] = level ?? "";
  }

  hide(): void {
    this.root.hidden = true;
  }
}
