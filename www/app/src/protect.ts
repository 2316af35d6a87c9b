/** Protect: a model and a key in, a marked copy out; or several models, and as many copies. */
import type { Carrier, DetailedExtraction, EmbedOptions, Embedding, Inspection } from "meshmark";
import { copiesFor, namesIn, type Copies } from "./buyers";
import { button, find, setProblem } from "./dom";
import { copyOf, type Asked, type Copy, type Preset } from "./copy";
import { engine } from "./engine";
import { incompleteKeyField, isKeyComplete, keySource, strangerKey, type KeyMaker, type KeySource } from "./key-form";
import { renamed, type Found, type Model } from "./model";
import { actions, card, note } from "./outcome";
import { Preview } from "./preview";
import { detect, withKey } from "./reading";
import { save } from "./save";
import { Shelf } from "./shelf";
import { Stage } from "./stage";
import { tagProblem, watchTag } from "./tag";
import type { Progress } from "./task";
import { Trial } from "./trial";
import { View } from "./view";
import { CARRIERS, isMark } from "./words";

const STRENGTHS: Record<Preset, string> = {
  subtle: "For surfaces seen very close. Vertices move by at most 0.02 % of the model’s size on average, less where it is smooth.",
  balanced: "For most models. Vertices move by at most 0.04 % of the model’s size on average, less where it is smooth.",
  strong: "Survives more; look at smooth, shiny surfaces first. Vertices move by at most 0.08 % of the model’s size on average.",
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

/** What was looked for in a model before it is marked, and whether its owner wants a second mark all the same. */
interface Looked {
  model: Model;
  key: KeySource;
  /** The mark of this key that is there; `null` where none is. */
  reading: DetailedExtraction | null;
  isWanted: boolean;
}

/** What marking comes to: a copy, or the mark that is there already. */
export type Marking = { embedding: Embedding } | { already: DetailedExtraction };

export class Protect extends View<Stage> {
  readonly #tag = find<HTMLInputElement>("#tag");
  readonly #strength = find<HTMLSelectElement>("#strength");
  readonly #carriers = [...find("#carriers").querySelectorAll("input")];
  readonly #preview = new Preview(() => this.#stronger());
  readonly #shelf: Shelf;
  /** The embedding that the form asks for now, or one like it by another key. */
  #trial: Trial<Marking> | undefined;
  #timer = 0;
  #looked: Looked | undefined;

  /** @param events what can be done with the marked copy in other views */
  constructor(root: HTMLElement, events: ProtectEvents) {
    super(root, "Cannot mark", Stage);
    const onStronger = () => {
      this.#stronger();
      void this.submit();
    };
    this.#shelf = new Shelf(this.outcome, { ...events, onStronger }, () => ({ model: this.model, asked: this.#asked() }));
    watchTag(this.#tag);
    const hint = find("#strength-hint");
    const describe = () => (hint.textContent = STRENGTHS[this.#strength.value as Preset]);
    this.#strength.addEventListener("change", () => {
      describe();
      this.#onOtherLook();
    });
    describe();
    this.#tag.addEventListener("input", () => this.onOther());
    for (const box of this.#carriers) {
      find(`#${box.id}-hint`).textContent = CARRIERS[box.value as Carrier].survives;
      box.addEventListener("change", () => {
        this.#keepOne();
        this.#onOtherLook();
      });
    }
    find("#make-copies").addEventListener("click", () => void this.#makeCopies());
    this.#keepOne(); // a reload may bring back what was chosen before
    void this.#shelf.restore();
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

  #asked(): Asked {
    return { tag: this.#tag.value, strength: this.#strength.value as Preset, carriers: this.#chosenBoxes().map((box) => box.value as Carrier) };
  }

  override async take(model: Model, several: Found[] = []): Promise<void> {
    this.#forget();
    await super.take(model, several);
    if (model === this.model) {
      this.#tryLater();
    }
  }

  protected override close(): void {
    this.#forget();
    super.close();
  }

  /** The finished copy of the model that is shown, if there is one. */
  get marked(): Model | undefined {
    return this.#shelf.latest?.marked;
  }

  /** Whether something would be lost with the page. */
  get isAnythingLeft(): boolean {
    return this.#shelf.isAnyLeft;
  }

  /** While another view is in front, nothing is tried: it may need the engine. */
  onShown(isShown: boolean): void {
    if (isShown) {
      this.onOther();
    } else if (!this.#trial?.isDone) {
      this.#dropTrial();
    }
  }

  /** Another model, key or tag: what was tried for the one before is not what is asked for now. */
  override onOther(): void {
    if (this.#trial?.isExact && !this.#isAsked(this.#trial)) {
      this.#dropTrial();
    }
    this.#shelf.refresh();
    this.#tryLater();
  }

  /** Another strength or other carriers. */
  #onOtherLook(): void {
    this.#dropTrial();
    this.#shelf.refresh();
    this.#tryLater();
  }

  #forget(): void {
    clearTimeout(this.#timer);
    this.#dropTrial();
    this.#preview.hide();
    this.#shelf.fold();
    this.#looked = undefined;
  }

  /** One that has been taken over as the result goes on: only who waits for it ends it. */
  #dropTrial(): void {
    if (!this.isRunning) {
      this.#trial?.abort();
    }
    this.#trial = undefined;
  }

  #isAsked({ key, asked }: Trial<Marking>): boolean {
    return key.isInForm() && asked.tag === this.#tag.value;
  }

  #tryLater(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#try(), REST);
  }

  /** Shows what would come of the form as it is; until the key and the tag are there, by others. */
  async #try(): Promise<void> {
    const { model } = this;
    const isExact = isKeyComplete() && this.#tag.value !== "" && tagProblem(this.#tag.value) === null;
    const isNeeded = !this.#shelf.isAskedHere && (!this.#trial || (isExact && !this.#trial.isExact));
    if (!model || !isNeeded || !this.inspection || this.root.hidden || this.isRunning) {
      return;
    }
    const trial = this.#start(model, isExact);
    const isWanted = () => trial === this.#trial && !this.isRunning;
    try {
      const marking = await trial.result;
      if (!isWanted()) {
        return;
      }
      if ("already" in marking) {
        this.#preview.tell(alreadyWords(marking.already, this.#tag.value));
        return;
      }
      this.#preview.show(marking.embedding.report, isExact, this.#strength.value !== "strong");
      await this.stage.showMarked(copyOf(model, marking.embedding, trial.key, trial.asked).marked, marking.embedding.report);
    } catch (error) {
      if (isWanted()) {
        this.#preview.fail(error);
        this.stage.dropMarked();
      }
    }
  }

  #start(model: Model, isExact: boolean): Trial<Marking> {
    this.#trial?.abort();
    const asked = isExact ? this.#asked() : { ...this.#asked(), tag: STAND_IN_TAG };
    const key = isExact ? keySource() : STRANGER;
    const work = (progress: Progress) => (isExact ? this.#mark(model, key, asked, progress) : embed(model, key.make, asked, progress).then((embedding) => ({ embedding })));
    return (this.#trial = new Trial(isExact, key, asked, work, this.#preview.listener));
  }

  /** Marks a model, unless it carries a mark of this key and nobody has asked for a second one. */
  async #mark(model: Model, key: KeySource, asked: Asked, progress: Progress): Promise<Marking> {
    const known = this.#looked?.model === model && this.#looked.key.isInForm() && key.isInForm() ? this.#looked : undefined;
    const looked = known ?? { model, key, reading: await markIn(model, key.make, progress), isWanted: false };
    this.#looked = looked;
    return looked.reading && !looked.isWanted ? { already: looked.reading } : { embedding: await embed(model, key.make, asked, progress) };
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = this.#tag.value ? tagProblem(this.#tag.value) : "Give the tag that a check shall read back.";
    setProblem(this.#tag, problem);
    const model = this.ready(keyField ?? (problem ? this.#tag : null));
    if (!model || this.isRunning) {
      return;
    }
    clearTimeout(this.#timer);
    this.#preview.hide();
    await (this.several.length > 1 ? this.#markSeveral(this.several) : this.#markOne(model));
  }

  async #markOne(model: Model): Promise<void> {
    const trial = this.#trial?.isExact && this.#isAsked(this.#trial) ? this.#trial : this.#start(model, true);
    const marking = await this.run(`Marking ${model.name}`, (progress) => trial.follow(progress));
    if (!marking || "already" in marking) {
      this.#trial = undefined; // what failed can be asked for again
    }
    if (marking && "already" in marking) {
      this.#askAgain(marking.already);
    } else if (marking) {
      const copy = copyOf(model, marking.embedding, trial.key, trial.asked);
      this.#shelf.add(copy, model, trial.key);
      this.#shelf.present(false);
      await this.#look(copy);
    }
  }

  /** One copy for each buyer, in an archive with the ledger. */
  async #makeCopies(): Promise<void> {
    const field = find<HTMLTextAreaElement>("#buyers");
    const [names, first] = [namesIn(field.value), Number(find<HTMLInputElement>("#first-number").value)];
    const isNumber = Number.isSafeInteger(first) && first >= 1 && first + names.length <= 2 ** 48;
    const problem =
      names.length === 0
        ? "Give the names of the buyers."
        : !isNumber
          ? "The number of the first is a whole number from 1 on."
          : null;
    find("#buyers-error").textContent = problem ?? "";
    field.toggleAttribute("aria-invalid", problem !== null);
    const model = this.ready(incompleteKeyField() ?? (problem ? field : null));
    if (!model || this.isRunning) {
      return;
    }
    this.#dropTrial();
    const key = keySource();
    const made = await this.run(`Copies of ${model.name}`, (task) => copiesFor(model, names, first, this.#strength.value as Preset, key.make, task));
    if (made) {
      this.#tellCopies(model, made);
    }
  }

  #tellCopies(model: Model, { zip, numCopies, numWeaker }: Copies): void {
    const weaker = numWeaker > 0 ? [`${numWeaker} of them hold less than the mark that was forecasted.`] : [];
    const file = renamed(model.name, "copies.zip");
    const copies = card(
      "found",
      `${numCopies} ${numCopies === 1 ? "copy" : "copies"}, each read back with its number`,
      [...weaker, "Check finds out whose copy a model is, with the ledger that is in the archive. It is in no other place: download it before you leave."],
      actions(button("Download all (.zip)", () => save(file, zip as BlobPart, "application/zip"), "primary")),
    );
    this.outcome.tell(copies);
    this.outcome.present(copies);
  }

  #look({ marked, report }: Copy): Promise<void> {
    return this.stage.showMarked(marked, report, { version: "after" });
  }

  /** Says what is there already and what a second mark costs, before it begins. */
  #askAgain(already: DetailedExtraction): void {
    const again = button("Mark it all the same", () => {
      if (this.#looked) {
        this.#looked.isWanted = true;
      }
      void this.submit();
    });
    const asking = card("partial", "This model carries your mark already", [alreadyWords(already, this.#tag.value)], actions(again));
    this.outcome.tell(asking);
    this.outcome.present(asking);
  }

  async #markSeveral(found: Found[]): Promise<void> {
    this.#dropTrial();
    const [key, asked] = [keySource(), this.#asked()];
    const isDone = await this.run(`Marking ${found.length} models`, async (task) => {
      for (const [i, { name, open }] of found.entries()) {
        task.headline(`Marking ${i + 1} of ${found.length}: ${name}`);
        try {
          const model = i === 0 ? this.model! : await open();
          const marking = await this.#mark(model, key, asked, task);
          if ("already" in marking) {
            throw new Error(`it carries your mark already, with ${tagWords(marking.already)}; drop it alone to mark it again`);
          }
          this.#shelf.add(copyOf(model, marking.embedding, key, asked), model, key);
        } catch (error) {
          if (task.signal.aborted) {
            throw error;
          }
          this.#shelf.fail(name, error);
        }
      }
      return true;
    });
    this.#shelf.fold();
    if (isDone) {
      this.#shelf.present(true);
    }
  }

  /** The next strength, tried at once. */
  #stronger(): void {
    this.#strength.value = this.#strength.value === "subtle" ? "balanced" : "strong";
    this.#strength.dispatchEvent(new Event("change"));
    this.#strength.focus();
  }
}

/** A key of nobody's, for what is tried before there is one. */
const STRANGER: KeySource = { owner: null, work: null, make: strangerKey, isInForm: () => true };

async function embed(model: Model, makeKey: KeyMaker, { tag, strength, carriers }: Asked, progress: Progress): Promise<Embedding> {
  const options: EmbedOptions = { strength, carriers, files: model.buffers };
  const client = await engine;
  return withKey(client, makeKey, progress, (key) => client.embed(model.bytes, tag, key, { ...options, signal: progress.signal, onProgress: progress.onProgress }));
}

/** The mark of a key that a model carries already; `null` where it carries none. */
async function markIn(model: Model, makeKey: KeyMaker, progress: Progress): Promise<DetailedExtraction | null> {
  const client = await engine;
  const reading = await withKey(client, makeKey, progress, (key) => detect(client, model, key, null, progress));
  return isMark(reading) ? reading : null;
}

function tagWords({ tag, number }: DetailedExtraction): string {
  return tag === null ? `the number ${number}` : `the tag ${tag}`;
}

/** What marking a marked model means. */
function alreadyWords(already: DetailedExtraction, tag: string): string {
  const what = already.tag === tag ? "A second one with the same tag adds nothing that a check would read" : `A second one, with the tag ${tag}, takes the place of that tag`;
  return `It carries your key’s mark, with ${tagWords(already)}. ${what}, and moves the surface as far again. Better take the original, which has no mark.`;
}
