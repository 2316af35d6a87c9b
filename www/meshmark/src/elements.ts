/**
 * Two form controls, defined by importing this: `<meshmark-protect>` marks a model before it is uploaded, and `<meshmark-check>` says whether
 * one carries a mark. No framework; nothing inline, so a strict Content-Security-Policy suffices; no model leaves the page but by
 * the form.
 *
 * The key is a property, never an attribute: `element.ownerKey`, 32 bytes, or a function that gives them (or a promise of them) when they are
 * needed. (`key` would be a word of React's and Vue's own.) A server may import this to render a page: there it defines nothing.
 */
import { createClient, MeshmarkError, type Client, type ClientOptions } from "./client.js";
import type { EmbedReport, Extraction, Payload, Strength } from "./index.js";

/** A key, or what gives one. */
export type KeySource = Uint8Array | (() => Uint8Array | Promise<Uint8Array>);

/** A sentence in which `{…}` is filled in, or a function that makes one of the same values. */
export type Words = string | ((values: Readonly<Record<string, string>>) => string);

/** Every sentence of `<meshmark-protect>`. `failed` is given `code` and `message`. */
export interface ProtectStrings {
  choose: Words;
  working: Words;
  done: Words;
  fragile: Words;
  failed: Words;
  missing: Words;
}

/** Every sentence of `<meshmark-check>`. `verdict` is given `verdict`, `sentence`, `reason` and `tag`; `failed` is given `code` and `message`. */
export interface CheckStrings {
  choose: Words;
  working: Words;
  verdict: Words;
  failed: Words;
  missing: Words;
}

const PROTECT: ProtectStrings = {
  choose: "Model to protect (.glb)",
  working: "Marking…",
  done: "Protected. The marked model is what will be sent.",
  fragile: "Protected, but the mark is fragile: rounding positions as web pipelines do takes it.",
  failed: "Not protected: {message}",
  missing: "Choose a model, and wait until it is protected.",
};

const CHECK: CheckStrings = {
  choose: "Model to check (.glb)",
  working: "Checking…",
  verdict: "{sentence} {reason}",
  failed: "Cannot check: {message}",
  missing: "Choose a model, and wait for the answer.",
};

const STYLE = `
  :host { display: block; font: inherit; color: inherit; }
  :host([hidden]) { display: none; }
  label { display: block; margin-bottom: var(--meshmark-gap, 0.35em); }
  input { font: inherit; max-width: 100%; }
  progress { display: block; width: 100%; max-width: 20em; margin-top: var(--meshmark-gap, 0.35em); }
  progress[hidden] { display: none; }
  [part="status"] { margin: var(--meshmark-gap, 0.35em) 0 0; min-height: 1.4em; }
  [part="status"][data-state="failed"] { color: var(--meshmark-bad, #a30000); }
  [part="status"][data-state="good"] { color: var(--meshmark-good, #006429); }
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

/** A server has no elements; what it renders of a page is their names. */
const Base = (globalThis.HTMLElement ?? class {}) as typeof HTMLElement;

/** A field for a file, a line that says what goes on, and a value for the form. */
abstract class Control<Strings extends { choose: Words; working: Words; failed: Words; missing: Words }> extends Base {
  static formAssociated = true;
  static observedAttributes = ["disabled", "required"];

  protected readonly internals = this.attachInternals();
  readonly #defaults: Strings;
  #strings: Partial<Strings> = {};
  #ownerKey: KeySource | undefined;
  readonly #label = document.createElement("span");
  readonly #input = document.createElement("input");
  readonly #progress = document.createElement("progress");
  readonly #status = document.createElement("p");
  #run = 0;
  #abort: AbortController | undefined;
  #file: File | undefined;
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
    // Who hears the page is told what begins and what came of it, not every percent between.
    this.#status.setAttribute("role", "status");
    this.#status.id = "status";
    this.#input.setAttribute("aria-describedby", "status");
    this.#progress.part.add("progress");
    this.#progress.setAttribute("aria-labelledby", "status");
    this.#progress.hidden = true;
    label.append(this.#label, document.createElement("br"), this.#input);
    root.append(label, this.#progress, this.#status);
    this.#input.addEventListener("change", () => void this.choose(this.#input.files?.[0]));
    // A page may set these before it has loaded this module: then they hide what the class has.
    for (const name of ["ownerKey", "strings"] as const) {
      if (Object.hasOwn(this, name)) {
        const value = this[name];
        delete (this as Record<string, unknown>)[name];
        (this as Record<string, unknown>)[name] = value;
      }
    }
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
    this.#input.disabled = this.matches(":disabled");
    this.#input.required = this.required;
    this.#validate();
  }

  formDisabledCallback(isDisabled: boolean): void {
    this.#input.disabled = isDisabled;
  }

  formResetCallback(): void {
    void this.choose(undefined);
    this.#input.value = "";
  }

  /** The key's 32 bytes, or what gives them. */
  get ownerKey(): KeySource | undefined {
    return this.#ownerKey;
  }

  set ownerKey(key: KeySource | undefined) {
    this.#ownerKey = key;
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

  // Frameworks set what an element has as a property.
  set name(name: string) {
    this.setAttribute("name", name);
  }

  get required(): boolean {
    return this.hasAttribute("required");
  }

  set required(isRequired: boolean) {
    this.toggleAttribute("required", isRequired);
  }

  get disabled(): boolean {
    return this.hasAttribute("disabled");
  }

  set disabled(isDisabled: boolean) {
    this.toggleAttribute("disabled", isDisabled);
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

  /** Takes the same file again: to be called where the key has changed. */
  again(): Promise<void> {
    return this.choose(this.#file);
  }

  /** Takes a file as if a person had chosen it; `undefined` empties the control. Resolves when it is done with it. */
  async choose(file: File | undefined): Promise<void> {
    const run = ++this.#run;
    this.#file = file;
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
        this.#progress.value = fraction;
      }
    };
    this.#begin();
    try {
      const source = this.#ownerKey;
      if (!source) {
        throw new MeshmarkError("element.no-key", "No key was given.");
      }
      const key = typeof source === "function" ? await source() : source;
      const model = new Uint8Array(await file.arrayBuffer());
      const client = await sharedClient();
      const done = await this.work(client, file, model, key, signal, onProgress);
      if (isLast()) {
        this.#settle(done.value, done.isGood ? "good" : "told", done.words);
        this.dispatchEvent(new CustomEvent(done.event, { bubbles: true, composed: true, detail: done.detail }));
      }
    } catch (error) {
      if (isLast() && !signal.aborted) {
        const message = error instanceof Error ? error.message : String(error);
        const code = error instanceof MeshmarkError ? error.code : "";
        this.#settle(null, "failed", this.text("failed", { code, message }));
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
  ): Promise<{ value: File | string; words: string; isGood: boolean; event: string; detail: unknown }>;

  protected text(name: keyof Strings, values: Record<string, string> = {}): string {
    const words = (this.#strings[name] ?? this.#defaults[name]) as Words;
    return typeof words === "function" ? words(values) : words.replace(/\{(\w+)\}/g, (_, name: string) => values[name] ?? "").trim();
  }

  #begin(): void {
    this.#progress.hidden = false;
    this.#progress.value = 0;
    this.#say("working", this.text("working"));
    this.internals.setValidity({ customError: true }, this.text("missing"), this.#input);
  }

  #settle(value: File | string | null, state: string, words: string): void {
    this.#hasValue = value !== null;
    this.#progress.hidden = true;
    this.internals.setFormValue(value);
    this.#say(state, words);
    this.#validate();
  }

  #say(state: string, words: string): void {
    this.#status.dataset["state"] = state;
    this.#status.textContent = words;
    this.#input.ariaInvalid = String(state === "failed");
  }

  #validate(): void {
    const isMissing = !this.#hasValue && (this.required || this.#file !== undefined);
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
 * `strength`. Events: `meshmark-protected` with `Protected`, `meshmark-error` with what was thrown. Parts: `label`, `input`, `progress`, `status`.
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
    const isGood = !report.isFragile;
    return { value, words: this.text(isGood ? "done" : "fragile"), isGood, event: "meshmark-protected", detail };
  }
}

/**
 * A file field whose value is a verdict: `found`, `present`, `partial`, `none` or `cannot-check`. Attributes: `name`, `required`, `disabled`,
 * `accept`. Events: `meshmark-verdict` with an `Extraction`, `meshmark-error` with what was thrown. Parts: `label`, `input`, `progress`, `status`.
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
    const words = this.text("verdict", { verdict: detail.verdict, sentence: detail.sentence, reason: detail.reason ?? "", tag: detail.tag ?? "" });
    const isGood = detail.verdict === "found" || detail.verdict === "present";
    return { value: detail.verdict as string, words, isGood, event: "meshmark-verdict", detail };
  }
}

// A page may load two copies of this package; a name can be defined once.
if (globalThis.customElements && !customElements.get("meshmark-protect")) {
  customElements.define("meshmark-protect", MeshmarkProtect);
  customElements.define("meshmark-check", MeshmarkCheck);
}
