/** What all views do: take a model in, show it, say what is wrong with it, work at it. */
import type { Inspection } from "meshmark";
import { MeshmarkError } from "meshmark/client";
import { unpacked } from "./archive";
import { sha256 } from "./digest";
import { announce, find } from "./dom";
import { engine } from "./engine";
import { isEvidence, missingFiles, modelsIn, type Found, type Model, type NamedFile } from "./model";
import { errorCard, note, Outcome } from "./outcome";
import type { Showing, StageEvents } from "./showing";
import { Job, type Task } from "./task";

/** Of several models. */
const MOST_NAMED = 5;

export abstract class View<S extends Showing> {
  readonly form: HTMLFormElement;
  protected readonly stage: S;
  protected readonly outcome: Outcome;
  protected model: Model | undefined;
  protected inspection: Inspection | undefined;
  /** The models that are worked at in one go, where they are several. */
  protected several: Found[] = [];
  protected readonly areSuspects: boolean = false;
  /** What came with the model: files that it lacks may come later. */
  #files: NamedFile[] = [];
  #job: Job | undefined;

  constructor(
    readonly root: HTMLElement,
    readonly cannot: "Cannot mark" | "Cannot check" | "Cannot attack" | "Cannot study",
    OwnStage: new (view: HTMLElement, events: StageEvents) => S,
  ) {
    this.form = find<HTMLFormElement>("[data-form]", root);
    this.outcome = new Outcome(find("[data-outcome]", root));
    this.stage = new OwnStage(root, {
      onFiles: (files) => void this.takeFiles(files),
      onDemo: () => void this.takeDemo(),
      onClose: () => this.close(),
    });
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.submit();
    });
  }

  /** Reads what was dropped or chosen, and takes the model in it, or several. What is no model leaves all as it is. */
  async takeFiles(files: NamedFile[]): Promise<void> {
    try {
      const dropped = await unpacked(files);
      const all = this.#areMissing(dropped) ? [...dropped, ...this.#files] : dropped;
      const found = modelsIn(all, this.areSuspects);
      if (found.length > 1 && !this.#submitButton.dataset["several"]) {
        throw new Error(`There are ${found.length} models in this; drop one of them, with its own files.`);
      }
      const first = await found[0]!.open();
      this.#files = all;
      await this.take(first, found.length > 1 ? found : []);
    } catch (error) {
      this.outcome.tell(errorCard("Cannot open", error));
    }
  }

  /** Whether some of the files are what the model that is shown names and lacks. */
  #areMissing(files: NamedFile[]): boolean {
    if (!this.model) {
      return false;
    }
    const { buffers, images } = missingFiles(this.model);
    const names = [...buffers, ...images].map((uri) => uri.slice(uri.lastIndexOf("/") + 1));
    return files.some(({ file }) => names.includes(file.name));
  }

  async takeDemo(): Promise<void> {
    try {
      const bytes = (await (await engine).demoModel()) as Model["bytes"];
      await this.take({ name: "demo.glb", bytes, buffers: {}, images: {} });
    } catch (error) {
      this.outcome.tell(errorCard("Cannot open", error));
    }
  }

  /**
   * Shows a model, ending what is being done to the one before. What is wrong with it is said at once, not when it is used.
   *
   * @param several all of them, where it is the first of several
   */
  async take(model: Model, several: Found[] = []): Promise<void> {
    this.model = model;
    this.#tellSeveral(several);
    this.inspection = undefined;
    const ended = this.#stop() ? [note("What was going on has been ended: another model came.")] : [];
    this.outcome.tell(...ended);
    this.stage.open(model.name);
    this.onOther();
    const inspected = await this.#inspect(model);
    if (model !== this.model) {
      return; // another one came meanwhile
    }
    const problem = inspected instanceof HTMLElement ? inspected : undefined;
    this.inspection = inspected instanceof HTMLElement ? undefined : inspected;
    if (problem) {
      this.outcome.tell(...ended, problem);
    }
    announce(`${model.name} is open.${problem ? ` ${problem.textContent}` : ""}`);
    await this.stage.show(model, this.inspection ?? null);
  }

  /** Says at the form that it is for several models. */
  #tellSeveral(several: Found[]): void {
    this.several = several;
    const words = this.form.querySelector<HTMLElement>("[data-several-words]");
    if (words) {
      const { one, several: label } = this.#submitButton.dataset;
      const names = several.slice(0, MOST_NAMED).map(({ name }) => name);
      const more = several.length > MOST_NAMED ? [`${several.length - MOST_NAMED} more`] : [];
      words.hidden = several.length === 0;
      words.textContent = `All with the same answers above: ${new Intl.ListFormat("en").format([...names, ...more])}. The first is shown.`;
      this.#submitButton.textContent = several.length === 0 ? one! : label!.replace("#", String(several.length));
    }
  }

  /** What a model is made of, or why that cannot be said. */
  async #inspect(model: Model): Promise<Inspection | HTMLElement | undefined> {
    if (isEvidence(model)) {
      return undefined;
    }
    try {
      const inspection = await (await engine).inspect(model.bytes, { files: model.buffers });
      if (model.original) {
        inspection.sha256 = await sha256(model.original);
      }
      return inspection;
    } catch (error) {
      return errorCard(this.cannot, error);
    }
  }

  /** Hears that the model, or the key, is another one now: what was finished may be of the one before. */
  onOther(): void {}

  protected close(): void {
    this.#stop();
    this.model = undefined;
    this.#tellSeveral([]);
    this.outcome.tell();
    this.stage.close();
    this.onOther();
  }

  /** The model that is shown, if any. */
  get shown(): Model | undefined {
    return this.model;
  }

  /** Whether a person waits for something. */
  get isRunning(): boolean {
    return this.#job !== undefined;
  }

  /** Whether something goes on that would be lost with the page. */
  get isBusy(): boolean {
    return this.isRunning;
  }

  /**
   * Does one thing at a time, its progress before a person who can cancel it; the form is locked while it goes on, and another model ends it.
   *
   * Returns `undefined` where it was cancelled, ended or failed; that has been said.
   */
  protected async run<T>(headline: string, work: (task: Task) => Promise<T>): Promise<T | undefined> {
    if (this.#job) {
      return undefined;
    }
    const job = (this.#job = new Job(headline));
    this.outcome.tell();
    this.outcome.work(job.card);
    this.#lock(true);
    const isOn = () => this.#job === job;
    try {
      const result = await work(job.task);
      return isOn() ? result : undefined;
    } catch (error) {
      if (isOn()) {
        const isCancelled = error instanceof MeshmarkError && error.code === "aborted";
        this.outcome.tell(isCancelled ? note("Cancelled. Nothing was changed.") : errorCard(this.cannot, error));
      }
      return undefined;
    } finally {
      if (isOn()) {
        this.#stop();
      }
    }
  }

  /** Ends what goes on, if something does; says whether. */
  #stop(): boolean {
    const job = this.#job;
    if (!job) {
      return false;
    }
    this.#job = undefined;
    job.end();
    job.card.remove();
    this.#lock(false);
    if (document.activeElement === document.body) {
      this.#submitButton.focus({ preventScroll: true }); // the focus was on something that is gone, such as Cancel
    }
    return true;
  }

  #lock(isLocked: boolean): void {
    find<HTMLFieldSetElement>("[data-fields]", this.form).disabled = isLocked;
    if (isLocked) {
      this.#submitButton.setAttribute("aria-disabled", "true");
    } else {
      this.#submitButton.removeAttribute("aria-disabled");
    }
  }

  get #submitButton(): HTMLElement {
    return find('button[type="submit"]', this.form);
  }

  /** The model and the focus a form needs before it can be submitted; `null`, with words, where something is missing. */
  protected ready(wrongField: HTMLElement | null): Model | null {
    if (!this.model) {
      this.outcome.tell(note("First drop a model, or choose one."));
    }
    wrongField?.focus();
    return this.model && !wrongField ? this.model : null;
  }

  protected abstract submit(): Promise<void>;
}
