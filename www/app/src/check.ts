/** Check: a suspect and a key in, one sentence out. */
import type { DetailedExtraction } from "meshmark";
import { button, find, h, setProblem } from "./dom";
import { engine } from "./engine";
import { incompleteKeyField, keyMaker, type KeyMaker } from "./key-form";
import { renamed, type Model } from "./model";
import { actions, card, carrierTable, details, numbers, present, readingRows } from "./outcome";
import { detect } from "./reading";
import { checkReport } from "./report";
import { saveJson } from "./save";
import { Stage } from "./stage";
import { tagProblem, watchTag } from "./tag";
import { runTask, type Progress } from "./task";
import { View } from "./view";
import { homes, VERDICTS } from "./words";

const DO_NOT_PASS_ON = "Keep these figures to yourself. They follow your key: whoever gets enough of them, for models of their own making, can make one in which your mark is found.";

export class Check extends View<Stage> {
  readonly #expected = find<HTMLInputElement>("#expected");

  constructor(root: HTMLElement) {
    super(root, "Cannot check", Stage);
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
      const reading = await runTask(this.outcome, controller, (progress) => read(model, expected, key, progress));
      if (reading && model === this.model) {
        present(this.outcome, this.#card(model, expected, reading));
      }
    });
  }

  #card(model: Model, expected: string | null, reading: DetailedExtraction): HTMLElement {
    const [figures, carriers] = [numbers(readingRows(reading)), carrierTable(reading.carriers)];
    const file = numbers([["SHA-256", h("code", { class: "hash" }, this.inspection?.sha256 ?? "unknown")]]);
    return card(
      reading.verdict,
      VERDICTS[reading.verdict],
      sentences(reading),
      ...(reading.verdict === "found"
        ? [figures, details("Carriers and file", carriers, file)]
        : [details("Details for the owner", h("p", { class: "hint" }, DO_NOT_PASS_ON), figures, carriers), details("File", file)]),
      actions(button("Save report (JSON)", async () => saveJson(renamed(model.name, "report.json"), await checkReport(model, this.inspection?.sha256 ?? null, expected, reading)))),
    );
  }
}

async function read(model: Model, expected: string | null, makeKey: KeyMaker, progress: Progress): Promise<DetailedExtraction> {
  const client = await engine;
  const key = await makeKey(client, progress);
  progress.stage("read");
  try {
    return await detect(client, model, key, expected, progress);
  } finally {
    key.fill(0);
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
