/** What all views do: take a model in, show it, say what is wrong with it. */
import type { Inspection } from "meshmark";
import { find } from "./dom";
import { engine } from "./engine";
import { modelFrom, type Model, type NamedFile } from "./model";
import { errorCard, note, present } from "./outcome";
import type { Showing, StageEvents } from "./stage";

export abstract class View<S extends Showing> {
  readonly form: HTMLFormElement;
  protected readonly stage: S;
  protected readonly outcome: HTMLElement;
  protected model: Model | undefined;
  protected inspection: Inspection | undefined;
  #running: AbortController | undefined;

  constructor(
    readonly root: HTMLElement,
    readonly cannot: "Cannot mark" | "Cannot check" | "Cannot attack" | "Cannot study",
    OwnStage: new (view: HTMLElement, events: StageEvents) => S,
  ) {
    this.form = find<HTMLFormElement>("[data-form]", root);
    this.outcome = find("[data-outcome]", root);
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

  /** Reads what was dropped or chosen, and takes the model in it. */
  async takeFiles(files: NamedFile[]): Promise<void> {
    try {
      await this.take(await modelFrom(files));
    } catch (error) {
      present(this.outcome, errorCard("Cannot open", error));
    }
  }

  async takeDemo(): Promise<void> {
    try {
      const bytes = (await (await engine).demoModel()) as Model["bytes"];
      await this.take({ name: "demo.glb", bytes, buffers: {}, images: {} });
    } catch (error) {
      present(this.outcome, errorCard("Cannot open", error));
    }
  }

  /** Shows a model, ending what was done to the one before. What is wrong with it is said at once, not when it is used. */
  async take(model: Model): Promise<void> {
    this.#running?.abort();
    this.#running = undefined;
    this.model = model;
    this.inspection = undefined;
    this.outcome.replaceChildren();
    const [inspection, problem] = await this.#inspect(model);
    if (model !== this.model) {
      return; // another one came meanwhile
    }
    this.inspection = inspection;
    if (problem) {
      present(this.outcome, problem);
    }
    await this.stage.show(model, inspection ?? null);
  }

  async #inspect(model: Model): Promise<[Inspection | undefined, HTMLElement | null]> {
    try {
      const inspection = await (await engine).inspect(model.bytes, { files: model.buffers });
      return [inspection, this.foresee(inspection)];
    } catch (error) {
      return [undefined, errorCard(this.cannot, error)];
    }
  }

  /** What a model's looks already say about the work to come, if anything. */
  protected foresee(_: Inspection): HTMLElement | null {
    return null;
  }

  protected close(): void {
    this.#running?.abort();
    this.#running = undefined;
    this.model = undefined;
    this.outcome.replaceChildren();
    this.stage.close();
  }

  /** The model that is shown, if any. */
  get shown(): Model | undefined {
    return this.model;
  }

  /** Whether a person waits for something. */
  protected get isRunning(): boolean {
    return this.#running !== undefined;
  }

  /** Does one thing at a time: while it goes on, the form's button rests, and another model ends it. */
  protected async run(work: (controller: AbortController) => Promise<void>): Promise<void> {
    if (this.#running) {
      return;
    }
    const controller = (this.#running = new AbortController());
    const button = find('button[type="submit"]', this.form);
    button.setAttribute("aria-disabled", "true");
    try {
      await work(controller);
    } catch (error) {
      present(this.outcome, errorCard(this.cannot, error));
    } finally {
      if (this.#running === controller) {
        this.#running = undefined;
      }
      if (!this.#running) {
        button.removeAttribute("aria-disabled");
      }
      if (document.activeElement === document.body) {
        button.focus({ preventScroll: true }); // the focus was on something that is gone, such as Cancel
      }
    }
    this.outcome.scrollIntoView({ block: "nearest" });
  }

  /** The model and the focus a form needs before it can be submitted; `null`, with words, where something is missing. */
  protected ready(wrongField: HTMLElement | null): Model | null {
    if (!this.model) {
      present(this.outcome, note("First drop a model, or choose one."));
    }
    wrongField?.focus();
    return this.model && !wrongField ? this.model : null;
  }

  protected abstract submit(): Promise<void>;
}
