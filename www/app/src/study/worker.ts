/** The worker behind the study: it loads the study's module with the first question. */
import load, * as study from "../../study-wasm/study.js";
import { answerBy } from "../answerer";
import type { Answer, Question } from "../asker";
import type { Questions } from "./engine";

answerBy((load as () => Promise<unknown>)(), answer);

function answer(question: Question<Questions>, onProgress: (fraction: number) => void): Answer<Questions> {
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
      return study.errors(...question.args, (_, fraction) => onProgress(fraction));
  }
}
