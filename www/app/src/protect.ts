/** Protect: a model and a key in, a marked copy out. */
import type { Carrier, EmbedOptions, Embedding, EmbedReport, Inspection, Strength } from "meshmark";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { incompleteKeyField, keyMaker, type KeyMaker } from "./key-form";
import { isGltf, renamed, type Model } from "./model";
import { actions, card, carrierTable, details, note, numbers, present, readingRows } from "./outcome";
import { embedReport } from "./report";
import { save, saveJson } from "./save";
import { tagProblem, watchTag } from "./tag";
import { runTask, type Progress } from "./task";
import { View } from "./view";
import { CARRIERS, count, percent, significant } from "./words";

type Preset = Extract<Strength, string>;

const STRENGTHS: Record<Preset, string> = {
  subtle: "For surfaces seen very close. RMS displacement at most 0.02 % of the model’s diagonal.",
  balanced: "For most models. RMS displacement at most 0.04 % of the model’s diagonal.",
  strong: "Survives more; look at smooth, shiny surfaces first. At most 0.08 % of the model’s diagonal.",
};

export class Protect extends View {
  readonly #tag = find<HTMLInputElement>("#tag");
  readonly #strength = find<HTMLSelectElement>("#strength");
  readonly #carriers = [...find("#carriers").querySelectorAll("input")];

  /** @param onCheck is given the marked copy, to check it as anybody would */
  constructor(
    root: HTMLElement,
    readonly onCheck: (marked: Model) => void,
  ) {
    super(root, "Cannot mark");
    watchTag(this.#tag);
    const hint = find("#strength-hint");
    const describe = () => (hint.textContent = STRENGTHS[this.#strength.value as Preset]);
    this.#strength.addEventListener("change", describe);
    describe();
    for (const box of this.#carriers) {
      find(`#${box.id}-hint`).textContent = CARRIERS[box.value as Carrier].survives;
      box.addEventListener("change", () => this.#keepOne());
    }
    this.#keepOne(); // a reload may bring back what was chosen before
  }

  protected override foresee({ capacity }: Inspection): HTMLElement | null {
    const short = capacity.filter(({ addresses, neededAddresses }) => addresses < neededAddresses);
    const lacking = short
      .map(({ name, addresses, neededAddresses }) => `its ${CARRIERS[name].home} offers ${count(addresses)} of the ${count(neededAddresses)} places that are needed`)
      .join(", ");
    const [enough] = capacity.filter((carrier) => !short.includes(carrier));
    if (short.length === 0) {
      return null;
    }
    return note(
      enough
        ? `At most the ${CARRIERS[enough.name].home} of this model can hold a mark: ${lacking}.`
        : `This model is too small or too regular to hold a mark: ${lacking}.`,
    );
  }

  /** A mark needs a carrier: the last one cannot be taken away. */
  #keepOne(): void {
    const chosen = this.#chosenBoxes();
    for (const box of this.#carriers) {
      box.disabled = chosen.length === 1 && chosen[0] === box;
    }
  }

  #chosenBoxes(): HTMLInputElement[] {
    return this.#carriers.filter((box) => box.checked);
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = this.#tag.value ? tagProblem(this.#tag.value) : "Give the tag that a check shall read back.";
    setProblem(this.#tag, problem);
    const model = this.ready(keyField ?? (problem ? this.#tag : null));
    if (!model) {
      return;
    }
    const options: EmbedOptions = {
      strength: this.#strength.value as Preset,
      carriers: this.#chosenBoxes().map((box) => box.value as Carrier),
    };
    const [tag, key] = [this.#tag.value, keyMaker()];
    await this.run(async (controller) => {
      const embedding = await runTask(this.outcome, controller, (progress) => embed(model, tag, key, options, progress));
      if (embedding && model === this.model) {
        await this.#present(model, embedding);
      }
    });
  }

  async #present(model: Model, { model: bytes, files, report }: Embedding): Promise<void> {
    const marked: Model = {
      name: renamed(model.name, isGltf(model) ? "marked.gltf" : "marked.glb"),
      bytes: bytes as Model["bytes"],
      buffers: { ...model.buffers, ...files },
      images: model.images,
    };
    present(this.outcome, this.#card(model, marked, Object.entries(files), report));
    await this.stage.showMarked(marked, report);
  }

  #card(model: Model, marked: Model, files: [name: string, bytes: Uint8Array][], report: EmbedReport): HTMLElement {
    const { readBack } = report;
    const holds = readBack.verdict === "found";
    const download = button(`Download ${marked.name}`, () => save(marked.name, marked.bytes, isGltf(marked) ? "model/gltf+json" : "model/gltf-binary"), "primary");
    const downloads = files.map(([name, bytes]) => button(`Download ${name}`, () => save(name.slice(name.lastIndexOf("/") + 1), bytes as BlobPart), "primary"));
    return card(
      readBack.verdict,
      holds ? "Your mark is in the copy" : "The mark does not hold in this model",
      [holds ? "It was read back from the finished file. Keep the original to yourself." : (readBack.reason ?? readBack.sentence)],
      actions(download, ...downloads),
      ...(files.length > 0 ? [h("p", { class: "hint" }, "The .gltf names its other files: put these in the places of the originals, textures stay as they are.")] : []),
      numbers([
        ...readingRows(readBack),
        ["Held by", holders(report)],
        ["Displacement, RMS", displacement(report.rmsRel, report.diagonal)],
        ["Displacement, largest", displacement(report.maxRel, report.diagonal)],
        ["Vertices moved", `${count(report.movedVertices)} of ${count(report.vertices)}`],
      ]),
      details(
        "Carriers and files",
        carrierTable(readBack.carriers),
        numbers([
          ["Diagonal", `${significant(report.diagonal)} units`],
          ["Tag as a number", String(report.number)],
          ["SHA-256 of the original", h("code", { class: "hash" }, report.hostSha256)],
          ["SHA-256 of the copy", h("code", { class: "hash" }, report.markedSha256)],
        ]),
      ),
      actions(
        button("Check this copy", () => this.onCheck(marked)),
        button("Save report (JSON)", async () => saveJson(renamed(marked.name, "report.json"), await embedReport(model, marked, report))),
      ),
    );
  }
}

async function embed(model: Model, tag: string, makeKey: KeyMaker, options: EmbedOptions, progress: Progress): Promise<Embedding> {
  const client = await engine;
  const key = await makeKey(client, progress);
  progress.stage("read");
  try {
    return await client.embed(model.bytes, model.buffers, tag, key, options, progress);
  } finally {
    key.fill(0);
  }
}

/** The carriers from which the mark was read back; another one may be too weak in this model. */
function holders({ number, readBack }: EmbedReport): string {
  const holding = readBack.carriers.filter((carrier) => carrier.number === number);
  return holding.map(({ name }) => CARRIERS[name].name).join(", ");
}

/** In the model's own units, and as a fraction of its size. */
function displacement(rel: number, diagonal: number): string {
  return `${percent(rel)} of the diagonal (${significant(rel * diagonal)} units)`;
}
