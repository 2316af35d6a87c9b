/** The left side of every view: the empty state that teaches, or a model, what it is in words, and the tools to look at it. */
import type { Inspection } from "meshmark";
import { announce, find, h, instantiate } from "./dom";
import { startIntake, type IntakeEvents } from "./intake";
import { isEvidence, missingFiles, sizeOf, type Model } from "./model";
import { bytes, count } from "./words";

export interface StageEvents extends IntakeEvents {
  onClose(): void;
}

export abstract class Showing {
  protected readonly viewing = h("div", { class: "viewing", hidden: "" });
  readonly #intake: HTMLElement;
  readonly #facts: HTMLElement;
  readonly #words: HTMLElement;
  #isOpening = false;
  /** How many models are on their way to a canvas. */
  #numLoading = 0;

  /** @param template what stands there with a model: with `.facts`, `.viewer`s with a canvas each, and a `.toolbar` */
  constructor(view: HTMLElement, template: string, events: StageEvents) {
    this.#intake = find("[data-intake]", view);
    startIntake(this.#intake, events);
    this.viewing.append(instantiate(template));
    find("[data-stage]", view).append(this.viewing);
    this.#facts = find(".facts", this.viewing);
    this.#facts.tabIndex = -1;
    this.#words = h("p", { class: "viewer-words", hidden: "" });
    find(".viewer", this.viewing).append(this.#words);
    this.tool("close").addEventListener("click", () => events.onClose());
  }

  /** Says at once that a model is being opened: a large one takes seconds. */
  open(name: string): void {
    const hadFocus = this.#intake.contains(document.activeElement);
    this.#intake.hidden = true;
    this.viewing.hidden = false;
    this.clear();
    this.facts(name);
    this.#isOpening = true;
    this.#setUsable(false, `Opening ${name} …`);
    announce(`Opening ${name}`);
    if (hadFocus) {
      this.#facts.focus(); // the button that had it is gone
    }
  }

  /** Shows the model that was opened, its facts in words beside it. */
  abstract show(model: Model, inspection: Inspection | null): Promise<void>;

  close(): void {
    this.clear();
    this.viewing.hidden = true;
    this.#intake.hidden = false;
    find("button", this.#intake).focus();
  }

  /** Takes everything off the canvas, and whatever is on the way to it. */
  protected abstract clear(): void;

  protected facts(name: string, ...facts: string[]): void {
    this.#facts.replaceChildren(h("strong", {}, name), ...facts.map((fact) => h("span", {}, fact)));
  }

  /**
   * Brings something to the canvas; where that fails, says why, rests the tools, and returns `false`.
   *
   * @param isWanted whether it still is, once it is there
   */
  protected async draw(isWanted: () => boolean, draw: () => Promise<void>): Promise<boolean> {
    this.#load(1);
    let isDrawn = false;
    try {
      if (!hasWebGl()) {
        throw new Error("this browser draws no 3D (it offers no WebGL 2)");
      }
      await draw();
      isDrawn = true;
      if (isWanted()) {
        this.#isOpening = false;
        this.#setUsable(true, "");
      }
    } catch (error) {
      console.warn("No preview:", error);
      if (isWanted()) {
        this.rest(`There is no picture: ${error instanceof Error ? error.message : String(error)}. All else works without it.`);
      }
    }
    this.#load(-1);
    return isDrawn;
  }

  /** Rests the tools, for there is nothing to see. */
  rest(words: string): void {
    this.#isOpening = false;
    this.#setUsable(false, words);
  }

  protected tool<E extends HTMLElement = HTMLElement>(name: string): E {
    return find<E>(`[data-tool="${name}"]`, this.viewing);
  }

  protected canvases(): HTMLCanvasElement[] {
    return [...this.viewing.querySelectorAll<HTMLCanvasElement>(".viewer > canvas")];
  }

  #setUsable(isUsable: boolean, words: string): void {
    this.#words.textContent = words;
    this.#words.hidden = isUsable;
    this.viewing.toggleAttribute("data-blank", !isUsable); // its canvases keep their sizes, which models are framed by
    for (const control of this.viewing.querySelectorAll<HTMLButtonElement | HTMLSelectElement>(".toolbar :is(button, select)")) {
      control.disabled = !isUsable;
    }
    this.#tellBusy();
  }

  #load(change: 1 | -1): void {
    this.#numLoading += change;
    this.#tellBusy();
  }

  #tellBusy(): void {
    this.viewing.setAttribute("aria-busy", String(this.#isOpening || this.#numLoading > 0));
  }
}

function hasWebGl(): boolean {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

/** What a model is, in a few words; also what of it is not there. */
export function factsOf(model: Model, inspection: Inspection | null): string[] {
  const size = bytes(sizeOf(model));
  if (isEvidence(model)) {
    return [`evidence · ${size}`];
  }
  const { images } = missingFiles(model);
  const lacking = images.length === 0 ? [] : [`without ${new Intl.ListFormat("en").format(images)}, which it names: the picture lacks that, the mark does not`];
  return [inspection ? `${count(inspection.vertices)} vertices · ${count(inspection.triangles)} triangles · ${size}` : size, ...lacking];
}
