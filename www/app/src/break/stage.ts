/** The left side: the marked model, and beside it the copy that was last attacked. */
import type { Inspection } from "meshmark";
import { find, h, instantiate } from "../dom";
import { startIntake } from "../intake";
import type { Model } from "../model";
import type { Showing, StageEvents } from "../stage";
import { bytes, count } from "../words";
import type { Copy, Level } from "./attempt";
import type { Pair, PairLook } from "./pair";

export class BreakStage implements Showing {
  readonly #intake: HTMLElement;
  readonly #viewing = h("div", { class: "viewing", hidden: "" });
  readonly #copyWords: HTMLElement;
  #pair: Pair | undefined;
  #look: PairLook = { wireframe: false, raking: false };
  /** Counts what is shown on either side: a slow one that has been replaced must not appear. */
  #turn = 0;
  /** How many models are on their way to a canvas. */
  #numLoading = 0;

  constructor(view: HTMLElement, events: StageEvents) {
    this.#intake = find("[data-intake]", view);
    startIntake(this.#intake, events);
    this.#viewing.append(instantiate("#break-viewer"));
    find("[data-stage]", view).append(this.#viewing);
    this.#copyWords = find("[data-copy-words]", this.#viewing);
    for (const name of ["wireframe", "raking"] as const) {
      this.#tool(name).addEventListener("click", () => {
        this.#look = { ...this.#look, [name]: !this.#look[name] };
        this.#tool(name).setAttribute("aria-pressed", String(this.#look[name]));
        this.#pair?.look(this.#look);
      });
    }
    this.#tool("fit").addEventListener("click", () => this.#pair?.fit());
    this.#tool("reset").addEventListener("click", () => this.#pair?.reset());
    this.#tool("close").addEventListener("click", () => events.onClose());
  }

  async show(model: Model, inspection: Inspection | null): Promise<void> {
    const turn = ++this.#turn;
    const facts = inspection ? `${count(inspection.vertices)} vertices · ${count(inspection.triangles)} triangles` : bytes(model.bytes.length);
    find(".facts", this.#viewing).replaceChildren(h("strong", {}, model.name), h("span", {}, facts));
    this.#intake.hidden = true;
    this.#viewing.hidden = false;
    this.describeCopy("Nothing tried yet", "", null);
    await this.#preview(turn, (pair) => pair.showMarked(model));
  }

  /** Shows a copy beside the model, in place of any other. */
  async showCopy(copy: Copy): Promise<void> {
    const turn = ++this.#turn;
    await this.#preview(turn, async (pair) => pair.showCopy(await copy(), () => turn === this.#turn));
  }

  /** Takes the copy away again. */
  dropCopy(): void {
    this.#turn++;
    this.#pair?.dropCopy();
  }

  /** Says what the copy is, or is going to be, and what came of it. */
  describeCopy(title: string, came: string, level: Level | null): void {
    const words = h("span", { class: "came" }, came);
    words.dataset["level"] = level ?? "";
    this.#copyWords.replaceChildren(h("strong", {}, title), words);
  }

  close(): void {
    this.#turn++;
    this.#pair?.clear();
    this.#viewing.hidden = true;
    this.#intake.hidden = false;
    find("button", this.#intake).focus();
  }

  async #preview(turn: number, show: (pair: Pair) => Promise<void>): Promise<void> {
    const none = find(".no-preview", this.#viewing);
    this.#load(1);
    try {
      await show(await this.#loadPair());
      none.hidden = true;
    } catch (error) {
      console.warn("No preview:", error);
      none.hidden = turn !== this.#turn;
    }
    this.#load(-1);
  }

  #load(change: 1 | -1): void {
    this.#numLoading += change;
    this.#viewing.setAttribute("aria-busy", String(this.#numLoading > 0));
  }

  /** three.js comes with the first model. */
  async #loadPair(): Promise<Pair> {
    const { Pair } = await import("./pair");
    const [marked, copy] = [...this.#viewing.querySelectorAll<HTMLCanvasElement>(".viewer > canvas")];
    return (this.#pair ??= new Pair(marked!, copy!));
  }

  #tool(name: string): HTMLElement {
    return find(`[data-tool="${name}"]`, this.#viewing);
  }
}
