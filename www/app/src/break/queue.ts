/** Attempts, one after another: what a person waits for before what goes on by itself. */
import type { Attempt } from "./attempt";

export class Queue {
  readonly #first: Attempt[] = [];
  readonly #then: Attempt[] = [];
  #running: Attempt | undefined;

  get isBusy(): boolean {
    return this.#running !== undefined;
  }

  /** A person waits for it. */
  ask(attempt: Attempt): void {
    this.#add(this.#first, attempt);
  }

  /** It may come when nobody waits. */
  fill(attempts: Attempt[]): void {
    attempts.forEach((attempt) => this.#add(this.#then, attempt));
  }

  /** Ends all that runs and waits. */
  clear(): void {
    const all = [...this.#first.splice(0), ...this.#then.splice(0)];
    all.forEach((attempt) => attempt.cancel());
    this.#running?.cancel();
  }

  #add(line: Attempt[], attempt: Attempt): void {
    if (attempt.state !== "running" && !this.#first.includes(attempt)) {
      line.push(attempt);
      attempt.wait();
    }
    void this.#next();
  }

  async #next(): Promise<void> {
    if (this.#running) {
      return;
    }
    for (;;) {
      const next = this.#first.shift() ?? this.#then.shift();
      if (!next) {
        return;
      }
      if (next.state === "waiting") {
        this.#running = next;
        await next.run(); // an error is the attempt's own
        this.#running = undefined;
      }
    }
  }
}
