/** One piece of work at a time in a view: its progress in words, and a way to stop it. */
import type { OnProgress, Stage } from "meshmark";
import { MeshmarkError } from "meshmark/client";
import { announce, button, h } from "./dom";
import { note, present } from "./outcome";
import { STAGES } from "./words";

export interface Progress {
  signal: AbortSignal;
  stage(stage: Stage | "key"): void;
  onProgress: OnProgress;
}

/** Work whose steps have words of their own. */
export interface Task extends Progress {
  /** @param fraction of the whole, from 0 to 1 */
  say(words: string, fraction: number): void;
}

/**
 * Runs `work` with a progress card in `outcome`, in place of what stood there; its button aborts `controller`.
 *
 * Returns `undefined` where the work was aborted; other errors go to the caller.
 */
export async function runTask<T>(
  outcome: HTMLElement,
  controller: AbortController,
  work: (task: Task) => Promise<T>,
): Promise<T | undefined> {
  const words = h("p");
  const bar = h("progress", { "aria-label": "Progress of this step" });
  const cancel = button("Cancel", () => controller.abort());
  const card = h("section", { class: "card working", "aria-label": "Progress" }, words, bar, cancel);
  outcome.replaceChildren(card);
  const stage = (name: Stage | "key") => {
    if (words.dataset["stage"] !== name) {
      words.dataset["stage"] = name;
      words.textContent = `${STAGES[name]} …`;
      announce(STAGES[name]);
      bar.removeAttribute("value");
    }
  };
  const onProgress: OnProgress = (name, fraction) => {
    stage(name);
    if (name === "test") {
      words.textContent = `${STAGES.test} … ${Math.round(fraction * 100)} % tried`; // one after another: what may have been done to the model
    }
    bar.value = fraction;
  };
  const say = (text: string, fraction: number) => {
    words.textContent = text;
    bar.value = fraction;
  };
  try {
    return await work({ signal: controller.signal, stage, onProgress, say });
  } catch (error) {
    if (error instanceof MeshmarkError && error.code === "aborted") {
      if (card.isConnected) {
        present(outcome, note("Cancelled. Nothing was changed."));
      }
      return undefined;
    }
    throw error;
  } finally {
    card.remove();
  }
}
