/** The worker behind the study: it loads the study's module with the first question. */
import load, * as study from "../../study-wasm/study.js";
import type { Answer, Question, Reply } from "./engine";

const loaded = (load as () => Promise<unknown>)();

self.addEventListener("message", async ({ data }: MessageEvent<Question>) => {
  try {
    await loaded;
    const since = performance.now();
    const result = answer(data);
    reply({ kind: "answer", result, ms: performance.now() - since });
  } catch (error) {
    reply({ kind: "error", error: isPlain(error) ? error : { code: "internal", message: String(error), path: null } });
  }
});

function answer(question: Question): Answer {
  switch (question.method) {
    case "parameters":
      return study.parameters();
    case "prepare":
      return study.prepare(...question.args);
    case "rank":
      return study.rank(...question.args);
    case "fields":
      return study.fields(...question.args);
    case "trace":
      return study.trace(...question.args);
    case "hosts":
      return study.hosts(...question.args);
    case "errors":
      return study.errors(...question.args, (_, fraction) => reply({ kind: "progress", fraction }));
  }
}

function reply(message: Reply): void {
  self.postMessage(message);
}

/** What the module throws is plain; anything else has stopped it. */
function isPlain(error: unknown): error is study.MeshmarkErrorObject {
  return !(error instanceof Error);
}
