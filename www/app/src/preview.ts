/** What a strength does to this model, beside the choice of it: how far vertices move, and what the mark would survive. */
import type { EmbedReport } from "meshmark";
import { announce, find, h } from "./dom";
import { displacement, forecastList } from "./outcome";
import type { Listener } from "./trial";
import { losses, problem, STAGES } from "./words";

export class Preview {
  readonly #root = find("#preview");
  readonly #words = find("#preview-state");
  readonly #bar = find<HTMLProgressElement>("#preview progress");
  readonly #content = find("#preview-content");

  /** Hears how a trial goes on. What the one before said stays, faint, until this one has something to say. */
  readonly listener: Listener = {
    stage: (name) => this.#work(`${STAGES[name]} …`, null),
    onProgress: (name, fraction) => this.#work(`${STAGES[name]} …`, fraction),
  };

  hide(): void {
    this.#root.hidden = true;
    this.#content.replaceChildren();
  }

  show(report: EmbedReport, isExact: boolean): void {
    const lost = losses(report.forecast);
    this.#say(isExact ? "" : "Tried with a key made for this preview. With yours, these figures may differ.");
    this.#content.replaceChildren(displacement(report), forecastList(report.forecast));
    announce(`Preview ready. ${lost ?? "The mark should survive all that was tried."}`);
  }

  fail(error: unknown): void {
    this.#say(`No preview: ${problem(error).text}.`);
    this.#content.replaceChildren();
  }

  #work(words: string, fraction: number | null): void {
    this.#root.hidden = this.#bar.hidden = false;
    this.#root.setAttribute("aria-busy", "true");
    this.#words.textContent = words;
    if (fraction === null) {
      this.#bar.removeAttribute("value");
    } else {
      this.#bar.value = fraction;
    }
  }

  #say(words: string): void {
    this.#root.hidden = false;
    this.#bar.hidden = true;
    this.#root.setAttribute("aria-busy", "false");
    this.#words.textContent = words;
  }
}
