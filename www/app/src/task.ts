/** One piece of work from its beginning to its end: its progress in words, and a way to stop it. */
import type { OnProgress, Stage } from "meshmark";
import { announce, button, h } from "./dom";
import { STAGES } from "./words";

export interface Progress {
  signal: AbortSignal;
  stage(stage: Stage | "key"): void;
  onProgress: OnProgress;
}

/** Work whose steps have words of their own. */
export interface Task extends Progress {
  /** What is worked at from now on, where it is several things one after another. */
  headline(text: string): void;
  /** @param fraction of the whole, from 0 to 1 */
  say(words: string, fraction: number): void;
}

/** A task with its card, whose button ends it. */
export class Job {
  readonly card: HTMLElement;
  readonly task: Task;
  readonly #controller = new AbortController();

  constructor(headline: string) {
    const [title, words] = [h("h2", {}, headline), h("p")];
    const bar = h("progress", { "aria-label": "Progress of this step" });
    this.card = h("section", { class: "card working", "aria-label": "Progress" }, title, words, bar, button("Cancel", () => this.end()));
    const stage = (name: Stage | "key") => {
      if (words.dataset["stage"] !== name) {
        words.dataset["stage"] = name;
        words.textContent = `${STAGES[name]} …`;
        announce(STAGES[name]);
        bar.removeAttribute("value");
      }
    };
    this.task = {
      signal: this.#controller.signal,
      stage,
      onProgress: (name, fraction) => {
        stage(name);
        if (name === "test") {
          words.textContent = `${STAGES.test} … ${Math.round(fraction * 100)} % tried`; // one after another: what may have been done to the model
        }
        bar.value = fraction;
      },
      headline: (text) => {
        title.textContent = text;
        delete words.dataset["stage"];
      },
      say: (text, fraction) => {
        words.textContent = text;
        bar.value = fraction;
      },
    };
  }

  end(): void {
    this.#controller.abort();
  }
}
