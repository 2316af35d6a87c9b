/** The left side of a view: the empty state that teaches, or the model and the tools to look at it. */
import type { EmbedReport, Inspection } from "meshmark";
import { find, h, instantiate } from "./dom";
import type { Model, NamedFile } from "./model";
import { drawLegend } from "./viewer/colormap";
import type { Version, Viewer } from "./viewer/viewer";
import { bytes, count, percent, significant } from "./words";

export interface StageEvents {
  onFiles(files: NamedFile[]): void;
  onDemo(): void;
  onClose(): void;
}

export class Stage {
  readonly #root: HTMLElement;
  readonly #intake: HTMLElement;
  readonly #viewing = h("div", { class: "viewing", hidden: "" });
  readonly #facts = h("p", { class: "facts" });
  readonly #canvas: HTMLCanvasElement;
  #viewer: Viewer | undefined;
  /** Counts the models shown: a slow one that has been replaced must not appear. */
  #turn = 0;

  constructor(view: HTMLElement, events: StageEvents) {
    this.#root = find("[data-stage]", view);
    this.#intake = find("[data-intake]", view);
    this.#intake.append(instantiate("#intake-actions"));
    this.#viewing.append(this.#facts, instantiate("#viewer"));
    this.#root.append(this.#viewing);
    this.#canvas = find<HTMLCanvasElement>(".viewer > canvas", this.#viewing);
    drawLegend(find<HTMLCanvasElement>(".legend canvas", this.#viewing));
    this.#startIntake(events);
    this.#startTools(events);
  }

  /** Shows a model, its facts in words beside it. */
  async show(model: Model, inspection: Inspection | null): Promise<void> {
    const turn = ++this.#turn;
    this.#facts.replaceChildren(h("strong", {}, model.name), h("span", {}, inspection ? factsOf(inspection) : bytes(model.bytes.length)));
    this.#intake.hidden = true;
    this.#viewing.hidden = false;
    this.#setVersions(false);
    this.#press("wireframe", false);
    await this.#preview(turn, async () => {
      const { loadScene, viewer } = await this.#loadViewer();
      viewer.clear();
      const scene = await loadScene(model);
      if (turn === this.#turn) {
        viewer.showBefore(scene);
      }
    });
  }

  /** Adds the marked copy of the model that is shown. */
  async showMarked(model: Model, report: EmbedReport): Promise<void> {
    const turn = this.#turn;
    await this.#preview(turn, async () => {
      const { loadScene, viewer } = await this.#loadViewer();
      const scene = await loadScene(model);
      if (turn === this.#turn) {
        viewer.dropAfter();
        const max = viewer.showAfter(scene);
        this.#setLegend(max, report.diagonal);
        this.#setVersions(true);
        this.#pressVersion("after");
      }
    });
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
    try {
      await show();
    } catch (error) {
      console.warn("No preview:", error);
      none.hidden = turn !== this.#turn;
    }
    this.#canvas.hidden = !none.hidden;
    for (const button of this.#viewing.querySelectorAll<HTMLButtonElement>(".toolbar button:not(.last)")) {
      button.disabled = !none.hidden;
    }
  }

  /** three.js comes with the first model. */
  async #loadViewer() {
    const [{ Viewer }, { loadScene }] = await Promise.all([import("./viewer/viewer"), import("./viewer/load")]);
    this.#viewer ??= new Viewer(this.#canvas);
    return { loadScene, viewer: this.#viewer };
  }

  #startIntake(events: StageEvents): void {
    for (const kind of ["files", "folder"]) {
      const input = find<HTMLInputElement>(`[data-input="${kind}"]`, this.#intake);
      find(`[data-choose="${kind}"]`, this.#intake).addEventListener("click", () => input.click());
      input.addEventListener("change", () => {
        const files = [...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
        input.value = ""; // so that the same file can be chosen again
        if (files.length > 0) {
          events.onFiles(files);
        }
      });
    }
    find('[data-choose="demo"]', this.#intake).addEventListener("click", () => events.onDemo());
  }

  #startTools(events: StageEvents): void {
    for (const name of ["heat", "wireframe"] as const) {
      this.#tool(name).addEventListener("click", () => this.#press(name, this.#tool(name).getAttribute("aria-pressed") !== "true"));
    }
    for (const version of ["before", "after"] as const) {
      find(`[data-version="${version}"]`, this.#viewing).addEventListener("click", () => this.#pressVersion(version));
    }
    this.#tool("fit").addEventListener("click", () => this.#viewer?.fit());
    this.#tool("reset").addEventListener("click", () => this.#viewer?.reset());
    this.#tool("close").addEventListener("click", () => events.onClose());
  }

  #tool(name: string): HTMLElement {
    return find(`[data-tool="${name}"]`, this.#viewing);
  }

  #press(name: "heat" | "wireframe", on: boolean): void {
    this.#tool(name).setAttribute("aria-pressed", String(on));
    this.#viewer?.look({ [name]: on });
    if (name === "heat") {
      find(".legend", this.#viewing).hidden = !on;
    }
  }

  #pressVersion(version: Version): void {
    for (const button of this.#viewing.querySelectorAll<HTMLElement>("[data-version]")) {
      button.setAttribute("aria-pressed", String(button.dataset["version"] === version));
    }
    this.#viewer?.look({ version });
  }

  #setVersions(both: boolean): void {
    this.#press("heat", false);
    this.#tool("versions").hidden = this.#tool("heat").hidden = !both;
  }

  #setLegend(max: number, diagonal: number): void {
    const legend = find(".legend", this.#viewing);
    find('[data-legend="title"]', legend).textContent = "Displacement";
    find('[data-legend="low"]', legend).textContent = "0";
    find('[data-legend="high"]', legend).textContent = `${significant(max)} units = ${percent(max / diagonal)} of the diagonal`;
  }
}

function factsOf({ vertices, triangles, bytes: size }: Inspection): string {
  return `${count(vertices)} vertices · ${count(triangles)} triangles · ${bytes(size)}`;
}
