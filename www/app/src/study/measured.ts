/** Table I and Fig. 5 of one model, filled in while they are measured. */
import type { Prepared, Hosts, HostsRow, Parameters, Smoothing } from "../../research-wasm/research.js";
import { announce, h } from "../dom";
import type { Task } from "../task";
import { percent } from "../words";
import { errors, hosts } from "./engine";
import { Figure } from "./figure";
import { hostsTable } from "./table";
import { HOSTS, SMOOTHINGS, times } from "./words";

const ITERATIONS = [0, 1, 2];
const DRAWS = 20;
const KEYS = 3;

export class Measured {
  readonly #figure: Figure;
  readonly #table = h("div");

  /** Stands in `root` from now on, in place of what was there. */
  constructor(
    root: HTMLElement,
    readonly mesh: Prepared,
    readonly smoothing: Smoothing,
    readonly numHosts: number,
    readonly parameters: Parameters,
  ) {
    const { strength, strengths } = parameters;
    this.#figure = new Figure({ iterations: ITERATIONS, strengths, strength, smoothedOnce: 1 });
    const by = SMOOTHINGS[smoothing].name;
    const card = (headline: string, hint: string, content: HTMLElement) => h("section", { class: "card", "aria-label": headline }, h("h2", {}, headline), h("p", { class: "hint" }, hint), content);
    const figureCard = card("Fig. 5: wrong bits", `${by}. Points are means over ${KEYS} keys, bars go from the least to the most.`, this.#figure.root);
    root.replaceChildren(card("Table I: hosts found again", `${by}. Random hosts: mean and standard deviation of ${DRAWS} draws. ×: of that mean.`, this.#table), figureCard);
    this.#show([]);
  }

  /** Measures all of it, one part after another; ends early where the task is cancelled. */
  async run(task: Task): Promise<void> {
    const points = this.#points();
    const every = Object.keys(HOSTS) as Hosts[];
    const total = ITERATIONS.length + points.length * every.length;
    const { mesh, smoothing, numHosts } = this;
    let done = 0;
    const rows: HostsRow[] = [];
    announce("Measuring Table I");
    for (const iterations of ITERATIONS) {
      task.say(`Table I: ${times(iterations)} …`, done++ / total);
      rows.push(await hosts(mesh, { smoothing, iterations, draws: DRAWS, numHosts, signal: task.signal }));
      this.#show(rows);
    }
    announce("Measuring Fig. 5");
    for (const { iterations, strength } of points) {
      for (const held of every) {
        const before = done++;
        const words = `Fig. 5: ${HOSTS[held].toLowerCase()}, ${times(iterations)} at ${percent(strength)} …`;
        task.say(words, before / total);
        const onProgress = (_: string, fraction: number) => task.say(words, (before + fraction) / total);
        this.#figure.add(await errors(mesh, { hosts: held, smoothing, iterations, strength, keys: KEYS, signal: task.signal, onProgress }));
      }
    }
  }

  #show(rows: HostsRow[]): void {
    this.#table.replaceChildren(hostsTable(rows));
  }

  /** Both halves, what they have in common once. */
  #points(): { iterations: number; strength: number }[] {
    const { strength, strengths } = this.parameters;
    const bySmoothing = ITERATIONS.map((iterations) => ({ iterations, strength }));
    const byStrength = strengths.filter((other) => other !== strength).map((other) => ({ iterations: 1, strength: other }));
    return [...bySmoothing, ...byStrength];
  }
}
