/** A model and its marked copy, and the tools to look at both. */
import type { EmbedReport, Inspection } from "meshmark";
import { find, h } from "./dom";
import { isEvidence, type Model } from "./model";
import { factsOf, Showing, type StageEvents } from "./showing";
import { drawLegend } from "./viewer/colormap";
import type { Look, Viewer } from "./viewer/viewer";
import { percent, significant } from "./words";

/** What is chosen by one of several buttons, each of which names its choice in the attribute `data-` and this. */
const SEGMENTS = ["version", "shading", "normals"] as const;

export class Stage extends Showing {
  protected viewer: Viewer | undefined;
  /** Counts the models shown, and the copies: a slow one that has been replaced must not appear. */
  #turn = 0;
  #copyTurn = 0;
  /** Whether the model itself came to stand there. */
  #isDrawn: Promise<boolean> = Promise.resolve(false);

  constructor(view: HTMLElement, events: StageEvents) {
    super(view, "#viewer", events);
    drawLegend(find<HTMLCanvasElement>(".legend canvas", this.viewing));
    this.#startTools();
  }

  /** Shows a model, its facts in words beside it. */
  async show(model: Model, inspection: Inspection | null): Promise<void> {
    const turn = ++this.#turn;
    const isWanted = () => turn === this.#turn;
    this.facts(model.name, ...factsOf(model, inspection));
    this.#offer({ marked: false, normals: false });
    this.#pressAll({ version: "before", shading: "surface", normals: "geometry", wireframe: false });
    if (isEvidence(model)) {
      this.rest("Evidence has no picture: it is what was measured of a model, without the model.");
      return;
    }
    this.#isDrawn = this.draw(isWanted, async () => {
      const { loadScene, viewer } = await this.loadViewer();
      const scene = await loadScene(model);
      if (isWanted()) {
        viewer.showBefore(scene);
        this.#offer({ marked: false, normals: viewer.hasNormals });
      }
    });
    await this.#isDrawn;
  }

  /** Adds a marked copy of the model that is shown, in place of any other; looked at in the same way, unless `change` says how. */
  async showMarked(model: Model, report: EmbedReport, change: Partial<Look> = {}): Promise<void> {
    const [turn, copyTurn] = [this.#turn, ++this.#copyTurn];
    const isWanted = () => turn === this.#turn && copyTurn === this.#copyTurn;
    if (!(await this.#isDrawn) || !isWanted()) {
      return; // without the one there is nothing to compare the other with
    }
    await this.draw(isWanted, async () => {
      const { loadScene, viewer } = await this.loadViewer();
      const scene = await loadScene(model);
      if (isWanted()) {
        const max = viewer.showAfter(scene);
        this.#setLegend(max, report.diagonal);
        this.#offer({ marked: true, normals: viewer.hasNormals });
        this.#pressAll(change);
      }
    });
  }

  /** Takes the marked copy away again. */
  dropMarked(): void {
    this.#copyTurn++;
    this.viewer?.dropAfter();
    this.#offer({ marked: false, normals: this.viewer?.hasNormals ?? false });
    this.#pressAll({ version: "before", shading: "surface" });
  }

  protected clear(): void {
    this.#turn++;
    this.viewer?.clear();
  }

  /** three.js comes with the first model. */
  protected async loadViewer() {
    const [{ Viewer }, { loadScene }] = await Promise.all([import("./viewer/viewer"), import("./viewer/load")]);
    this.viewer ??= new Viewer(this.canvases()[0]!);
    return { loadScene, viewer: this.viewer };
  }

  #startTools(): void {
    for (const kind of SEGMENTS) {
      for (const button of this.#segments(kind)) {
        button.addEventListener("click", () => this.#pressAll({ [kind]: button.dataset[kind] }));
      }
    }
    const wireframe = this.tool("wireframe");
    wireframe.addEventListener("click", () => this.#pressAll({ wireframe: wireframe.getAttribute("aria-pressed") !== "true" }));
    this.tool("fit").addEventListener("click", () => this.viewer?.fit());
    this.tool("reset").addEventListener("click", () => this.viewer?.reset());
  }

  #segments(kind: (typeof SEGMENTS)[number]): HTMLElement[] {
    return [...this.viewing.querySelectorAll<HTMLElement>(`[data-${kind}]`)];
  }

  /** Presses the buttons that stand for a look, and looks at the model so. */
  #pressAll(change: Partial<Look>): void {
    for (const kind of SEGMENTS.filter((name) => change[name] !== undefined)) {
      for (const button of this.#segments(kind)) {
        button.setAttribute("aria-pressed", String(button.dataset[kind] === change[kind]));
      }
    }
    if (change.wireframe !== undefined) {
      this.tool("wireframe").setAttribute("aria-pressed", String(change.wireframe));
    }
    if (change.shading !== undefined) {
      find(".legend", this.viewing).hidden = change.shading !== "heat";
      this.tool("normals").dataset["shading"] = change.shading;
    }
    this.viewer?.look(change);
  }

  /** Shows the tools for what there is to see: a marked copy, and normals of the file's own. */
  #offer({ marked, normals }: { marked: boolean; normals: boolean }): void {
    this.tool("versions").hidden = find('[data-shading="heat"]', this.viewing).hidden = !marked;
    this.tool("normals").hidden = !normals;
  }

  #setLegend(max: number, diagonal: number): void {
    const scale = (name: string, value: (of: number) => string) => {
      const marks = [0, max / 2, max].map((of) => h("span", {}, value(of)));
      find(`[data-legend="${name}"]`, this.viewing).replaceChildren(...marks);
    };
    scale("units", (of) => (of === 0 ? "0" : `${significant(of)} units`));
    scale("percent", (of) => (of === 0 ? "0" : percent(of / diagonal)));
  }
}

