/**
 * Finished copies. The one whose model is shown has a card that says what it was made with, and whether the form says something else by
 * now; all have a list. They stay until their owner dismisses them, and what was not downloaded through a reload.
 */
import type { EmbedReport } from "meshmark";
import { button, find, h } from "./dom";
import type { KeySource } from "./key-form";
import { actions, carrierTable, card, details, displacement, flag, forecastList, numbers, readingRows, type Outcome } from "./outcome";
import { downloads, reportOf, whose, type Asked, type Copy } from "./copy";
import { engine } from "./engine";
import { renamed, type Model } from "./model";
import { save, saveJson } from "./save";
import { forget, keep, kept } from "./store";
import { CARRIERS, losses, plain, problem, significant } from "./words";

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
  /** What it was made of and with; unknown of a copy from before a reload. */
  host?: Model;
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
    for (const copy of await kept()) {
      if (!this.#copies().some((entry) => entry.copy.id === copy.id)) {
        this.#put({ copy, left: namesOf(copy), card: h("section") });
      }
    }
  }

  /** Takes a copy in that was finished now, and shows its card. */
  add(copy: Copy, host: Model, key: KeySource): void {
    this.#put({ copy, host, key, left: namesOf(copy), card: h("section") });
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
    return this.#shown?.host && this.#shown.host === this.now().model ? this.#shown.copy : undefined;
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
    const file = downloads(entry.copy).find((file) => file.name === name)!;
    save(name, file.bytes as BlobPart, name.endsWith(".gltf") ? "model/gltf+json" : "model/gltf-binary");
    this.#taken(entry, name);
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
    const download = downloads(entry.copy).map(({ name }) => {
      const control = button(entry.left.has(name) ? "Download" : "Again", () => this.#save(entry, name));
      control.setAttribute("aria-label", `Download ${name}`);
      return control;
    });
    const state = report.readBack.verdict === "found" ? `survives ${survived} of ${report.forecast.length} changes` : "the mark does not hold";
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
      const folder = isTwin || copy.files.length > 0 ? `${i + 1} ${renamed(copy.marked.name, "")}/` : "";
      for (const { name, bytes } of downloads(copy)) {
        files[folder + name] = bytes;
      }
      files[`${folder}${renamed(copy.marked.name, "report.json")}`] = new TextEncoder().encode(`${JSON.stringify(await reportOf(copy), null, 2)}\n`);
    }
    save("marked.zip", zipSync(files, { level: 0 }) as BlobPart, "application/zip");
    entries.forEach((entry) => this.#taken(entry, ...namesOf(entry.copy)));
  }

  #card(entry: Entry): HTMLElement {
    const { copy, host, key } = entry;
    const { marked, report, files, owner, asked } = copy;
    const { readBack } = report;
    const holds = readBack.verdict === "found";
    const lost = holds ? losses(report.forecast) : null;
    const [main, ...others] = downloads(copy).map(({ name }) => button(`Download ${name}`, () => this.#save(entry, name), "primary"));
    const stronger = lost !== null && host && asked.strength !== "strong" ? [actions(button(`Mark again, ${asked.strength === "subtle" ? "balanced" : "strong"}`, () => this.events.onStronger()))] : [];
    const earlier = host ? [] : [`Made ${new Date(copy.made).toLocaleString()}, and not downloaded since. This browser keeps it until you download or dismiss it.`];
    return card(
      readBack.verdict,
      holds ? "Your mark is in the copy" : "The mark does not hold in this model",
      [holds ? `${marked.name} carries ${whose(copy)}: it was read back from the finished file.` : `${marked.name}: ${plain(readBack.reason ?? readBack.sentence)}`, ...earlier],
      ...(lost === null ? [] : [h("p", { class: "sentence warning" }, lost), ...stronger]),
      actions(main!, ...others),
      ...(files.length > 0 ? [h("p", { class: "hint" }, "The .gltf names its other files: put these in the places of the originals, textures stay as they are.")] : []),
      forecastList(report.forecast),
      numbers([...readingRows(readBack), ["Owner", owner ?? "a key file"], ["Read from", holders(report), "Where the mark lives in this copy: in its shape, or in how its vertices are connected."]]),
      displacement(report),
      details(
        "Carriers and files",
        carrierTable(readBack.carriers),
        numbers([
          ["Diagonal", `${significant(report.diagonal)} units`, "Of the box around the model, in the units of its file."],
          ["Tag as a number", String(report.number)],
          ["SHA-256 of the original", h("code", { class: "hash" }, report.hostSha256)],
          ["SHA-256 of the copy", h("code", { class: "hash" }, report.markedSha256)],
        ]),
      ),
      h("h3", {}, "To keep beside the original"),
      h("p", { class: "hint" }, "Keep the original to yourself, with the report and the key: together they show later what you marked, when, and how. Whoever has the key file has the key."),
      actions(
        button("Save report (JSON)", async () => saveJson(renamed(marked.name, "report.json"), await reportOf(copy))),
        ...(key ? [button("Save key file", () => void saveKey(key))] : []),
      ),
      actions(
        button("Check this copy", () => this.events.onCheck(marked)),
        ...(holds && host ? [button("Try to break it", () => this.events.onBreak())] : []),
        button("Dismiss", () => this.#dismiss(entry)),
      ),
    );
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
    ...(model === host ? [] : [model ? `the model ${model.name}` : "no model"]),
  ];
}

function namesOf(copy: Copy): Set<string> {
  return new Set(downloads(copy).map(({ name }) => name));
}

async function saveKey(key: KeySource): Promise<void> {
  const bytes = await key.make(await engine, { signal: new AbortController().signal, stage: () => {}, onProgress: () => {} });
  save("meshmark.key", bytes.slice());
  bytes.fill(0);
}

/** The carriers from which the mark was read back; another one may be too weak in this model. */
function holders({ number, readBack }: EmbedReport): string {
  const holding = readBack.carriers.filter((carrier) => carrier.number === number);
  return holding.map(({ name }) => CARRIERS[name].name).join(", ");
}
