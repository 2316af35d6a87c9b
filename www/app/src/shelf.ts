/**
 * Finished copies. The one whose model is shown has a card that says what it was made with, and whether the form says something else by
 * now; all have a list. They stay until their owner dismisses them, and what was not downloaded through a reload.
 */
import { bytesOf, downloads, filesOf, reportOf, type Asked, type Copy } from "./copy";
import { copyCard } from "./copy-card";
import { announce, button, find, h } from "./dom";
import { engine } from "./engine";
import type { KeySource } from "./key-form";
import { renamed, type Model } from "./model";
import { actions, flag, type Outcome } from "./outcome";
import { save } from "./save";
import { forget, keep, kept } from "./store";
import { isMark, problem } from "./words";

/** What a form says now. */
export interface Now {
  model: Model | undefined;
  asked: Asked;
}

export interface ShelfEvents {
  /** To check a copy as anybody would. */
  onCheck(marked: Model): void;
  /** To try to break the mark in the copy that was made last. */
  onBreak(): void;
  /** To make another one, stronger. */
  onStronger(): void;
}

/** A copy, and what only this visit knows of it. */
interface Entry {
  copy: Copy;
  /** What it was made of and with; unknown of a copy from before a reload. Originals are too much to hold in memory. */
  host?: WeakRef<Model>;
  key?: KeySource;
  /** Its files that were not saved yet. */
  left: Set<string>;
  card: HTMLElement;
}

/** A model that came to nothing. */
interface Failure {
  host: string;
  error: unknown;
}

export class Shelf {
  readonly #entries: (Entry | Failure)[] = [];
  readonly #list = h("section", { class: "card", "aria-label": "Finished copies", hidden: "" });
  #shown: Entry | undefined;

  constructor(
    readonly outcome: Outcome,
    readonly events: ShelfEvents,
    /** What the form says when a card asks. */
    readonly now: () => Now,
  ) {}

  /** Puts those back that were there before a reload. */
  async restore(): Promise<void> {
    const copies = (await kept()).filter(({ id }) => !this.#copies().some((entry) => entry.copy.id === id));
    copies.forEach((copy) => this.#put({ copy, left: namesOf(copy), card: h("section") }));
    if (copies.length > 0) {
      announce(`Kept from before: ${copies.length === 1 ? "1 copy" : `${copies.length} copies`} that nobody has downloaded.`);
    }
  }

  /** Takes a copy in that was finished now, and shows its card. */
  add(copy: Copy, host: Model, key: KeySource): void {
    this.#put({ copy, host: new WeakRef(host), key, left: namesOf(copy), card: h("section") });
    void keep(copy);
  }

  fail(host: string, error: unknown): void {
    this.#entries.push({ host, error });
    this.#draw();
  }

  /** Brings the copy finished last to the eye, or the list where there were several. */
  present(isList: boolean): void {
    const target = isList ? this.#list : this.#shown?.card;
    if (target) {
      this.outcome.present(target);
    }
  }

  /** Another model is shown: what was finished is in the list alone. */
  fold(): void {
    this.#shown = undefined;
    this.#draw();
  }

  /** The copy that was made last, while its original is the model that is shown. */
  get latest(): Copy | undefined {
    return this.#shown && this.#shown.host?.deref() === this.now().model ? this.#shown.copy : undefined;
  }

  /** Whether a copy is there of what the form asks for now. */
  get isAskedHere(): boolean {
    return this.#copies().some((entry) => entry.host && differences(entry, this.now()).length === 0);
  }

  /** Whether a copy of this visit would be lost to its owner. */
  get isAnyLeft(): boolean {
    return this.#copies().some(({ key, left }) => key && left.size > 0);
  }

  /** Says on each card whether it still is of what the form says. */
  refresh(): void {
    for (const entry of this.#copies()) {
      flag(entry.card, differences(entry, this.now()), "If the form is right, mark the model again.");
    }
  }

  #copies(): Entry[] {
    return this.#entries.filter((entry) => "copy" in entry);
  }

  #put(entry: Entry): void {
    entry.card = this.#card(entry);
    const twin = this.#copies().find(({ copy }) => copy.id === entry.copy.id);
    if (twin) {
      this.#entries.splice(this.#entries.indexOf(twin), 1);
    }
    this.#entries.push(entry);
    this.#shown = entry;
    this.#draw();
    this.refresh();
  }

  #dismiss(...gone: (Entry | Failure)[]): void {
    for (const entry of gone) {
      this.#entries.splice(this.#entries.indexOf(entry), 1);
      if ("copy" in entry) {
        void forget(entry.copy.id);
      }
    }
    if (this.#shown && !this.#entries.includes(this.#shown)) {
      this.#shown = undefined;
    }
    this.#draw();
    find("form button[type=submit]", this.outcome.root.parentElement!).focus();
  }

  #save(entry: Entry, name: string): void {
    void bytesOf(entry.copy).then((bytes) => {
      save(name, bytes as BlobPart, TYPES[name.slice(name.lastIndexOf(".") + 1)]);
      this.#taken(entry, name);
    });
  }

  #taken(entry: Entry, ...names: string[]): void {
    names.forEach((name) => entry.left.delete(name));
    if (entry.left.size === 0) {
      void forget(entry.copy.id);
    }
    this.#draw();
  }

  #draw(): void {
    const copies = this.#copies();
    const focused = this.#list.contains(document.activeElement) ? document.activeElement!.getAttribute("aria-label") : null;
    this.#list.hidden = this.#entries.every((entry) => entry === this.#shown);
    this.#list.replaceChildren(
      h("h2", {}, copies.length === this.#entries.length ? `Finished: ${copies.length === 1 ? "1 copy" : `${copies.length} copies`}` : `${copies.length} of ${this.#entries.length} models marked`),
      h("ul", { class: "copies" }, ...this.#entries.map((entry) => ("copy" in entry ? this.#row(entry) : this.#failedRow(entry)))),
      actions(
        ...(copies.length > 1 ? [button(`Download all ${copies.length} (.zip)`, () => void this.#saveAll(copies), "primary")] : []),
        button(this.#entries.length === 1 ? "Dismiss" : "Dismiss all", () => this.#dismiss(...this.#entries.slice())),
      ),
    );
    this.outcome.finish(...(this.#shown ? [this.#shown.card] : []), this.#list);
    [...this.#list.querySelectorAll("button")].find((control) => focused !== null && control.getAttribute("aria-label") === focused)?.focus();
  }

  #row(entry: Entry): HTMLElement {
    const { marked, asked, owner, report } = entry.copy;
    const survived = report.forecast.filter(({ level }) => level !== "red").length;
    const show = button("Show", () => {
      this.#shown = entry;
      this.#draw();
      this.outcome.present(entry.card);
    });
    show.setAttribute("aria-label", `Show ${marked.name}`);
    const download = downloads(entry.copy).map((name) => {
      const control = button(entry.left.has(name) ? "Download" : "Again", () => this.#save(entry, name));
      control.setAttribute("aria-label", `Download ${name}`);
      return control;
    });
    const state = isMark(report.readBack) ? `survives ${survived} of ${report.forecast.length} changes` : "the mark does not hold";
    const about = h("p", { class: "hint" }, h("code", {}, asked.tag), ` ${owner === null ? "of a key file" : `of ${owner}`}, ${asked.strength}, ${state}`);
    return h("li", {}, h("strong", {}, marked.name), about, actions(...download, ...(entry === this.#shown ? [] : [show])));
  }

  #failedRow(failure: Failure): HTMLElement {
    const dismiss = button("Dismiss", () => this.#dismiss(failure));
    dismiss.setAttribute("aria-label", `Dismiss ${failure.host}`);
    return h("li", {}, h("strong", {}, failure.host), h("p", { class: "problem" }, `Not marked: ${problem(failure.error).text}.`), actions(dismiss));
  }

  /** The copies and their reports in one archive. */
  async #saveAll(entries: Entry[]): Promise<void> {
    const { zipSync } = await import("fflate");
    const files: Record<string, Uint8Array> = {};
    for (const [i, { copy }] of entries.entries()) {
      const isTwin = entries.some((other) => other.copy !== copy && other.copy.marked.name === copy.marked.name);
      const folder = isTwin || Object.keys(filesOf(copy.marked)).length > 1 ? `${i + 1} ${renamed(copy.marked.name, "")}/` : "";
      for (const [path, bytes] of Object.entries(filesOf(copy.marked))) {
        files[folder + path] = bytes;
      }
      files[`${folder}${renamed(copy.marked.name, "report.json")}`] = new TextEncoder().encode(`${JSON.stringify(await reportOf(copy), null, 2)}\n`);
    }
    save("marked.zip", zipSync(files, { level: 0 }) as BlobPart, "application/zip");
    entries.forEach((entry) => this.#taken(entry, ...namesOf(entry.copy)));
  }

  #card(entry: Entry): HTMLElement {
    const { copy, key } = entry;
    return copyCard(copy, {
      onSave: (name) => this.#save(entry, name),
      onCheck: () => this.events.onCheck(copy.marked),
      onDismiss: () => this.#dismiss(entry),
      ...(key && { ofThisVisit: { onSaveKey: () => void saveKey(key), onBreak: () => this.events.onBreak(), onStronger: () => this.events.onStronger() } }),
    });
  }
}

/** What the form says now that is not what a copy was made with, in words. */
function differences({ copy, host, key }: Entry, { model, asked }: Now): string[] {
  if (!host || !key) {
    return [];
  }
  const { tag, strength, carriers } = copy.asked;
  return [
    ...(key.isInForm() ? [] : ["another key"]),
    ...(asked.tag === tag ? [] : [asked.tag === "" ? "no tag" : `the tag ${asked.tag}`]),
    ...(asked.strength === strength ? [] : [`the strength ${asked.strength}`]),
    ...(asked.carriers.join() === carriers.join() ? [] : ["other places for the mark"]),
    ...(model === host.deref() ? [] : [model ? `the model ${model.name}` : "no model"]),
  ];
}

/** By the endings of files. */
const TYPES: Record<string, string> = { glb: "model/gltf-binary", gltf: "model/gltf+json", vrm: "model/gltf-binary", zip: "application/zip" };

function namesOf(copy: Copy): Set<string> {
  return new Set(downloads(copy));
}

async function saveKey(key: KeySource): Promise<void> {
  const bytes = await key.make(await engine, { signal: new AbortController().signal, stage: () => {}, onProgress: () => {} });
  save("meshmark.key", bytes.slice());
  bytes.fill(0);
}
