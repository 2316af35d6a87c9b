/** What a strength does to this model, beside the choice of it: how far vertices move, and what the mark would survive. */
import type { EmbedReport } from "meshmark";
import { announce, button, find } from "./dom";
import { actions, displacement, forecastList } from "./outcome";
import type { Listener } from "./trial";
import { losses, problem, STAGES } from "./words";

export class Preview {
  readonly #root = find("#preview");
  readonly #words = find("#preview-state");
  readonly #bar = find<HTMLProgressElement>("#preview progress");
  readonly #content = find("#preview-content");

  /** @param onStronger a person wants the next strength */
  constructor(readonly onStronger: () => void) {}

  /** Hears how a trial goes on. What the one before said stays, faint, until this one has something to say. */
  readonly listener: Listener = {
    stage: (name) => this.#work(`${STAGES[name]} …`, null),
    onProgress: (name, fraction) => this.#work(`${STAGES[name]} …`, fraction),
  };

  hide(): void {
    this.#root.hidden = true;
    this.#content.replaceChildren();
  }

  /** @param isStrongerLeft whether there is a next strength */
  show(report: EmbedReport, isExact: boolean, isStrongerLeft: boolean): void {
    const lost = losses(report.forecast);
    this.#say(isExact ? "" : "Tried with a key made for this preview. With yours, these figures may differ.");
    const more = lost !== null && isStrongerLeft ? [actions(button("Try the next strength", this.onStronger))] : [];
    this.#content.replaceChildren(displacement(report), forecastList(report.forecast), ...more);
    announce(`Preview ready. ${lost ?? "The mark should survive all that was tried."}`);
  }

  fail(error: unknown): void {
    this.tell(`No preview: ${problem(error).text}.`);
  }

  /** Says why there is nothing to show. */
  tell(words: string): void {
    this.#say(words);
    this.#content.replaceChildren();
    announce(words);
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
