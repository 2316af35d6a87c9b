/** Check: a suspect and a key in, one sentence out. */
import type { Extraction } from "meshmark";
import type { Client } from "meshmark/client";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { incompleteKeyField, keyMaker, type KeyMaker } from "./key-form";
import { renamed, type Model } from "./model";
import { actions, card, carrierTable, details, numbers, present, readingRows } from "./outcome";
import { checkReport } from "./report";
import { saveJson } from "./save";
import { tagProblem, watchTag } from "./tag";
import { runTask, type Progress } from "./task";
import { View } from "./view";
import { VERDICTS } from "./words";

export class Check extends View {
  readonly #expected = find<HTMLInputElement>("#expected");
  /** The last measurement: it holds no key, so that another one can be tried at once. */
  #measured: { model: Model; evidence: Uint8Array } | undefined;

  constructor(root: HTMLElement) {
    super(root, "Cannot check");
    watchTag(this.#expected);
  }

  protected async submit(): Promise<void> {
    const keyField = incompleteKeyField();
    const problem = tagProblem(this.#expected.value);
    setProblem(this.#expected, problem);
    const model = this.ready(keyField ?? (problem ? this.#expected : null));
    if (!model) {
      return;
    }
    const [expected, key] = [this.#expected.value || null, keyMaker()];
    await this.run(async (controller) => {
      const reading = await runTask(this.outcome, controller, (progress) => this.#read(model, expected, key, progress));
      if (reading && model === this.model) {
        present(this.outcome, this.#card(model, expected, reading));
      }
    });
  }

  async #read(model: Model, expected: string | null, makeKey: KeyMaker, progress: Progress): Promise<Extraction> {
    const client = await engine;
    const evidence = await this.#measure(client, model, progress);
    const key = await makeKey(client, progress);
    progress.stage("test");
    try {
      return expected === null ? await client.extract(evidence, key, progress) : await client.verify(evidence, key, expected, progress);
    } finally {
      key.fill(0);
    }
  }

  async #measure(client: Client, model: Model, progress: Progress): Promise<Uint8Array> {
    if (this.#measured?.model !== model) {
      progress.stage("read");
      this.#measured = { model, evidence: await client.measure(model.bytes, model.buffers, progress) };
    }
    return this.#measured.evidence;
  }

  #card(model: Model, expected: string | null, reading: Extraction): HTMLElement {
    return card(
      reading.verdict,
      VERDICTS[reading.verdict],
      sentences(reading),
      numbers(readingRows(reading)),
      details("Carriers and file", carrierTable(reading.carriers), numbers([["SHA-256", h("code", { class: "hash" }, this.inspection?.sha256 ?? "unknown")]])),
      actions(button("Save report (JSON)", async () => saveJson(renamed(model.name, "report.json"), await checkReport(model, this.inspection?.sha256 ?? null, expected, reading)))),
    );
  }
}

function sentences({ verdict, reason, tag }: Extraction): string[] {
  const why = reason === null ? [] : [reason];
  switch (verdict) {
    case "found":
      return tag === null ? why : [`This model carries the tag ${tag}, written with this key.`];
    case "none":
      return ["This does not prove that the model is not yours.", ...why];
    default:
      return why;
  }
}
