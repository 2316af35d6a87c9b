/** Check's left side: the suspect, and where it was compared, the suspect laid on its original. */
import type { Overlay } from "meshmark";
import { find, h, instantiate } from "./dom";
import type { StageEvents } from "./showing";
import { Stage } from "./stage";
import { drawLegend } from "./viewer/colormap";
import type { LaidLook } from "./viewer/laid";

/** What stands on the canvas: the suspect alone, or one of the ways to see it on its original. */
type Seen = "suspect" | LaidLook;

export class CheckStage extends Stage {
  readonly #tools: HTMLElement;
  readonly #legend: HTMLElement;
  readonly #slider: HTMLInputElement;
  readonly #line = h("div", { class: "wipe-line", hidden: "", "aria-hidden": "true" }, h("span", {}, "Original"), h("span", {}, "Suspect"));
  #ends: Record<"difference" | "evidence", number> = { difference: 0, evidence: 0 };
  #isRecorded = false;

  constructor(view: HTMLElement, events: StageEvents) {
    super(view, events);
    const parts = instantiate("#laid-tools");
    this.#tools = find("[data-laid-tools]", parts);
    this.#legend = find(".laid-legend", this.#tools);
    this.#slider = find<HTMLInputElement>("input", this.#tools);
    drawLegend(find<HTMLCanvasElement>("canvas", this.#legend));
    find(".viewer", this.viewing).append(h("div", { class: "wipe-area" }, this.#line));
    find(".toolbar", this.viewing).prepend(this.#tools);
    for (const button of this.#choices()) {
      button.addEventListener("click", () => this.#look(button.dataset["laid"] as Seen));
    }
    this.#slider.addEventListener("input", () => this.#look("wipe"));
  }

  protected override clear(): void {
    super.clear();
    this.#offer(false);
  }

  /** Lays the suspect on its original, in place of any other. */
  async showLaid(overlay: Overlay, isWanted: () => boolean): Promise<void> {
    await this.draw(isWanted, async () => {
      const [{ viewer }, { Laid }] = await Promise.all([this.loadViewer(), import("./viewer/laid")]);
      if (isWanted()) {
        const laid = new Laid(overlay);
        viewer.lay(laid);
        this.#ends = laid.ends;
        this.#isRecorded = overlay.isRecorded;
        find('[data-laid="evidence"]', this.#tools).hidden = !laid.hasEvidence;
        this.#offer(true);
        this.#look("wipe");
      }
    });
  }

  /** Takes the original away again: what was compared is no longer what is asked. */
  dropLaid(): void {
    this.#look("suspect");
    this.#offer(false);
  }

  #offer(isLaid: boolean): void {
    this.#tools.hidden = !isLaid;
    this.#slider.value = "50";
    this.#tell("suspect");
  }

  #look(seen: Seen): void {
    this.#tell(seen);
    this.viewer?.lookAtLaid(seen === "suspect" ? undefined : seen, this.#slider.valueAsNumber / 100);
  }

  /** Presses the buttons, and says what is seen. */
  #tell(seen: Seen): void {
    this.viewing.dataset["seen"] = seen;
    for (const button of this.#choices()) {
      button.setAttribute("aria-pressed", String(button.dataset["laid"] === seen));
    }
    const part = this.#slider.valueAsNumber;
    this.#slider.setAttribute("aria-valuetext", `${part} % original, ${100 - part} % suspect`);
    this.#line.hidden = seen !== "wipe";
    this.#line.style.left = `${part}%`;
    this.#legend.hidden = seen === "suspect" || seen === "wipe";
    if (seen === "difference" || seen === "evidence") {
      this.#tellScale(seen);
    }
  }

  /** Says what the colours of a map mean. */
  #tellScale(map: "difference" | "evidence"): void {
    const end = this.#ends[map];
    const record = this.#isRecorded ? " A record keeps few triangles: what differs a little is the record." : "";
    const [title, value] = {
      difference: [`How far apart they are, in % of the original’s diagonal.${record}`, (of: number) => `${short(of * 100)} %`] as const,
      evidence: ["What each place says for your mark: it makes chance so many times less likely.", (of: number) => `${short(Math.exp(of))} ×`] as const,
    }[map];
    const marks = [value(0), value(end / 2), `${value(end)} or more`];
    find("p", this.#legend).textContent = title;
    find(".scale", this.#legend).replaceChildren(...marks.map((mark) => h("span", {}, mark)));
  }

  #choices(): HTMLElement[] {
    return [...this.#tools.querySelectorAll<HTMLElement>("[data-laid]")];
  }
}

/** Two significant digits. */
function short(x: number): string {
  return x.toLocaleString("en", { maximumSignificantDigits: 2 });
}
