/** The field in Check for what a suspect is compared with: the original, or the record of marking it. Which it is, its content says. */
import { unpacked } from "./archive";
import { find, setProblem } from "./dom";
import { isEvidence, modelsIn, type Model, type NamedFile } from "./model";

/** What a suspect is compared with. */
export type Given = { kind: "original"; name: string; model: Model } | { kind: "record"; name: string; text: string; bytes: Uint8Array<ArrayBuffer> };

/** What a record says of itself, for anybody. */
interface Clear {
  owner?: unknown;
  date?: unknown;
  tag?: unknown;
}

/** Records are of some tens of kilobytes. */
const MOST_RECORD_BYTES = 2 ** 24;
/** A record has this near its beginning, and whatever became of the rest, it was to be one. */
const KIND = /"kind"\s*:\s*"meshmark record"/;
const WHERE_KIND_IS = 4096;

/** Whether a file is a record, by its content. */
export async function isRecord(file: File): Promise<boolean> {
  return file.size <= MOST_RECORD_BYTES && KIND.test(await file.slice(0, WHERE_KIND_IS).text());
}

export class GivenField {
  readonly #input = find<HTMLInputElement>("#given");
  readonly #state = find("#given-state");
  readonly #clear = find<HTMLButtonElement>("#given-clear");
  #given: Given | null = null;
  /** Counts what was chosen: a slow one that has been replaced must not be taken. */
  #turn = 0;
  /** Until what was chosen last is read; whether it could be. */
  #read: Promise<boolean> = Promise.resolve(true);

  /** @param onOther something else is given now */
  constructor(readonly onOther: () => void) {
    this.#input.addEventListener("change", () => this.take([...(this.#input.files ?? [])].map((file) => ({ path: file.name, file }))));
    this.#clear.addEventListener("click", () => {
      this.#input.value = "";
      this.take([]);
      this.#input.focus();
    });
  }

  get given(): Given | null {
    return this.#given;
  }

  /** The field, to be said what is wrong with. */
  get input(): HTMLInputElement {
    return this.#input;
  }

  /** Whether what was chosen last could be read, once it is. */
  isReady(): Promise<boolean> {
    return this.#read;
  }

  /** Takes the original or the record among some files; none: nothing is given. */
  take(files: NamedFile[]): void {
    const turn = ++this.#turn;
    this.#read = (async () => {
      let [given, problem]: [Given | null, string | null] = [null, null];
      try {
        given = files.length === 0 ? null : await givenIn(files);
      } catch (error) {
        problem = error instanceof Error ? error.message : String(error);
      }
      if (turn === this.#turn) {
        this.#given = given;
        setProblem(this.#input, problem);
        this.#state.textContent = given ? words(given) : "";
        this.#clear.hidden = files.length === 0;
        this.onOther();
      }
      return problem === null;
    })();
  }
}

async function givenIn(files: NamedFile[]): Promise<Given> {
  for (const { file } of files) {
    if (await isRecord(file)) {
      const bytes = new Uint8Array(await file.arrayBuffer());
      return { kind: "record", name: file.name, text: new TextDecoder().decode(bytes), bytes };
    }
  }
  const found = modelsIn(await unpacked(files), true);
  if (found.length > 1) {
    throw new Error(`There are ${found.length} models in this; choose one of them, with its own files.`);
  }
  const model = await found[0]!.open();
  if (isEvidence(model)) {
    throw new Error(`“${model.name}” is evidence. A suspect is compared with the original itself, or with its record.`);
  }
  return { kind: "original", name: model.name, model };
}

/** What it is, in words. A record's own words are its maker's: shown as text, and proven by nothing until the key opens it. */
function words(given: Given): string {
  if (given.kind === "original") {
    return `${given.name} is taken for the original.`;
  }
  let clear: Clear = {};
  try {
    clear = JSON.parse(given.text) as Clear;
  } catch {
    return `${given.name} is a record, and damaged.`;
  }
  const said = (name: string, value: unknown) => (typeof value === "string" && value !== "" ? [`${name} ${value}`] : []);
  const facts = [...said("owner", clear.owner), ...said("tag", clear.tag), ...said("date", clear.date)];
  return `${given.name} is a record${facts.length > 0 ? `: ${facts.join(", ")}` : ""}.`;
}
