/** Protect: a model and a key in, a marked copy out. */
import type { Embedding, EmbedReport, Inspection, Strength } from "meshmark";
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
import { count, percent, significant } from "./words";

type Preset = Extract<Strength, string>;

const STRENGTHS: Record<Preset, string> = {
  subtle: "For surfaces seen very close. RMS displacement at most 0.02 % of the model’s diagonal.",
  balanced: "For most models. RMS displacement at most 0.04 % of the model’s diagonal.",
  strong: "Survives more; look at smooth, shiny surfaces first. At most 0.08 % of the model’s diagonal.",
};

export class Protect extends View {
  readonly #tag = find<HTMLInputElement>("#tag");
  readonly #strength = find<HTMLSelectElement>("#strength");

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
  }

  protected override foresee({ capacity }: Inspection): HTMLElement | null {
    const [best] = capacity.toSorted((a, b) => b.addresses / b.neededAddresses - a.addresses / a.neededAddresses);
    return best && best.addresses < best.neededAddresses
      ? note(`This model is too small or too regular to hold a mark: it has ${count(best.addresses)} distinct places where ${count(best.neededAddresses)} are needed.`)
      : null;
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = this.#tag.value ? tagProblem(this.#tag.value) : "Give the tag that a check shall read back.";
    setProblem(this.#tag, problem);
    const model = this.ready(keyField ?? (problem ? this.#tag : null));
    if (!model) {
      return;
    }
    const [tag, strength, key] = [this.#tag.value, this.#strength.value as Preset, keyMaker()];
    await this.run(async (controller) => {
      const embedding = await runTask(this.outcome, controller, (progress) => embed(model, tag, strength, key, progress));
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

async function embed(model: Model, tag: string, strength: Preset, makeKey: KeyMaker, progress: Progress): Promise<Embedding> {
  const client = await engine;
  const key = await makeKey(client, progress);
  progress.stage("read");
  try {
    return await client.embed(model.bytes, model.buffers, tag, key, { strength }, progress);
  } finally {
    key.fill(0);
  }
}

/** In the model's own units, and as a fraction of its size. */
function displacement(rel: number, diagonal: number): string {
  return `${percent(rel)} of the diagonal (${significant(rel * diagonal)} units)`;
}
