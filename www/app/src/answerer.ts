/** The worker's side of an `Asker`. */
import type { MeshmarkErrorObject } from "meshmark";
import type { Reply } from "./asker";

/**
 * Answers whatever this worker is asked, once the module is `loaded`.
 *
 * @param answer calls the module; it may say how far it is, from 0 to 1
 */
export function answerBy<Q, A>(loaded: Promise<unknown>, answer: (question: Q, onProgress: (fraction: number) => void) => A): void {
  const reply = (message: Reply<A>) => self.postMessage(message);
  self.addEventListener("message", async ({ data }: MessageEvent<Q>) => {
    try {
      await loaded;
      const since = performance.now();
      const result = answer(data, (fraction) => reply({ kind: "progress", fraction }));
      reply({ kind: "answer", result, ms: performance.now() - since });
    } catch (error) {
      reply({ kind: "error", error: isPlain(error) ? error : { code: "internal", message: String(error), path: null } });
    }
  });
}

/** What a module throws is plain; anything else has stopped it. */
function isPlain(error: unknown): error is MeshmarkErrorObject {
  return !(error instanceof Error);
}
