/** Study: a model's hosts, before and after smoothing, and the paper's experiment on it. */
import type { Fields, Preparation, Prepared, Ranking, Smoothing, Tracing } from "../../research-wasm/research.js";
import { announce, find, h, setProblem } from "../dom";
import type { Model } from "../model";
import { errorCard, numbers } from "../outcome";
import { View } from "../view";
import { count } from "../words";
import * as engine from "./engine";
import { Measured } from "./measured";
import { StudyStage } from "./stage";
import type { Version } from "./viewer";
import { PREPARATIONS, RANKINGS, SMOOTHINGS } from "./words";

interface Choice {
  ranking: Ranking;
  smoothing: Smoothing;
  iterations: number;
  numHosts: number;
}

/** What was made for a choice. */
interface Traced {
  choice: Choice;
  tracing: Tracing;
  fields: Partial<Record<Version, Fields>>;
  /** How long the mesh took to rank, and how many of its vertices were rejected. */
  ms: number;
  rejected: number;
}

export class Study extends View<StudyStage> {
  readonly #preparation = find<HTMLSelectElement>("#preparation");
  readonly #ranking = find<HTMLSelectElement>("#ranking");
  readonly #numHosts = find<HTMLInputElement>("#hosts");
  readonly #smoothing = find<HTMLSelectElement>("#smoothing");
  readonly #words = find("#traced");
  readonly #measured = find("#measured");
  /** Counts the models, and the preparations of each: what comes late must not be shown. */
  #turn = 0;
  #mesh: Prepared | undefined;
  #traced: Traced | undefined;
  #isFollowing = false;
  #isBehind = false;
  /** The model of another view that was last taken from there. */
  #offered: Model | undefined;

  constructor(root: HTMLElement) {
    super(root, "Cannot study", StudyStage);
    fill(this.#preparation, PREPARATIONS, "optimize");
    fill(this.#ranking, RANKINGS, "collapse");
    fill(this.#smoothing, SMOOTHINGS, "meshSmooth");
    this.#describe();
    for (const control of [this.#ranking, this.#numHosts, this.#smoothing, ...this.#iterations()]) {
      control.addEventListener("input", () => {
        this.#describe();
        void this.#follow();
      });
    }
    this.#preparation.addEventListener("input", () => {
      this.#describe();
      if (this.model) {
        void this.take(this.model);
      }
    });
    this.stage.onLook = () => void this.#follow();
  }

  /** Begins with what another view shows. */
  onShown(isShown: boolean, other: Model | undefined): void {
    if (isShown && other && other !== this.#offered) {
      this.#offered = other;
      void this.take(other);
    }
  }

  override async take(model: Model): Promise<void> {
    this.#forget();
    const turn = this.#turn;
    await super.take(model);
    const { inspection } = this;
    if (turn !== this.#turn || !inspection) {
      return;
    }
    this.#say("Reading the model, and simplifying what is larger than the paper’s …");
    try {
      const mesh = await engine.prepare(model.bytes, this.#preparation.value as Preparation, { files: model.buffers });
      const parameters = await engine.parameters();
      if (turn !== this.#turn) {
        return;
      }
      const most = mesh.positions.length / 3;
      this.#mesh = mesh;
      this.#numHosts.max = String(most);
      this.#numHosts.value = String(Math.min(parameters.numHosts, Math.ceil(most / 5)));
      await this.stage.frame(model.name, mesh, inspection);
      await this.#follow();
    } catch (error) {
      this.#fail(turn, error);
    }
  }

  protected override close(): void {
    this.#forget();
    super.close();
  }

  protected async submit(): Promise<void> {
    const choice = this.#choice();
    const model = this.ready(choice ? null : this.#numHosts);
    const mesh = this.#mesh;
    if (!model || !mesh || !choice) {
      return;
    }
    const parameters = await engine.parameters();
    const isDone = await this.run(`Measuring ${model.name}`, async (task) => {
      const measured = new Measured(this.#measured, mesh, choice.smoothing, choice.numHosts, parameters);
      await measured.run(task);
      return true;
    });
    if (isDone) {
      announce("Table I and Fig. 5 are measured.");
    }
  }

  #describe(): void {
    find("#preparation-hint").textContent = PREPARATIONS[this.#preparation.value as Preparation].hint;
    find("#ranking-hint").textContent = RANKINGS[this.#ranking.value as Ranking].hint;
    find("#smoothing-hint").textContent = SMOOTHINGS[this.#smoothing.value as Smoothing].hint;
  }

  #forget(): void {
    this.#turn++;
    this.#mesh = this.#traced = undefined;
    this.#words.hidden = true;
    this.#measured.replaceChildren();
  }

  #iterations(): HTMLInputElement[] {
    return [...find("#iterations").querySelectorAll("input")];
  }

  /** What the form says; `null`, said beside the field, where a number is none. */
  #choice(): Choice | null {
    const [numHosts, most] = [Number(this.#numHosts.value), Number(this.#numHosts.max)];
    const isRight = Number.isInteger(numHosts) && numHosts >= 1 && numHosts <= most;
    setProblem(this.#numHosts, isRight || !this.#mesh ? null : `Give a whole number from 1 to ${count(most)}.`);
    const iterations = Number(this.#iterations().find((radio) => radio.checked)?.value);
    return isRight ? { ranking: this.#ranking.value as Ranking, smoothing: this.#smoothing.value as Smoothing, iterations, numHosts } : null;
  }

  /** Shows what is chosen now; what is chosen meanwhile is shown next, all at once. */
  async #follow(): Promise<void> {
    this.#isBehind = true;
    if (this.#isFollowing) {
      return;
    }
    this.#isFollowing = true;
    while (this.#isBehind) {
      this.#isBehind = false;
      const turn = this.#turn;
      await this.#show().catch((error: unknown) => this.#fail(turn, error));
    }
    this.#isFollowing = false;
  }

  async #show(): Promise<void> {
    const [mesh, choice] = [this.#mesh, this.#choice()];
    if (!mesh || !choice) {
      return;
    }
    let traced = this.#traced;
    if (!traced || !isSame(traced.choice, choice)) {
      traced = await trace(mesh, choice, traced);
      if (mesh !== this.#mesh) {
        return;
      }
      this.#traced = traced;
      this.#tell(mesh, traced);
    }
    const { tracing, fields } = traced;
    this.stage.update({ mesh, tracing, fields });
    const { field, version } = this.stage.look;
    if (field !== "none" && field !== "deviation" && !fields[version]) {
      fields[version] = await engine.fields(version === "after" ? tracing : mesh, choice.ranking);
      if (traced === this.#traced) {
        this.stage.update({ mesh, tracing, fields });
      }
    }
  }

  #tell(mesh: Prepared, { tracing: { found, positions }, ms, rejected }: Traced): void {
    const [before, after] = [mesh.positions, positions].map(({ length }) => length / 3) as [number, number];
    const share = (hosts: number) => `${count(Math.round(hosts))} of ${count(found.length)} (${Math.round((100 * hosts) / found.length)} %)`;
    const numFound = found.filter(Boolean).length;
    this.#words.hidden = false;
    this.#words.replaceChildren(
      h("h3", {}, "Hosts found again"),
      numbers([
        ["Ranked anew", share(numFound)],
        ["By chance", share(found.length ** 2 / after)],
        ["Vertices", before === after ? count(before) : `${count(before)}, then ${count(after)}`],
        ["Ranking took", `${ms.toFixed(ms < 10 ? 1 : 0)} ms${rejected > 0 ? `; ${count(rejected)} rejected` : ""}`],
      ]),
    );
    announce(`${share(numFound)} hosts found again.`);
  }

  #say(text: string): void {
    this.#words.hidden = false;
    this.#words.replaceChildren(h("p", { class: "hint" }, text), h("progress", { "aria-label": "Progress" }));
  }

  #fail(turn: number, error: unknown): void {
    if (turn === this.#turn) {
      this.#words.hidden = true;
      if (!this.#mesh) {
        this.stage.rest("There is no picture.");
      }
      this.outcome.tell(errorCard(this.cannot, error));
    }
  }
}

/** What is known of the mesh before stays known while the ranking does. */
async function trace(mesh: Prepared, choice: Choice, last: Traced | undefined): Promise<Traced> {
  const { ranking } = choice;
  const tracing = await engine.trace(mesh, choice);
  if (last?.choice.ranking === ranking) {
    const { before } = last.fields;
    return { ...last, choice, tracing, fields: before ? { before } : {} };
  }
  const { order, ms } = await engine.rank(mesh, ranking);
  return { choice, tracing, fields: {}, ms, rejected: mesh.positions.length / 3 - order.length };
}

function isSame(a: Choice, b: Choice): boolean {
  return a.ranking === b.ranking && a.smoothing === b.smoothing && a.iterations === b.iterations && a.numHosts === b.numHosts;
}

function fill(select: HTMLSelectElement, choices: Record<string, { name: string }>, chosen: string): void {
  select.replaceChildren(...Object.entries(choices).map(([value, { name }]) => h("option", { value }, name)));
  select.value = chosen;
}
