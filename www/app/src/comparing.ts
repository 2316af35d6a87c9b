/** Comparing a suspect with its original, or with a record: the call, and both answers in words. */
import { MeshmarkError } from "meshmark/client";
import type { Comparison, Overlay, StatedFile } from "meshmark";
import { sha256 } from "./digest";
import { h } from "./dom";
import { engine } from "./engine";
import type { Given } from "./given";
import type { KeySource } from "./key-form";
import { type Model } from "./model";
import { chance, type Row } from "./outcome";
import { withKey } from "./reading";
import type { Task } from "./task";
import { isMark, VERDICTS } from "./words";

/** A comparison with all that the page asks for. */
export type Compared = Comparison & { lnP: number; statement: string; overlay: Overlay | null };

/** The files that a statement is about: the suspect, and what it is compared with. */
export async function statedFiles(model: Model, given: Given | null): Promise<StatedFile[]> {
  const bytesOf = ({ bytes, original }: Model) => original ?? bytes;
  const stated = async (role: string, name: string, bytes: Uint8Array<ArrayBuffer>) => ({ role, name, bytes: bytes.length, sha256: await sha256(bytes) });
  const suspect = await stated("Suspect", model.name, bytesOf(model));
  switch (given?.kind) {
    case "original":
      return [suspect, await stated("Original", given.name, bytesOf(given.model))];
    case "record":
      return [suspect, await stated("Record", given.name, given.bytes)];
    default:
      return [suspect];
  }
}

/** What follows a command that repeats something on the command line: what the suspect is compared with, and whose key it was. */
export function argumentsOf(key: KeySource, given: Given | null): string {
  const owner = key.owner === null ? "--key-file KEY" : `--owner ${JSON.stringify(key.owner)} --passphrase-file PASSPHRASE`;
  const work = key.work === null ? "" : ` --work ${JSON.stringify(key.work)}`;
  return `${given ? `--${given.kind} ${given.name} ` : ""}${owner}${work}`;
}

/** Compares, for an expected tag if there is one, and states what was found; where the key's mark is there with another, as if none had been expected. */
export async function compared(model: Model, given: Given, key: KeySource, expected: string | null, task: Task): Promise<Compared> {
  const client = await engine;
  const { signal, onProgress } = task;
  const stated = {
    ...(key.owner === null ? {} : { owner: key.owner }),
    date: new Date().toISOString(),
    files: await statedFiles(model, given),
  };
  const call = async (bytes: Uint8Array, tag: string | null) => {
    const command = tag === null ? `extract ${model.name}` : `verify ${model.name} --tag ${tag}`;
    const statement = { ...stated, commands: [`meshmark ${command} ${argumentsOf(key, given)}`] };
    const options = { files: model.buffers, expected: tag ?? undefined, details: true, overlay: true, statement, signal, onProgress };
    const comparison =
      given.kind === "original"
        ? await client.compare(model.bytes, given.model.bytes, bytes, { ...options, originalFiles: given.model.buffers })
        : await client.compareWithRecord(model.bytes, given.text, bytes, options).catch(naming(given.name));
    return comparison as Compared;
  };
  return withKey(client, key.make, task, async (bytes) => {
    const comparison = await call(bytes, expected);
    return comparison.verdict === "partial" && comparison.number !== null ? call(bytes, null) : comparison;
  });
}

/** What is wrong with a record is said by the name of its file. */
export function naming(name: string): (error: unknown) => never {
  return (error) => {
    throw error instanceof MeshmarkError && error.code.startsWith("record.") ? new MeshmarkError(error.code, `“${name}”: ${error.message}`) : error;
  };
}

/** The answers one upon the other: is the mark there, and is the shape the original's. */
export function answers(comparison: Compared, given: Given): HTMLElement {
  return h(
    "dl",
    { class: "answers" },
    h("div", { "data-answer": isMark(comparison) ? "yes" : "no" }, h("dt", {}, "Is your mark in it?"), h("dd", {}, ...markWords(comparison))),
    shapeAnswer(comparison, given),
  );
}

/** Whether the shape is the original's. */
export function shapeAnswer(comparison: Comparison, given: Given): HTMLElement {
  return h("div", { "data-answer": comparison.shape === "same" ? "yes" : "no" }, h("dt", {}, "Is the shape the original’s?"), h("dd", {}, shapeWords(comparison, given)));
}

function markWords(comparison: Compared): (Node | string)[] {
  const bound = () => h("span", {}, "A model that was made without your key gets this answer with a chance of ", chance(comparison.lnP), ".");
  switch (comparison.verdict) {
    case "found":
      return [h("strong", {}, "Yes"), comparison.tag === null ? `, with the number ${comparison.number}. ` : `, with the tag ${comparison.tag}. `, bound()];
    case "present":
      return [h("strong", {}, "Yes"), ", without a tag that can be read. ", bound()];
    case "partial":
      return [h("strong", {}, "Not for certain"), ". Something fits your key, but not so well that chance is excluded."];
    default:
      return [h("strong", {}, "No"), ": what was read agrees with this key no better than by chance."];
  }
}

function shapeWords({ shape, near, covered, isMirrored, isBent, numParts, motion }: Comparison, { kind }: Given): Node {
  const percent = (share: number) => `${Math.round(share * 100)} %`;
  const original = kind === "record" ? "the shape in the record" : "the original";
  const how = [isMirrored && "as a mirror image", isBent && "bent into another pose", numParts > 1 && `in ${numParts} parts`].filter(Boolean);
  const words =
    shape === "same"
      ? `: ${percent(near)} of the suspect lies on ${original}${how.map((way) => `, ${way}`).join("")}${how.length > 0 ? "," : ""} and shows ${percent(covered)} of it. This says nothing of who made it.`
      : motion === null
        ? ": no way was found to lay the suspect on it."
        : `: in the likeliest place, only ${percent(near)} of the suspect lies on ${original}.`;
  return h("span", {}, h("strong", {}, shape === "same" ? "Yes" : "No, it is another shape"), words);
}

/** The headline of an answer. */
export function headlineOf({ verdict, shape }: Comparison): string {
  return verdict !== "none" ? VERDICTS[verdict] : shape === "same" ? "The original’s shape, without your mark" : "Another shape, without your mark";
}

/** What a comparison found, in numbers. */
export function comparisonRows({ witness, lnP }: Compared): Row[] {
  const witnesses = { surface: "the surface", vertices: "vertices that were kept", blind: "the suspect alone" };
  return [
    ["Chance of this without the key", chance(lnP)],
    ...(witness === null ? [] : [["Told by", witnesses[witness]] satisfies Row]),
  ];
}
