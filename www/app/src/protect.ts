/** Protect: a model and a key in, a marked copy out. */
import type { Carrier, EmbedOptions, Embedding, EmbedReport, Inspection, Strength } from "meshmark";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { incompleteKeyField, isKeyComplete, keyMaker, strangerKey, type KeyMaker } from "./key-form";
import { isGltf, renamed, type Model } from "./model";
import { actions, card, carrierTable, details, displacement, forecastList, note, numbers, present, readingRows } from "./outcome";
import { Preview } from "./preview";
import { embedReport } from "./report";
import { save, saveJson } from "./save";
import { Stage } from "./stage";
import { tagProblem, watchTag } from "./tag";
import { runTask, type Progress } from "./task";
import { Trial } from "./trial";
import { View } from "./view";
import { CARRIERS, count, losses, significant } from "./words";

type Preset = Extract<Strength, string>;

const STRENGTHS: Record<Preset, string> = {
  subtle: "For surfaces seen very close. RMS displacement at most 0.02 % of the model’s diagonal, less where it is smooth.",
  balanced: "For most models. RMS displacement at most 0.04 % of the model’s diagonal, less where it is smooth.",
  strong: "Survives more; look at smooth, shiny surfaces first. RMS displacement at most 0.08 % of the model’s diagonal.",
};

/** How long a person must have rested, in milliseconds, before what they chose is tried. */
const REST = 500;

/** The tag that is tried before there is one. */
const STAND_IN_TAG = "PREVIEW";

export interface ProtectEvents {
  /** To check it as anybody would. */
  onCheck(marked: Model): void;
  /** To try to break its mark. */
  onBreak(): void;
}

export class Protect extends View<Stage> {
  readonly #tag = find<HTMLInputElement>("#tag");
  readonly #strength = find<HTMLSelectElement>("#strength");
  readonly #carriers = [...find("#carriers").querySelectorAll("input")];
  readonly #preview = new Preview();
  /** The embedding that the form asks for now, or one like it by another key. */
  #trial: Trial | undefined;
  #timer = 0;
  /** While the finished copy of this model stands there, nothing is tried. */
  #marked: Model | undefined;

  /** @param events what can be done with the marked copy in other views */
  constructor(
    root: HTMLElement,
    readonly events: ProtectEvents,
  ) {
    super(root, "Cannot mark", Stage);
    watchTag(this.#tag);
    const hint = find("#strength-hint");
    const describe = () => (hint.textContent = STRENGTHS[this.#strength.value as Preset]);
    this.#strength.addEventListener("change", () => {
      describe();
      this.#onOtherLook();
    });
    describe();
    this.#tag.addEventListener("input", () => this.onOtherMark());
    for (const box of this.#carriers) {
      find(`#${box.id}-hint`).textContent = CARRIERS[box.value as Carrier].survives;
      box.addEventListener("change", () => {
        this.#keepOne();
        this.#onOtherLook();
      });
    }
    this.#keepOne(); // a reload may bring back what was chosen before
  }

  protected override foresee({ capacity }: Inspection): HTMLElement | null {
    const short = capacity.filter(isShort);
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

  override async take(model: Model): Promise<void> {
    this.#forget();
    await super.take(model);
    if (model === this.model) {
      this.#tryLater();
    }
  }

  protected override close(): void {
    this.#forget();
    super.close();
  }

  /** The finished copy, while it stands there. */
  get marked(): Model | undefined {
    return this.#marked;
  }

  /** While another view is in front, nothing is tried: it may need the engine. */
  onShown(isShown: boolean): void {
    if (isShown) {
      this.#tryLater();
    } else if (!this.#trial?.isDone) {
      this.#dropTrial();
    }
  }

  /** Another key or tag: what was made for the one before must not be handed out. */
  onOtherMark(): void {
    if (this.#trial?.isExact) {
      this.#dropTrial();
    }
    this.#tryLater();
  }

  /** Another strength or other carriers: the copy that stands there is not of these. */
  #onOtherLook(): void {
    this.#dropTrial();
    if (this.#marked) {
      this.#marked = undefined;
      this.outcome.replaceChildren();
    }
    this.#tryLater();
  }

  #forget(): void {
    clearTimeout(this.#timer);
    this.#dropTrial();
    this.#preview.hide();
    this.#marked = undefined;
  }

  /** One that has been taken over as the result goes on: only who waits for it ends it. */
  #dropTrial(): void {
    if (!this.isRunning) {
      this.#trial?.abort();
    }
    this.#trial = undefined;
  }

  #tryLater(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#try(), REST);
  }

  /** Shows what would come of the form as it is; until the key and the tag are there, by others. */
  async #try(): Promise<void> {
    const { model } = this;
    const isExact = isKeyComplete() && this.#tag.value !== "" && tagProblem(this.#tag.value) === null;
    const isNeeded = !this.#marked && (!this.#trial || (isExact && !this.#trial.isExact));
    if (!model || !isNeeded || !this.#isPromising() || this.root.hidden || this.isRunning) {
      return;
    }
    const trial = this.#start(model, isExact);
    try {
      const embedding = await trial.embedding;
      if (trial === this.#trial && !this.isRunning) {
        this.#preview.show(embedding.report, isExact);
        await this.stage.showMarked(markedCopy(model, embedding), embedding.report);
      }
    } catch (error) {
      if (trial === this.#trial && !this.isRunning) {
        this.#preview.fail(error);
        this.stage.dropMarked();
      }
    }
  }

  /** Whether some carrier may hold a mark; where none can, that has been said already. */
  #isPromising(): boolean {
    return this.inspection !== undefined && !this.inspection.capacity.every(isShort);
  }

  #start(model: Model, isExact: boolean): Trial {
    this.#trial?.abort();
    const options: EmbedOptions = {
      strength: this.#strength.value as Preset,
      carriers: this.#chosenBoxes().map((box) => box.value as Carrier),
    };
    const [tag, key] = isExact ? [this.#tag.value, keyMaker()] : [STAND_IN_TAG, strangerKey];
    return (this.#trial = new Trial(isExact, (progress) => embed(model, tag, key, options, progress), this.#preview.listener));
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = this.#tag.value ? tagProblem(this.#tag.value) : "Give the tag that a check shall read back.";
    setProblem(this.#tag, problem);
    const model = this.ready(keyField ?? (problem ? this.#tag : null));
    if (!model) {
      return;
    }
    await this.run(async (controller) => {
      clearTimeout(this.#timer);
      this.#preview.hide();
      const trial = this.#trial?.isExact ? this.#trial : this.#start(model, true);
      const embedding = await runTask(this.outcome, controller, (progress) => trial.follow(progress)).catch((error: unknown) => {
        this.#trial = undefined; // what failed can be asked for again
        throw error;
      });
      if (!embedding) {
        this.#trial = undefined;
      } else if (model === this.model) {
        this.#marked = markedCopy(model, embedding);
        await this.#present(model, this.#marked, embedding);
      }
    });
  }

  async #present(host: Model, marked: Model, { files, report }: Embedding): Promise<void> {
    present(this.outcome, this.#card(host, marked, Object.entries(files), report));
    await this.stage.showMarked(marked, report, { version: "after" });
  }

  #card(model: Model, marked: Model, files: [name: string, bytes: Uint8Array][], report: EmbedReport): HTMLElement {
    const { readBack } = report;
    const holds = readBack.verdict === "found";
    const lost = holds ? losses(report.forecast) : null;
    const download = button(`Download ${marked.name}`, () => save(marked.name, marked.bytes, isGltf(marked) ? "model/gltf+json" : "model/gltf-binary"), "primary");
    const downloads = files.map(([name, bytes]) => button(`Download ${name}`, () => save(name.slice(name.lastIndexOf("/") + 1), bytes as BlobPart), "primary"));
    return card(
      readBack.verdict,
      holds ? "Your mark is in the copy" : "The mark does not hold in this model",
      [holds ? "It was read back from the finished file. Keep the original to yourself." : (readBack.reason ?? readBack.sentence)],
      ...(lost === null ? [] : [h("p", { class: "sentence warning" }, lost)]),
      actions(download, ...downloads),
      ...(files.length > 0 ? [h("p", { class: "hint" }, "The .gltf names its other files: put these in the places of the originals, textures stay as they are.")] : []),
      forecastList(report.forecast),
      numbers([
        ...readingRows(readBack),
        ["Held by", holders(report)],
      ]),
      displacement(report),
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
        button("Check this copy", () => this.events.onCheck(marked)),
        ...(holds ? [button("Try to break it", () => this.events.onBreak())] : []),
        button("Save report (JSON)", async () => saveJson(renamed(marked.name, "report.json"), await embedReport(model, marked, report))),
      ),
    );
  }
}

function isShort({ addresses, neededAddresses }: Inspection["capacity"][number]): boolean {
  return addresses < neededAddresses;
}

/** The copy as a model of its own, beside the files of the original that did not change. */
function markedCopy(host: Model, { model, files }: Embedding): Model {
  return {
    name: renamed(host.name, isGltf(host) ? "marked.gltf" : "marked.glb"),
    bytes: model as Model["bytes"],
    buffers: { ...host.buffers, ...files },
    images: host.images,
  };
}

async function embed(model: Model, tag: string, makeKey: KeyMaker, options: EmbedOptions, progress: Progress): Promise<Embedding> {
  const client = await engine;
  const key = await makeKey(client, progress);
  progress.stage("read");
  try {
    return await client.embed(model.bytes, tag, key, { ...options, files: model.buffers, signal: progress.signal, onProgress: progress.onProgress });
  } finally {
    key.fill(0);
  }
}

/** The carriers from which the mark was read back; another one may be too weak in this model. */
function holders({ number, readBack }: EmbedReport): string {
  const holding = readBack.carriers.filter((carrier) => carrier.number === number);
  return holding.map(({ name }) => CARRIERS[name].name).join(", ");
}
