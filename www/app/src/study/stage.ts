/** The left side of the study: the model's mesh as the paper's, its hosts, and what the colours mean. */
import type { Inspection } from "meshmark";
import type { Prepared, Fields, Tracing } from "../../research-wasm/research.js";
import { find, h } from "../dom";
import type { Model } from "../model";
import { Showing, type StageEvents } from "../showing";
import { drawLegend } from "../viewer/colormap";
import { count } from "../words";
import { FATES, PATH_SCALE, type Fate } from "./fate";
import { fieldOf, type Field, type FieldName } from "./field";
import { svg } from "./svg";
import type { Sight, StudyViewer, Version } from "./viewer";

/** How the mesh is looked at. */
export interface Look extends Pick<Sight, "version" | "hosts" | "paths" | "wireframe"> {
  field: FieldName | "none";
}

/** What there is to look at. */
export interface Findings {
  mesh: Prepared;
  tracing: Tracing | undefined;
  /** Of the mesh before, and of the smoothed one. */
  fields: Partial<Record<Version, Fields>>;
}

const FIRST_LOOK: Look = { version: "before", field: "none", hosts: "stability", paths: true, wireframe: false };

export class StudyStage extends Showing {
  /** Told when something else is to be seen. */
  onLook: () => void = () => {};
  look = FIRST_LOOK;
  readonly #legend: HTMLElement;
  #viewer: StudyViewer | undefined;
  #findings: Findings | undefined;

  constructor(view: HTMLElement, events: StageEvents) {
    super(view, "#study-viewer", events);
    this.#legend = find(".legend", this.viewing);
    this.#startTools();
  }

  /** The model's name; its mesh follows. */
  async show(model: Model, inspection: Inspection | null): Promise<void> {
    this.facts(model.name);
    if (!inspection) {
      this.rest("There is no picture.");
    }
  }

  /** Says what the model was brought to, and looks at it from the front. */
  async frame(name: string, mesh: Prepared, { vertices, triangles }: Inspection): Promise<void> {
    const now = `${count(mesh.positions.length / 3)} vertices · ${count(mesh.triangles.length / 3)} triangles`;
    const isWhole = mesh.triangles.length / 3 === triangles;
    this.facts(name, now, ...(isWhole ? [] : [`simplified to the paper’s size from ${count(vertices)} vertices · ${count(triangles)} triangles`]));
    await this.draw(
      () => true,
      async () => {
        const { StudyViewer } = await import("./viewer"); // three.js comes with the first model
        this.#viewer ??= new StudyViewer(this.canvases()[0]!);
        this.#viewer.frame(mesh);
      },
    );
  }

  update(findings: Findings): void {
    this.#findings = findings;
    this.#draw();
  }

  protected clear(): void {
    this.#findings = undefined;
    this.#viewer?.clear();
    this.#legend.hidden = true;
    this.#change(FIRST_LOOK);
  }

  #draw(): void {
    const { look } = this;
    if (!this.#findings) {
      return;
    }
    const { mesh, tracing, fields } = this.#findings;
    const field = look.field === "none" ? null : fieldOf(look.field, fields[look.version], tracing, mesh.diagonal);
    const cut = field && look.version === "before" ? { ...field, values: field.values.subarray(0, mesh.positions.length / 3) } : field;
    this.#viewer?.show({ ...look, mesh, tracing, field: cut });
    const areThereHosts = tracing !== undefined && look.hosts !== "none";
    const blocks = [
      ...(field ? [scaleOf(field)] : []),
      ...(areThereHosts ? [hostsLegend(look, tracing)] : []),
      ...(areThereHosts && look.paths ? [h("p", { class: "path" }, `path of a host, ${PATH_SCALE} times as long`)] : []),
    ];
    this.#legend.replaceChildren(...blocks);
    this.#legend.hidden = blocks.length === 0;
  }

  /** Looks in another way, and presses the buttons that stand for it. */
  #change(change: Partial<Look>): void {
    this.look = { ...this.look, ...change };
    for (const button of this.viewing.querySelectorAll<HTMLElement>("[data-version]")) {
      button.setAttribute("aria-pressed", String(button.dataset["version"] === this.look.version));
    }
    for (const name of ["paths", "wireframe"] as const) {
      this.tool(name).setAttribute("aria-pressed", String(this.look[name]));
    }
    for (const name of ["field", "hosts"] as const) {
      this.tool<HTMLSelectElement>(name).value = this.look[name];
    }
    this.#draw();
    this.onLook();
  }

  #startTools(): void {
    for (const button of this.viewing.querySelectorAll<HTMLElement>("[data-version]")) {
      button.addEventListener("click", () => this.#change({ version: button.dataset["version"] as Version }));
    }
    for (const name of ["paths", "wireframe"] as const) {
      this.tool(name).addEventListener("click", () => this.#change({ [name]: !this.look[name] }));
    }
    for (const name of ["field", "hosts"] as const) {
      const select = this.tool<HTMLSelectElement>(name);
      select.addEventListener("change", () => this.#change({ [name]: select.value }));
    }
    this.tool("fit").addEventListener("click", () => this.#viewer?.fit());
    this.tool("reset").addEventListener("click", () => this.#viewer?.reset());
  }
}

function scaleOf({ title, marks }: Pick<Field, "title" | "marks">): HTMLElement {
  const bar = h("canvas", { width: "256", height: "1", "aria-hidden": "true" });
  drawLegend(bar);
  const rows = marks.map((row) => h("p", { class: "scale" }, ...row.map((mark) => h("span", {}, mark))));
  return h("div", { class: "block" }, h("p", {}, title), bar, ...rows);
}

function hostsLegend({ hosts, version }: Look, { found }: Tracing): HTMLElement {
  if (hosts === "stability") {
    return scaleOf({ title: "Hosts by stability", marks: [["least stable", "", "most stable"]] });
  }
  const numFound = found.filter(Boolean).length;
  const numLost = found.length - numFound;
  const numbers: Record<Fate, number> = { found: numFound, lost: numLost, newcomer: numLost };
  const fates: Fate[] = version === "after" ? ["found", "lost", "newcomer"] : ["found", "lost"];
  return h("ul", { class: "signs" }, ...fates.map((fate) => h("li", {}, signOf(fate), h("span", {}, `${count(numbers[fate])} ${FATES[fate].words}`))));
}

function signOf(fate: Fate): SVGElement {
  return svg("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, svg("path", { d: FATES[fate].path, fill: FATES[fate].color }));
}
