/** Reading a model, with details: whoever sits before the page holds the key. */
import type { DetailedExtraction, MeasureOptions } from "meshmark";
import type { CallOptions, Client } from "meshmark/client";
import type { KeyMaker } from "./key-form";
import { isEvidence, type Model } from "./model";
import type { Progress } from "./task";

type Heard = CallOptions & Pick<MeasureOptions, "onProgress">;

/** What was read, and whether it is another tag than the expected one. */
export interface Answer {
  reading: DetailedExtraction;
  isOther: boolean;
}

export async function detect(client: Client, model: Model, key: Uint8Array, expected: string | null, { signal, onProgress }: Heard): Promise<DetailedExtraction> {
  const { bytes, buffers } = model;
  if (isEvidence(model)) {
    const reading = await (expected === null ? client.extract(bytes, key, { details: true, signal }) : client.verify(bytes, key, expected, { details: true, signal }));
    return reading as DetailedExtraction;
  }
  const options = { files: buffers, expected: expected ?? undefined, details: true, signal, onProgress };
  return (await client.detect(bytes, key, options)) as DetailedExtraction;
}

/** Reads a model for an expected tag, if there is one; where the key's mark is there with another, as if none had been expected. */
export async function read(client: Client, model: Model, makeKey: KeyMaker, expected: string | null, progress: Progress): Promise<Answer> {
  return withKey(client, makeKey, progress, async (key) => {
    const reading = await detect(client, model, key, expected, progress);
    const blind = expected !== null && reading.verdict === "partial" ? await detect(client, model, key, null, progress) : reading;
    return blind.verdict === "found" ? { reading: blind, isOther: blind !== reading } : { reading, isOther: false };
  });
}

/** What is measured of a model, without a key; evidence is that already. */
export async function evidenceOf(client: Client, model: Model, { signal, onProgress }: Heard): Promise<Uint8Array> {
  return isEvidence(model) ? model.bytes : client.measure(model.bytes, { files: model.buffers, signal, onProgress });
}

/** Uses a key that is made for this and overwritten after it. */
export async function withKey<T>(client: Client, makeKey: KeyMaker, progress: Progress, use: (key: Uint8Array) => Promise<T>): Promise<T> {
  const key = await makeKey(client, progress);
  progress.stage("read");
  try {
    return await use(key);
  } finally {
    key.fill(0);
  }
}
