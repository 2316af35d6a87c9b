/** Reading a model, with details: whoever sits before the page holds the key. */
import type { DetailedExtraction, MeasureOptions } from "meshmark";
import type { CallOptions, Client } from "meshmark/client";
import type { Model } from "./model";

type Heard = CallOptions & Pick<MeasureOptions, "onProgress">;

export async function detect(client: Client, { bytes, buffers }: Model, key: Uint8Array, expected: string | null, { signal, onProgress }: Heard): Promise<DetailedExtraction> {
  const options = { files: buffers, expected: expected ?? undefined, details: true, signal, onProgress };
  return (await client.detect(bytes, key, options)) as DetailedExtraction;
}
