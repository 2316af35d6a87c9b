/** Check: a suspect and a key in, one sentence out; several suspects or keys, and a line for each. */
import type { DetailedExtraction, Inspection, Overlay, Tracing } from "meshmark";
import { answersList, chargeWords, isFound, type Line } from "./answers";
import { CheckStage } from "./check-stage";
import { answers, argumentsOf, compared, comparisonRows, headlineOf, naming, shapeAnswer, statedFiles, type Compared } from "./comparing";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { GivenField, isRecord, type Given } from "./given";
import { incompleteKeyField, keySource, severalKeys, type KeySource, type NamedKey } from "./key-form";
import { readLedger, type Ledger } from "./ledger";
import { isEvidence, renamed, type Found, type Model, type NamedFile } from "./model";
import { actions, card, carrierTable, chance, details, flag, note, numbers, readingRows } from "./outcome";
import { evidenceOf, read, withKey, type Answer } from "./reading";
import { checkReport, checksReport, comparisonReport } from "./report";
import { save, saveJson } from "./save";
import { tagProblem, watchTag } from "./tag";
import type { Task } from "./task";
import { View } from "./view";
import { homes, isMark, plain, VERDICTS } from "./words";

const DO_NOT_PASS_ON = "Keep these figures to yourself. They follow your key: whoever gets enough of them, for models of their own making, can make one in which your mark is found.";

const PROVES = "It does not say who made the model first, nor who passed it on: keep your dated original and the report of marking it.";

const PROVES_COMPARED = "It does not say who made the model first. And it proves something to others only if the original, or the record, is older than the suspect: whoever has a key can make an “original” that any model seems to be a copy of.";

const EVIDENCE = "Evidence was read, which says what whoever measured it likes: before you hold it against somebody, measure their model yourself.";

/** An answer's card, and what was asked. */
interface Asked {
  card: HTMLElement;
  model: Model;
  keys: Pick<KeySource, "isInForm">;
  expected: string | null;
  ledger: Ledger | null;
  given: Given | null;
}

/** What a tracing comes to, in a few words. */
const TRACED: Record<Tracing["traced"], string> = {
  named: "Whose copy it is",
  nobody: "Your mark is there, but no buyer can be named",
  "no-mark": "No evidence of this key",
  "cannot-check": "Cannot check",
};

export class Check extends View<CheckStage> {
  protected override readonly areSuspects = true;
  readonly #expected = find<HTMLInputElement>("#expected");
  readonly #ledgerFile = find<HTMLInputElement>("#ledger");
  #ledger: Ledger | null = null;
  /** Until the last ledger that was chosen is read; whether it could be. */
  #ledgerRead: Promise<boolean> = Promise.resolve(true);
  readonly #given = new GivenField(() => this.onOther());
  #asked: Asked | undefined;
  /** Whether the stage shows what was compared. */
  #isLaid = false;

  constructor(root: HTMLElement) {
    super(root, "Cannot check", CheckStage);
    watchTag(this.#expected);
    this.#expected.addEventListener("input", () => this.onOther());
    this.#ledgerFile.addEventListener("change", () => (this.#ledgerRead = this.#takeLedger()));
    find("#save-evidence").addEventListener("click", () => void this.#saveEvidence());
  }

  /** Takes a record for what the suspect is compared with, and all else for the suspect. */
  override async takeFiles(files: NamedFile[]): Promise<void> {
    const are = await Promise.all(files.map(({ file }) => isRecord(file)));
    const [records, others] = [files.filter((_, i) => are[i]), files.filter((_, i) => !are[i])];
    if (records.length > 0) {
      this.#given.take(records);
    }
    if (others.length > 0) {
      await super.takeFiles(others);
    }
  }

  /** Says whether the answer still is to what the form asks. */
  override onOther(): void {
    if (this.#asked) {
      const { card, model, keys, expected, ledger, given } = this.#asked;
      const now = this.#expected.value || null;
      const others = [
        ...(model === this.model ? [] : [this.model ? `the model ${this.model.name}` : "no model"]),
        ...(keys.isInForm() ? [] : ["another key"]),
        ...(ledger === this.#ledger ? [] : [this.#ledger === null ? "no ledger" : "another ledger"]),
        ...(given === this.#given.given ? [] : [this.#given.given === null ? "no original" : `${this.#given.given.name} to compare with`]),
        ...(expected === now ? [] : [now === null ? "no tag to look for" : `the tag ${now} to look for`]),
      ];
      flag(card, others, "This answer is to what it said before.");
    }
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const keys = severalKeys();
    const expected = this.#expected.value || null;
    const problem = keys.length > 0 && expected !== null ? "With several keys the tag is read, not looked for: leave this empty." : tagProblem(this.#expected.value);
    setProblem(this.#expected, problem);
    const isRead = await this.#ledgerRead;
    const isGiven = await this.#given.isReady();
    const model = this.ready(keyField ?? (problem ? this.#expected : isRead ? (isGiven ? null : this.#given.input) : this.#ledgerFile));
    if (!model) {
      return;
    }
    this.#dropLaid();
    if (this.#ledger) {
      await this.#trace(model, this.#ledger, this.#given.given);
      return;
    }
    if (this.#given.given) {
      await this.#compare(model, this.#given.given, expected);
      return;
    }
    if (keys.length > 0 || this.several.length > 1) {
      await this.#checkSeveral(model, keys, expected);
      return;
    }
    const key = keySource();
    const answer = await this.run(`Checking ${model.name}`, async (task) => read(await engine, model, key.make, expected, task));
    if (answer) {
      this.#show({ card: this.#card(model, key, expected, answer), model, keys: key, expected, ledger: null, given: null });
    }
  }

  async #checkSeveral(model: Model, keys: NamedKey[], expected: string | null): Promise<void> {
    const suspects: Found[] = this.several.length > 1 ? this.several : [{ name: model.name, open: async () => model }];
    const one = keys.length > 0 ? null : keySource();
    const lines = await this.run("Checking", async (task) => {
      const lines: Line[] = [];
      for (const [i, { name, open }] of suspects.entries()) {
        task.headline(`Checking ${i + 1} of ${suspects.length}: ${name}`);
        try {
          const suspect = await open();
          lines.push(...(one ? [{ suspect: name, key: null, answer: await read(await engine, suspect, one.make, expected, task) }] : await readMany(suspect, keys, task)));
        } catch (error) {
          if (task.signal.aborted) {
            throw error;
          }
          lines.push({ suspect: name, error });
        }
      }
      return lines;
    });
    if (lines) {
      const isInForm = () => (one ? one.isInForm() : severalKeys() === keys);
      this.#show({ card: this.#linesCard(lines, suspects.length, keys.length, expected), model, keys: { isInForm }, expected, ledger: null, given: null });
    }
  }

  async #takeLedger(): Promise<boolean> {
    const file = this.#ledgerFile.files?.[0];
    try {
      this.#ledger = file ? await readLedger(file) : null;
      setProblem(this.#ledgerFile, null);
    } catch (error) {
      this.#ledger = null;
      setProblem(this.#ledgerFile, error instanceof Error ? error.message : String(error));
      return false;
    } finally {
      this.onOther();
    }
    return true;
  }

  /** Reads a suspect with its original, or with the record of marking it. */
  async #compare(model: Model, given: Given, expected: string | null): Promise<void> {
    const problem = isEvidence(model) || severalKeys().length > 0 || this.several.length > 1 ? "With an original or a record, one model is checked with one key; no evidence, and not several." : null;
    setProblem(this.#given.input, problem);
    if (problem) {
      this.#given.input.focus();
      return;
    }
    const key = keySource();
    const answer = await this.run(`Comparing ${model.name} with ${given.name}`, (task) => compared(model, given, key, expected, task));
    if (!answer) {
      return;
    }
    const card = this.#comparisonCard(model, given, key, expected, answer);
    this.#show({ card, model, keys: key, expected, ledger: null, given });
    await this.#lay(model, answer.overlay);
  }

  /** Shows the suspect where it lies on the original, if it does. */
  async #lay(model: Model, overlay: Overlay | null): Promise<void> {
    if (overlay) {
      this.#isLaid = true;
      await this.stage.showLaid(overlay, () => this.model === model && this.#isLaid);
    }
  }

  /** Shows the suspect alone again. */
  #dropLaid(): void {
    if (this.#isLaid) {
      this.#isLaid = false;
      this.stage.dropLaid();
    }
  }

  #comparisonCard(model: Model, given: Given, key: KeySource, expected: string | null, answer: Compared): HTMLElement {
    const isOther = expected !== null && answer.verdict === "found" && answer.tag !== expected;
    const name = answer.tag ?? String(answer.number);
    const sha256 = this.inspection?.sha256 ?? null;
    const figures = numbers(comparisonRows(answer));
    return card(
      isOther ? "partial" : answer.verdict,
      isOther ? `Your key’s mark, with ${answer.tag === null ? "number" : "tag"} ${name}, not ${expected}` : headlineOf(answer),
      [`${model.name}, compared with ${given.kind === "record" ? "the record" : "the original"} ${given.name}, with ${key.owner === null ? "the key of a file" : `the key of ${key.owner}`}${key.work === null ? "" : ` for the work ${key.work}`}${expected === null ? "" : `, looked at for the tag ${expected}`}.`],
      answers(answer, given),
      ...(isMark(answer) ? [h("p", { class: "hint" }, PROVES_COMPARED), details("In numbers", figures)] : [details("Details for the owner", h("p", { class: "hint" }, DO_NOT_PASS_ON), figures)]),
      ...(answer.overlay ? [h("p", { class: "hint" }, "The viewer shows the suspect where it lies on the original: move the line between them, see how far they are apart, and which places speak for your mark. That last map follows your key: keep it to yourself.")] : []),
      actions(
        button("Save report (HTML)", () => save(renamed(model.name, "report.html"), answer.statement, "text/html")),
        button("Save report (JSON)", async () => saveJson(renamed(model.name, "report.json"), await comparisonReport(model.name, sha256, given, expected, answer))),
        button("Dismiss", () => this.#dismiss()),
      ),
    );
  }

  /** Whose copies a model was made of; with the original or the record, where there is one. */
  async #trace(model: Model, ledger: Ledger, given: Given | null): Promise<void> {
    const problem = isEvidence(model) || severalKeys().length > 0 || this.several.length > 1 ? "With a ledger, one model is checked with one key; no evidence, and not several." : null;
    setProblem(this.#ledgerFile, problem);
    if (problem) {
      this.#ledgerFile.focus();
      return;
    }
    const key = keySource();
    const tracing = await this.run(`Tracing ${model.name}`, async (task) => {
      const client = await engine;
      const [suspect, ...others] = await statedFiles(model, given);
      const statement = {
        ...(key.owner === null ? {} : { owner: key.owner }),
        date: new Date().toISOString(),
        files: [suspect!, { role: "Ledger", name: ledger.file, bytes: ledger.bytes, sha256: ledger.sha256 }, ...others],
        names: Object.fromEntries(ledger.names),
        triangles: ledger.triangles,
        commands: [`meshmark trace ${model.name} --ledger ${ledger.file} ${argumentsOf(key, given)}`],
      };
      const beside = given === null ? {} : { overlay: true, ...(given.kind === "record" ? { record: given.text } : { original: given.model.bytes, originalFiles: given.model.buffers }) };
      const numbers = Float64Array.from(ledger.names.keys());
      const { signal, onProgress } = task;
      const options = { files: model.buffers, statement, signal, onProgress, ...beside };
      return withKey(client, key.make, task, (bytes) => client.trace(model.bytes, bytes, numbers, options).catch(naming(given?.name ?? model.name)));
    });
    if (tracing) {
      this.#show({ card: this.#tracingCard(model, ledger, given, tracing), model, keys: key, expected: this.#expected.value || null, ledger, given });
      await this.#lay(model, tracing.overlay ?? null);
    }
  }

  #tracingCard(model: Model, ledger: Ledger, given: Given | null, tracing: Tracing): HTMLElement {
    const { traced, sentence, buyers, numBuyers, comparison, statement = "" } = tracing;
    const buyer = ({ number, lnP }: Tracing["buyers"][number]) => h("li", {}, h("strong", {}, ledger.names.get(number) || `Number ${number}`), h("p", { class: "hint" }, `Copy ${number}; by chance `, chance(lnP)));
    return card(
      traced === "named" ? "found" : traced === "nobody" ? "present" : traced === "no-mark" ? "none" : "cannot-check",
      TRACED[traced],
      [`${model.name}, with the ${numBuyers} buyers of ${ledger.file}${given ? ` and with the ${given.kind} ${given.name}` : ""}; that they are so many is charged in each chance.`, sentence],
      h("ul", { class: "copies" }, ...buyers.map(buyer)),
      ...(given && comparison ? [h("dl", { class: "answers" }, shapeAnswer(comparison, given))] : []),
      ...(traced === "named" ? [h("p", { class: "hint" }, "A copy may have been stolen from its buyer, and whoever keeps the ledger can stamp any number: the report says what this does not prove.")] : []),
      actions(
        button("Save report (HTML)", () => save(renamed(model.name, "report.html"), statement, "text/html")),
        button("Dismiss", () => this.#dismiss()),
      ),
    );
  }

  /** What is measured of the model: whoever has the key can check it, without the model, and without telling the key. */
  async #saveEvidence(): Promise<void> {
    const model = this.ready(null);
    if (!model) {
      return;
    }
    const evidence = await this.run(`Measuring ${model.name}`, async (task) => evidenceOf(await engine, model, task));
    if (evidence) {
      const name = renamed(model.name, "mmev");
      save(name, evidence.slice());
      this.outcome.tell(note(`Saved as ${name}. Whoever has the key drops it here, instead of the model.`));
    }
  }

  #show(asked: Asked): void {
    this.#asked = asked;
    this.outcome.finish(asked.card);
    this.outcome.present(asked.card);
    this.onOther();
  }

  #dismiss(): void {
    this.#dropLaid();
    this.#asked = undefined;
    this.outcome.finish();
    find("button[type=submit]", this.form).focus();
  }

  #linesCard(lines: Line[], numSuspects: number, numKeys: number, expected: string | null): HTMLElement {
    const found = lines.filter(isFound).length;
    const of = numKeys > 0 ? `${numKeys} keys` : `${numSuspects} models`;
    const headline = numKeys > 0 && numSuspects > 1 ? `${found} marks found: ${numKeys} keys in ${numSuspects} models` : numKeys > 0 ? `${found} of ${of} found` : `Your mark was found in ${found} of ${of}`;
    return card(
      found > 0 ? "found" : "none",
      headline,
      [chargeWords(numSuspects, numKeys)],
      ...(found > 0 ? [h("p", { class: "hint" }, PROVES)] : []),
      ...(lines.some((line) => isFound(line) && isEvidence({ name: line.suspect })) ? [h("p", { class: "sentence" }, EVIDENCE)] : []),
      answersList(lines),
      actions(
        button("Save report (JSON)", async () => saveJson("checks.report.json", await checksReport(numSuspects, Math.max(numKeys, 1), expected, lines))),
        button("Dismiss", () => this.#dismiss()),
      ),
    );
  }

  #card(model: Model, key: KeySource, expected: string | null, { reading, isOther }: Answer): HTMLElement {
    const [figures, carriers] = [numbers(readingRows(reading)), carrierTable(reading.carriers)];
    const sha256 = this.inspection?.sha256 ?? null;
    const file = numbers([["SHA-256", h("code", { class: "hash" }, sha256 ?? "unknown")]]);
    const name = reading.tag ?? String(reading.number);
    return card(
      isOther ? "partial" : reading.verdict,
      isOther ? `Your key’s mark, with ${reading.tag === null ? "number" : "tag"} ${name}, not ${expected}` : VERDICTS[reading.verdict],
      [`${model.name}, with ${key.owner === null ? "the key of a file" : `the key of ${key.owner}`}${key.work === null ? "" : ` for the work ${key.work}`}${expected === null ? "" : `, looked at for the tag ${expected}`}.`, ...sentences(reading)],
      ...(reading.input === "evidence" && isMark(reading) ? [h("p", { class: "sentence" }, EVIDENCE)] : []),
      ...(isMark(reading)
        ? [h("p", { class: "hint" }, PROVES), figures, details("Carriers and file", carriers, file)]
        : [details("Details for the owner", h("p", { class: "hint" }, DO_NOT_PASS_ON), figures, carriers), details("File", file)]),
      actions(
        button("Save report (JSON)", async () => saveJson(renamed(model.name, "report.json"), await checkReport(model.name, sha256, expected, reading))),
        button("Dismiss", () => this.#dismiss()),
      ),
    );
  }
}

/** Reads a suspect with every key; the number of keys is charged. */
async function readMany(suspect: Model, keys: NamedKey[], task: Task): Promise<Line[]> {
  const client = await engine;
  const evidence = await evidenceOf(client, suspect, task);
  task.stage("test");
  const readings = await client.extractMany(evidence, keys.map(({ bytes }) => bytes), { details: true, signal: task.signal });
  const input = isEvidence(suspect) ? "evidence" : "model"; // what was handed in, not what it was measured to be
  return readings.map((reading, i) => ({ suspect: suspect.name, key: keys[i]!.name, answer: { reading: { ...(reading as DetailedExtraction), input }, isOther: false } }));
}

function sentences(reading: DetailedExtraction): string[] {
  const { verdict, reason, tag } = reading;
  const why = reason === null ? [] : [plain(reason)];
  const where = homes(reading);
  const beside = [...(where === null ? [] : [`Read from ${where}.`]), ...(reading.caution === null ? [] : [plain(reading.caution)])];
  switch (verdict) {
    case "found":
      return [...(tag === null ? why : [`It carries the tag ${tag}, written with this key.`]), ...beside];
    case "present":
      return ["Its mark says whose it is, and holds no tag, or none that can be read any more.", ...beside];
    case "none":
      return ["What was read agrees with this key no better than by chance. This does not prove that the model is not yours."];
    case "cannot-check":
      return ["The model is too small or too simple to tell."];
    default:
      return why;
  }
}
