/** The left side: the marked model, and beside it the copy that was last attacked. */
import type { Inspection } from "meshmark";
import { find, h } from "../dom";
import type { Model } from "../model";
import { factsOf, Showing, type StageEvents } from "../showing";
import type { Copy, Level } from "./attempt";
import type { Pair, PairLook } from "./pair";

export class BreakStage extends Showing {
  readonly #copyWords: HTMLElement;
  #pair: Pair | undefined;
  #look: PairLook = { wireframe: false, raking: false };
  /** Counts what is shown on either side: a slow one that has been replaced must not appear. */
  #turn = 0;

  constructor(view: HTMLElement, events: StageEvents) {
    super(view, "#break-viewer", events);
    this.#copyWords = find("[data-copy-words]", this.viewing);
    for (const name of ["wireframe", "raking"] as const) {
      this.tool(name).addEventListener("click", () => {
        this.#look = { ...this.#look, [name]: !this.#look[name] };
        this.tool(name).setAttribute("aria-pressed", String(this.#look[name]));
        this.#pair?.look(this.#look);
      });
    }
    this.tool("fit").addEventListener("click", () => this.#pair?.fit());
    this.tool("reset").addEventListener("click", () => this.#pair?.reset());
  }

  async show(model: Model, inspection: Inspection | null): Promise<void> {
    this.facts(model.name, ...factsOf(model, inspection));
    this.describeCopy("Nothing tried yet", "", null);
    await this.#bring((pair) => pair.showMarked(model));
  }

  /** Shows a copy beside the model, in place of any other. */
  async showCopy(copy: Copy): Promise<void> {
    await this.#bring(async (pair, isWanted) => pair.showCopy(await copy(), isWanted));
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

  protected clear(): void {
    this.#turn++;
    this.#pair?.clear();
  }

  async #bring(show: (pair: Pair, isWanted: () => boolean) => Promise<void>): Promise<void> {
    const turn = ++this.#turn;
    const isWanted = () => turn === this.#turn;
    await this.draw(isWanted, async () => show(await this.#loadPair(), isWanted));
  }

  /** three.js comes with the first model. */
  async #loadPair(): Promise<Pair> {
    const { Pair } = await import("./pair");
    const [marked, copy] = this.canvases();
    return (this.#pair ??= new Pair(marked!, copy!));
  }
}
