/** Tags as the payload holds them: 8 characters of 6 bits. */
import { setProblem } from "./dom";

/** What is wrong with a tag, in words; `null` where nothing is. */
export function tagProblem(tag: string): string | null {
  const foreign = tag.match(/[^A-Za-z0-9.-]/u)?.[0];
  if (foreign !== undefined) {
    return foreign === " " ? "A tag has no spaces." : `A tag cannot hold “${foreign}”: only A–Z a–z 0–9 - and .`;
  }
  if (tag.length > 8) {
    return `A tag has at most 8 characters; this has ${tag.length}.`;
  }
  return tag.endsWith(".") ? "A tag cannot end with a full stop." : null;
}

/** Checks a tag's field as it is typed. */
export function watchTag(field: HTMLInputElement): void {
  field.addEventListener("input", () => setProblem(field, tagProblem(field.value)));
}
