/** Check: a suspect and a key in, one sentence out. */
import type { DetailedExtraction, Inspection } from "meshmark";
import { capacityWords } from "./capacity";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { incompleteKeyField, keySource, type KeySource } from "./key-form";
import { renamed, type Model } from "./model";
import { actions, card, carrierTable, details, flag, note, numbers, readingRows } from "./outcome";
import { read, type Answer } from "./reading";
import { checkReport } from "./report";
import { saveJson } from "./save";
import { Stage } from "./stage";
import { tagProblem, watchTag } from "./tag";
import { View } from "./view";
import { homes, VERDICTS } from "./words";

const DO_NOT_PASS_ON = "Keep these figures to yourself. They follow your key: whoever gets enough of them, for models of their own making, can make one in which your mark is found.";

const PROVES = "It does not say who made the model first, nor who passed it on: keep your dated original and the report of marking it.";

/** An answer's card, and what was asked. */
interface Asked {
  card: HTMLElement;
  model: Model;
  key: KeySource;
  expected: string | null;
}

export class Check extends View<Stage> {
  readonly #expected = find<HTMLInputElement>("#expected");
  #asked: Asked | undefined;

  constructor(root: HTMLElement) {
    super(root, "Cannot check", Stage);
    watchTag(this.#expected);
    this.#expected.addEventListener("input", () => this.onOther());
  }

  protected override foresee({ capacity }: Inspection): HTMLElement | null {
    const words = capacityWords(capacity);
    return words === null ? null : note(words);
  }

  /** Says whether the answer still is to what the form asks. */
  override onOther(): void {
    if (this.#asked) {
      const { card, model, key, expected } = this.#asked;
      const now = this.#expected.value || null;
      const others = [
        ...(model === this.model ? [] : [this.model ? `the model ${this.model.name}` : "no model"]),
        ...(key.isInForm() ? [] : ["another key"]),
        ...(expected === now ? [] : [now === null ? "no tag to look for" : `the tag ${now} to look for`]),
      ];
      flag(card, others, `This answer is about ${model.name}${key.owner === null ? "" : ` and the key of ${key.owner}`}.`);
    }
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = tagProblem(this.#expected.value);
    setProblem(this.#expected, problem);
    const model = this.ready(keyField ?? (problem ? this.#expected : null));
    if (!model) {
      return;
    }
    const [expected, key] = [this.#expected.value || null, keySource()];
    const answer = await this.run(`Checking ${model.name}`, async (task) => read(await engine, model, key.make, expected, task));
    if (answer) {
      this.#show({ card: this.#card(model, key, expected, answer), model, key, expected });
    }
  }

  #show(asked: Asked): void {
    this.#asked = asked;
    this.outcome.finish(asked.card);
    this.outcome.present(asked.card);
    this.onOther();
  }

  #dismiss(): void {
    this.#asked = undefined;
    this.outcome.finish();
    find("button[type=submit]", this.form).focus();
  }

  #card(model: Model, key: KeySource, expected: string | null, { reading, isOther }: Answer): HTMLElement {
    const [figures, carriers] = [numbers(readingRows(reading)), carrierTable(reading.carriers)];
    const sha256 = this.inspection?.sha256 ?? null;
    const file = numbers([["Model", model.name], ...(key.owner === null ? [] : [["Owner", key.owner] as [string, string]]), ["SHA-256", h("code", { class: "hash" }, sha256 ?? "unknown")]]);
    const name = reading.tag ?? String(reading.number);
    return card(
      isOther ? "partial" : reading.verdict,
      isOther ? `Your key’s mark, with ${reading.tag === null ? "number" : "tag"} ${name}, not ${expected}` : VERDICTS[reading.verdict],
      sentences(reading),
      ...(reading.verdict === "found"
        ? [h("p", { class: "hint" }, PROVES), figures, details("Carriers and file", carriers, file)]
        : [details("Details for the owner", h("p", { class: "hint" }, DO_NOT_PASS_ON), figures, carriers), details("File", file)]),
      actions(
        button("Save report (JSON)", async () => saveJson(renamed(model.name, "report.json"), await checkReport(model.name, sha256, expected, reading))),
        button("Dismiss", () => this.#dismiss()),
      ),
    );
  }
}

function sentences(reading: DetailedExtraction): string[] {
  const { verdict, reason, tag } = reading;
  const why = reason === null ? [] : [reason];
  const where = homes(reading);
  switch (verdict) {
    case "found":
      return [...(tag === null ? why : [`This model carries the tag ${tag}, written with this key.`]), ...(where === null ? [] : [`Read from ${where}.`])];
    case "none":
      return ["This does not prove that the model is not yours.", ...why];
    default:
      return why;
  }
}
