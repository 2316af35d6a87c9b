/** One embedding, begun before anybody asks for it: shown as a preview, and taken over as the result if nothing has changed since. */
import type { Embedding, Stage } from "meshmark";
import type { Progress } from "./task";

export type Listener = Pick<Progress, "stage" | "onProgress">;

export class Trial {
  readonly embedding: Promise<Embedding>;
  readonly #controller = new AbortController();
  #isDone = false;
  #listener: Listener;
  /** What the listener last heard; `null` for how far a stage is that has no end in sight. */
  #last: [stage: Stage | "key", fraction: number | null] | undefined;

  /** @param isExact whether `work` uses the person's own key and tag, so that its result is the one to hand out */
  constructor(
    readonly isExact: boolean,
    work: (progress: Progress) => Promise<Embedding>,
    listener: Listener,
  ) {
    this.#listener = listener;
    this.embedding = work({
      signal: this.#controller.signal,
      stage: (name) => this.#hear(name, null),
      onProgress: (name, fraction) => this.#hear(name, fraction),
    });
    this.embedding.catch(() => {}).finally(() => (this.#isDone = true)); // whoever waits for it hears of what went wrong
  }

  /** Goes on before another listener, which hears at once where the work is, and can end it. */
  follow(progress: Progress): Promise<Embedding> {
    this.#listener = progress;
    if (this.#last) {
      this.#hear(...this.#last);
    }
    progress.signal.addEventListener("abort", () => this.abort());
    return this.embedding;
  }

  abort(): void {
    this.#controller.abort();
  }

  get isDone(): boolean {
    return this.#isDone;
  }

  #hear(stage: Stage | "key", fraction: number | null): void {
    this.#last = [stage, fraction];
    if (stage === "key" || fraction === null) {
      this.#listener.stage(stage);
    } else {
      this.#listener.onProgress(stage, fraction);
    }
  }
}
