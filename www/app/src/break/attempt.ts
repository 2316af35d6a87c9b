/** One thing done to a marked model, from before it is begun to what came of it. */
import type { DetailedExtraction } from "meshmark";
import { MeshmarkError } from "meshmark/client";
import type { Quality } from "../../research-wasm/research.js";
import type { Model } from "../model";

/** What is left of a mark: its own tag found, something of the key there, nothing. */
export type Level = "green" | "amber" | "red";

export interface Finding {
  reading: DetailedExtraction;
  level: Level;
  quality: Quality;
}

/** A copy, brought back when it is asked for: many are too much to hold in memory. */
export type Copy = () => Promise<Model>;

/** What work says of itself while it goes on. */
export interface Telling {
  signal: AbortSignal;
  /** @param fraction from 0 to 1; `null` where no end is in sight */
  say(words: string, fraction: number | null): void;
  /** The copy is there; what is left of the mark is not known yet. */
  made(copy: Copy): void;
}

export type Work = (telling: Telling) => Promise<Finding>;

export type State = "idle" | "cancelled" | "waiting" | "running" | "done" | "failed";

export class Attempt {
  copy: Copy | undefined;
  finding: Finding | undefined;
  error: unknown;
  words = "";
  fraction: number | null = null;
  #state: State = "idle";
  #controller: AbortController | undefined;
  readonly #listeners: (() => void)[] = [];

  /**
   * @param title what is done, in words
   * @param hint what it depends on beside that, such as a seed
   * @param isRepeatable whether title and hint say all, so that the same comes of it each time
   */
  constructor(
    readonly title: string,
    readonly hint: string,
    readonly isRepeatable: boolean,
    readonly work: Work,
  ) {}

  /** Whether the same comes of it. */
  isLike({ title, hint, isRepeatable }: Pick<Attempt, "title" | "hint" | "isRepeatable">): boolean {
    return this.isRepeatable && isRepeatable && this.title === title && this.hint === hint;
  }

  get state(): State {
    return this.#state;
  }

  /** Whether it has not come to an end, and is not on the way to one. */
  get isOpen(): boolean {
    return this.#state === "idle" || this.#state === "cancelled";
  }

  /** Tells of every change, from now on. */
  onChange(listener: () => void): void {
    this.#listeners.push(listener);
  }

  wait(): void {
    this.#become("waiting");
  }

  async run(): Promise<void> {
    const { signal } = (this.#controller = new AbortController());
    this.say("", null);
    this.#become("running");
    try {
      const made = (copy: Copy) => {
        this.copy = copy;
        this.#tell();
      };
      this.finding = await this.work({ signal, say: (words, fraction) => this.say(words, fraction), made });
      this.#become("done");
    } catch (error) {
      this.error = error;
      this.#become(error instanceof MeshmarkError && error.code === "aborted" ? "cancelled" : "failed");
    }
  }

  /** Ends what goes on at once. */
  cancel(): void {
    if (this.#state === "running") {
      this.#controller?.abort();
    } else if (this.#state === "waiting") {
      this.#become("cancelled");
    }
  }

  say(words: string, fraction: number | null): void {
    [this.words, this.fraction] = [words, fraction];
    this.#tell();
  }

  #become(state: State): void {
    this.#state = state;
    this.#tell();
  }

  #tell(): void {
    this.#listeners.forEach((listener) => listener());
  }
}
