/** Work begun before anybody asks for it: shown as a preview, and taken over as the result if nothing has changed since. */
import type { Stage } from "meshmark";
import type { Asked } from "./copy";
import type { KeySource } from "./key-form";
import type { Progress } from "./task";

export type Listener = Pick<Progress, "stage" | "onProgress">;

export class Trial<T> {
  readonly result: Promise<T>;
  readonly #controller = new AbortController();
  #isDone = false;
  #listener: Listener;
  /** What the listener last heard; `null` for how far a stage is that has no end in sight. */
  #last: [stage: Stage | "key", fraction: number | null] | undefined;

  /** @param isExact whether key and tag are the person's own, so that the result is the one to hand out */
  constructor(
    readonly isExact: boolean,
    readonly key: KeySource,
    readonly asked: Asked,
    work: (progress: Progress) => Promise<T>,
    listener: Listener,
  ) {
    this.#listener = listener;
    this.result = work({
      signal: this.#controller.signal,
      stage: (name) => this.#hear(name, null),
      onProgress: (name, fraction) => this.#hear(name, fraction),
    });
    this.result.catch(() => {}).finally(() => (this.#isDone = true)); // whoever waits for it hears of what went wrong
  }

  /** Goes on before another listener, which hears at once where the work is, and can end it. */
  follow(progress: Progress): Promise<T> {
    this.#listener = progress;
    if (this.#last) {
      this.#hear(...this.#last);
    }
    progress.signal.addEventListener("abort", () => this.abort());
    return this.result;
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
