/**
 * Two form controls, defined by importing this: `<meshmark-protect>` marks a model before it is uploaded, and `<meshmark-check>` says whether
 * one carries a mark. No framework; nothing inline, so a strict Content-Security-Policy suffices; no model leaves the page but by
 * the form.
 *
 * The key is a property, never an attribute: `element.key`, 32 bytes, or a function that gives them (or a promise of them) when they are needed.
 */
import { createClient, MeshmarkError, type Client, type ClientOptions } from "./client.js";
import type { EmbedReport, Extraction, Payload, Strength } from "./index.js";

/** A key, or what gives one. */
export type KeySource = Uint8Array | (() => Uint8Array | Promise<Uint8Array>);

/** Every sentence that a person reads. `{…}` is filled in. */
export interface ProtectStrings {
  choose: string;
  working: string;
  done: string;
  fragile: string;
  failed: string;
  missing: string;
}

export interface CheckStrings {
  choose: string;
  working: string;
  verdict: string;
  failed: string;
  missing: string;
}

const PROTECT: ProtectStrings = {
  choose: "Model to protect (.glb)",
  working: "Marking… {percent} %",
  done: "Protected. The marked model is what will be sent.",
  fragile: "Protected, but the mark is fragile: rounding positions as web pipelines do takes it.",
  failed: "Not protected: {message}",
  missing: "Choose a model, and wait until it is protected.",
};

const CHECK: CheckStrings = {
  choose: "Model to check (.glb)",
  working: "Checking… {percent} %",
  verdict: "{sentence} {reason}",
  failed: "Cannot check: {message}",
  missing: "Choose a model, and wait for the answer.",
};

const STYLE = `
  :host { display: block; font: inherit; color: inherit; }
  :host([hidden]) { display: none; }
  label { display: block; margin-bottom: var(--meshmark-gap, 0.35em); }
  input { font: inherit; max-width: 100%; }
  [part="status"] { margin: var(--meshmark-gap, 0.35em) 0 0; min-height: 1.4em; }
  [part="status"][data-state="failed"] { color: var(--meshmark-bad, #a30000); }
  [part="status"][data-state="done"] { color: var(--meshmark-good, #006429); }
`;

let sheet: CSSStyleSheet | undefined;
let client: Promise<Client> | undefined;
let clientOptions: ClientOptions = {};

/** Where the worker and the modules are, if not in this package. To be called before the first model is chosen. */
export function configure(options: ClientOptions): void {
  clientOptions = options;
  client?.then((client) => client.dispose(), () => {});
  client = undefined;
}

/** One worker for all elements of a page, started with the first model. */
function sharedClient(): Promise<Client> {
  client ??= createClient(clientOptions).catch((error: unknown) => {
    client = undefined;
    throw error;
  });
  return client;
}

/** A field for a file, a line that says what goes on, and a value for the form. */
abstract class Control<Strings extends { choose: string; working: string; failed: string; missing: string }> extends HTMLElement {
  static formAssociated = true;
  static observedAttributes = ["disabled", "required"];

  /** The key's 32 bytes, or what gives them. */
  key: KeySource | undefined;

  protected readonly internals = this.attachInternals();
  readonly #defaults: Strings;
  #strings: Partial<Strings> = {};
  readonly #label = document.createElement("span");
  readonly #input = document.createElement("input");
  readonly #status = document.createElement("p");
  #run = 0;
  #abort: AbortController | undefined;
  #hasValue = false;

  constructor(defaults: Strings) {
    super();
    this.#defaults = defaults;
    const root = this.attachShadow({ mode: "open", delegatesFocus: true });
    if (!sheet) {
      sheet = new CSSStyleSheet();
      sheet.replaceSync(STYLE);
    }
    root.adoptedStyleSheets = [sheet];
    const label = document.createElement("label");
    label.part.add("label");
    this.#input.type = "file";
    this.#input.part.add("input");
    this.#status.part.add("status");
    this.#status.setAttribute("role", "status");
    label.append(this.#label, document.createElement("br"), this.#input);
    root.append(label, this.#status);
    this.#input.addEventListener("change", () => void this.choose(this.#input.files?.[0]));
  }

  connectedCallback(): void {
    this.#input.accept = this.getAttribute("accept") ?? ".glb,model/gltf-binary";
    this.#label.textContent = this.text("choose");
    this.#validate();
  }

  disconnectedCallback(): void {
    this.#abort?.abort();
  }

  attributeChangedCallback(): void {
    this.#input.disabled = this.hasAttribute("disabled");
    this.#validate();
  }

  formDisabledCallback(isDisabled: boolean): void {
    this.#input.disabled = isDisabled;
  }

  formResetCallback(): void {
    void this.choose(undefined);
    this.#input.value = "";
  }

  /** Sentences in other words or another language; what is left out keeps its own. */
  get strings(): Partial<Strings> {
    return this.#strings;
  }

  set strings(strings: Partial<Strings>) {
    this.#strings = { ...strings };
    this.#label.textContent = this.text("choose");
    this.#validate();
  }

  get form(): HTMLFormElement | null {
    return this.internals.form;
  }

  get name(): string {
    return this.getAttribute("name") ?? "";
  }

  get validity(): ValidityState {
    return this.internals.validity;
  }

  get validationMessage(): string {
    return this.internals.validationMessage;
  }

  checkValidity(): boolean {
    return this.internals.checkValidity();
  }

  reportValidity(): boolean {
    return this.internals.reportValidity();
  }

  /** Takes a file as if a person had chosen it; `undefined` empties the control. Resolves when it is done with it. */
  async choose(file: File | undefined): Promise<void> {
    const run = ++this.#run;
    this.#abort?.abort();
    this.#abort = new AbortController();
    const { signal } = this.#abort;
    this.#settle(null, "", "");
    if (!file) {
      return;
    }
    const isLast = () => run === this.#run;
    const onProgress = (fraction: number) => {
      if (isLast()) {
        this.#say("working", this.text("working", { percent: String(Math.round(100 * fraction)) }));
      }
    };
    onProgress(0);
    try {
      if (!this.key) {
        throw new MeshmarkError("element.no-key", "No key was given.");
      }
      const key = typeof this.key === "function" ? await this.key() : this.key;
      const model = new Uint8Array(await file.arrayBuffer());
      const client = await sharedClient();
      const done = await this.work(client, file, model, key, signal, onProgress);
      if (isLast()) {
        this.#settle(done.value, "done", done.words);
        this.dispatchEvent(new CustomEvent(done.event, { bubbles: true, composed: true, detail: done.detail }));
      }
    } catch (error) {
      if (isLast() && !signal.aborted) {
        const message = error instanceof Error ? error.message : String(error);
        this.#settle(null, "failed", this.text("failed", { message }));
        this.dispatchEvent(new CustomEvent("meshmark-error", { bubbles: true, composed: true, detail: error }));
      }
    }
  }

  protected abstract work(
    client: Client,
    file: File,
    model: Uint8Array,
    key: Uint8Array,
    signal: AbortSignal,
    onProgress: (fraction: number) => void,
  ): Promise<{ value: File | string; words: string; event: string; detail: unknown }>;

  protected text(name: keyof Strings, values: Record<string, string> = {}): string {
    const words = (this.#strings[name] ?? this.#defaults[name]) as string;
    return words.replace(/\{(\w+)\}/g, (_, name: string) => values[name] ?? "").trim();
  }

  #settle(value: File | string | null, state: string, words: string): void {
    this.#hasValue = value !== null;
    this.internals.setFormValue(value);
    this.#say(state, words);
    this.#validate();
  }

  #say(state: string, words: string): void {
    this.#status.dataset["state"] = state;
    this.#status.textContent = words;
    if (state === "working") {
      this.internals.setValidity({ customError: true }, this.text("missing"), this.#input);
    }
  }

  #validate(): void {
    const isMissing = !this.#hasValue && (this.hasAttribute("required") || this.#input.files?.length === 1);
    if (isMissing) {
      this.internals.setValidity({ valueMissing: true }, this.text("missing"), this.#input);
    } else {
      this.internals.setValidity({});
    }
  }
}

/** What `meshmark-protected` tells. */
export interface Protected {
  /** The marked model, which is the form's value. */
  file: File;
  report: EmbedReport;
}

/**
 * A file field whose value is the marked model. Attributes: `name`, `required`, `disabled`, `accept`, `tag` (1 to 8 characters) or `number`,
 * `strength`. Events: `meshmark-protected` with `Protected`, `meshmark-error` with what was thrown. Parts: `label`, `input`, `status`.
 */
export class MeshmarkProtect extends Control<ProtectStrings> {
  constructor() {
    super(PROTECT);
  }

  protected async work(
    client: Client,
    file: File,
    model: Uint8Array,
    key: Uint8Array,
    signal: AbortSignal,
    onProgress: (fraction: number) => void,
  ) {
    const number = this.getAttribute("number");
    const payload: Payload = number === null ? (this.getAttribute("tag") ?? "") : Number(number);
    const strength = this.getAttribute("strength");
    const stages = ["read", "embed", "write", "measure", "test", "forecast"];
    const { model: marked, report } = await client.embed(model, payload, key, {
      ...(strength === null ? {} : { strength: (Number(strength) || strength) as Strength }),
      signal,
      onProgress: (stage, fraction) => onProgress((stages.indexOf(stage) + fraction) / stages.length),
    });
    const value = new File([marked as BlobPart], file.name, { type: "model/gltf-binary" });
    const detail: Protected = { file: value, report };
    return { value, words: this.text(report.isFragile ? "fragile" : "done"), event: "meshmark-protected", detail };
  }
}

/**
 * A file field whose value is a verdict: `found`, `present`, `partial`, `none` or `cannot-check`. Attributes: `name`, `required`, `disabled`,
 * `accept`. Events: `meshmark-verdict` with an `Extraction`, `meshmark-error` with what was thrown. Parts: `label`, `input`, `status`.
 *
 * What a form sends was computed by whoever sends it: a server that has to be sure checks again.
 */
export class MeshmarkCheck extends Control<CheckStrings> {
  constructor() {
    super(CHECK);
  }

  protected async work(
    client: Client,
    _file: File,
    model: Uint8Array,
    key: Uint8Array,
    signal: AbortSignal,
    onProgress: (fraction: number) => void,
  ) {
    const stages = ["read", "measure", "test"];
    const detail: Extraction = await client.detect(model, key, {
      signal,
      onProgress: (stage, fraction) => onProgress((stages.indexOf(stage) + fraction) / stages.length),
    });
    const words = this.text("verdict", { sentence: detail.sentence, reason: detail.reason ?? "" });
    return { value: detail.verdict as string, words, event: "meshmark-verdict", detail };
  }
}

// A page may load two copies of this package; a name can be defined once.
if (!customElements.get("meshmark-protect")) {
  customElements.define("meshmark-protect", MeshmarkProtect);
  customElements.define("meshmark-check", MeshmarkCheck);
}
