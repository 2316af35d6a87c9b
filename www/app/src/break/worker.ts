/** The worker behind the attacks: it loads their module with the first question. */
import load, * as attacks from "../../attacks-wasm/attacks.js";
import { answerBy } from "../answerer";
import type { Answer, Question } from "../asker";
import type { Questions } from "./engine";

answerBy((load as () => Promise<unknown>)(), answer);

function answer(question: Question<Questions>): Answer<Questions> {
  switch (question.method) {
    case "catalogue":
      return attacks.catalogue();
    case "attack":
      return attacks.attack(...question.args);
    case "quality":
      return attacks.quality(...question.args);
  }
}
