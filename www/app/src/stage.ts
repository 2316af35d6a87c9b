/** The left side of a view: the empty state that teaches, or the model and the tools to look at it. */
import type { EmbedReport, Inspection } from "meshmark";
import { find, h, instantiate } from "./dom";
import { startIntake, type IntakeEvents } from "./intake";
import type { Model } from "./model";
import { drawLegend } from "./viewer/colormap";
import type { Look, Viewer } from "./viewer/viewer";
import { bytes, count, percent, significant } from "./words";

export interface StageEvents extends IntakeEvents {
  onClose(): void;
}

/** The left side of a view as a view knows it. */
export interface Showing {
  show(model: Model, inspection: Inspection | null): Promise<void>;
  close(): void;
}

/** What is chosen by one of several buttons, each of which names its choice in the attribute `data-` and this. */
const SEGMENTS = ["version", "shading", "normals"] as const;

export class Stage implements Showing {
  readonly #root: HTMLElement;
  readonly #intake: HTMLElement;
  readonly #viewing = h("div", { class: "viewing", hidden: "" });
  readonly #facts: HTMLElement;
  readonly #canvas: HTMLCanvasElement;
  #viewer: Viewer | undefined;
  /** Counts the models shown: a slow one that has been replaced must not appear. */
  #turn = 0;
  /** How many models are on their way to the canvas. */
  #numLoading = 0;

  constructor(view: HTMLElement, events: StageEvents) {
    this.#root = find("[data-stage]", view);
    this.#intake = find("[data-intake]", view);
    this.#viewing.append(instantiate("#viewer"));
    this.#facts = find(".facts", this.#viewing);
    this.#root.append(this.#viewing);
    this.#canvas = find<HTMLCanvasElement>(".viewer > canvas", this.#viewing);
    drawLegend(find<HTMLCanvasElement>(".legend canvas", this.#viewing));
    startIntake(this.#intake, events);
    this.#startTools(events);
  }

  /** Shows a model, its facts in words beside it. */
  async show(model: Model, inspection: Inspection | null): Promise<void> {
    const turn = ++this.#turn;
    this.#facts.replaceChildren(h("strong", {}, model.name), h("span", {}, inspection ? factsOf(inspection) : bytes(model.bytes.length)));
    this.#intake.hidden = true;
    this.#viewing.hidden = false;
    this.#offer({ marked: false, normals: false });
    this.#pressAll({ version: "before", shading: "surface", normals: "geometry", wireframe: false });
    await this.#preview(turn, async () => {
      const { loadScene, viewer } = await this.#loadViewer();
      viewer.clear();
      const scene = await loadScene(model);
      if (turn === this.#turn) {
        viewer.showBefore(scene);
        this.#offer({ marked: false, normals: viewer.hasNormals });
      }
    });
  }

  /** Adds a marked copy of the model that is shown, in place of any other; looked at in the same way, unless `change` says how. */
  async showMarked(model: Model, report: EmbedReport, change: Partial<Look> = {}): Promise<void> {
    const turn = this.#turn;
    await this.#preview(turn, async () => {
      const { loadScene, viewer } = await this.#loadViewer();
      const scene = await loadScene(model);
      if (turn === this.#turn) {
        const max = viewer.showAfter(scene);
        this.#setLegend(max, report.diagonal);
        this.#offer({ marked: true, normals: viewer.hasNormals });
        this.#pressAll(change);
      }
    });
  }

  /** Takes the marked copy away again. */
  dropMarked(): void {
    this.#turn++;
    this.#viewer?.dropAfter();
    this.#offer({ marked: false, normals: this.#viewer?.hasNormals ?? false });
    this.#pressAll({ version: "before", shading: "surface" });
  }

  close(): void {
    this.#turn++;
    this.#viewer?.clear();
    this.#viewing.hidden = true;
    this.#intake.hidden = false;
    find("button", this.#intake).focus();
  }

  async #preview(turn: number, show: () => Promise<void>): Promise<void> {
    const none = find(".no-preview", this.#viewing);
    none.hidden = true;
    this.#load(1);
    try {
      await show();
    } catch (error) {
      console.warn("No preview:", error);
      none.hidden = turn !== this.#turn;
    }
    this.#load(-1);
    this.#canvas.hidden = !none.hidden;
    for (const button of this.#viewing.querySelectorAll<HTMLButtonElement>(".toolbar button")) {
      button.disabled = !none.hidden;
    }
  }

  #load(change: 1 | -1): void {
    this.#numLoading += change;
    this.#viewing.setAttribute("aria-busy", String(this.#numLoading > 0));
  }

  /** three.js comes with the first model. */
  async #loadViewer() {
    const [{ Viewer }, { loadScene }] = await Promise.all([import("./viewer/viewer"), import("./viewer/load")]);
    this.#viewer ??= new Viewer(this.#canvas);
    return { loadScene, viewer: this.#viewer };
  }

  #startTools(events: StageEvents): void {
    for (const kind of SEGMENTS) {
      for (const button of this.#segments(kind)) {
        button.addEventListener("click", () => this.#pressAll({ [kind]: button.dataset[kind] }));
      }
    }
    const wireframe = this.#tool("wireframe");
    wireframe.addEventListener("click", () => this.#pressAll({ wireframe: wireframe.getAttribute("aria-pressed") !== "true" }));
    this.#tool("fit").addEventListener("click", () => this.#viewer?.fit());
    this.#tool("reset").addEventListener("click", () => this.#viewer?.reset());
    this.#tool("close").addEventListener("click", () => events.onClose());
  }

  #tool(name: string): HTMLElement {
    return find(`[data-tool="${name}"]`, this.#viewing);
  }

  #segments(kind: (typeof SEGMENTS)[number]): HTMLElement[] {
    return [...this.#viewing.querySelectorAll<HTMLElement>(`[data-${kind}]`)];
  }

  /** Presses the buttons that stand for a look, and looks at the model so. */
  #pressAll(change: Partial<Look>): void {
    for (const kind of SEGMENTS.filter((name) => change[name] !== undefined)) {
      for (const button of this.#segments(kind)) {
        button.setAttribute("aria-pressed", String(button.dataset[kind] === change[kind]));
      }
    }
    if (change.wireframe !== undefined) {
      this.#tool("wireframe").setAttribute("aria-pressed", String(change.wireframe));
    }
    if (change.shading !== undefined) {
      find(".legend", this.#viewing).hidden = change.shading !== "heat";
      this.#tool("normals").dataset["shading"] = change.shading;
    }
    this.#viewer?.look(change);
  }

  /** Shows the tools for what there is to see: a marked copy, and normals of the file's own. */
  #offer({ marked, normals }: { marked: boolean; normals: boolean }): void {
    this.#tool("versions").hidden = find('[data-shading="heat"]', this.#viewing).hidden = !marked;
    this.#tool("normals").hidden = !normals;
  }

  #setLegend(max: number, diagonal: number): void {
    const scale = (name: string, value: (of: number) => string) => {
      const marks = [0, max / 2, max].map((of) => h("span", {}, value(of)));
      find(`[data-legend="${name}"]`, this.#viewing).replaceChildren(...marks);
    };
    scale("units", (of) => (of === 0 ? "0" : `${significant(of)} units`));
    scale("percent", (of) => (of === 0 ? "0" : percent(of / diagonal)));
  }
}

function factsOf({ vertices, triangles, bytes: size }: Inspection): string {
  return `${count(vertices)} vertices · ${count(triangles)} triangles · ${bytes(size)}`;
}
