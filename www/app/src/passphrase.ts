/** How long a passphrase would stand against a program that guesses. Loaded with the first one that is typed: it brings its dictionaries. */
import { ZxcvbnFactory } from "@zxcvbn-ts/core";
import * as common from "@zxcvbn-ts/language-common";
import { translations } from "@zxcvbn-ts/language-en";

const estimator = new ZxcvbnFactory({
  dictionary: common.dictionary,
  graphs: common.adjacencyGraphs,
  translations,
});

/** From the estimator's scores, 0 to 4. */
const WORDS = ["Very weak", "Weak", "Fair", "Good", "Strong"] as const;
const LAST_WEAK = 2;

/** Longer ones are strong, and take seconds to estimate. */
const MOST_ESTIMATED = 100;

/** @param owner is known to whoever guesses */
export function strengthWords(passphrase: string, owner: string): { words: string; isWeak: boolean } {
  const { score, crackTimes, feedback } = estimator.check(passphrase.slice(0, MOST_ESTIMATED), [owner]);
  const isWeak = score <= LAST_WEAK;
  const advice = isWeak ? " Four or more words that do not belong together are better. It will be used as it is." : "";
  const why = passphrase.trim() === "" ? " It is spaces alone." : feedback.warning ? ` ${feedback.warning.replace(/\.?$/, ".")}` : "";
  // Each guess takes Argon2id and a reading of a marked copy: ten thousand a second is many machines.
  return { words: `${WORDS[score]}: at 10,000 guesses a second it is found in ${crackTimes.offlineSlowHashingXPerSecond.display}.${why}${advice}`, isWeak };
}
