/** Reading a model, with details: whoever sits before the page holds the key. */
import type { DetailedExtraction } from "meshmark";
import type { CallOptions, Client } from "meshmark/client";
import type { Model } from "./model";

export async function detect(client: Client, { bytes, buffers }: Model, key: Uint8Array, expected: string | null, call: CallOptions): Promise<DetailedExtraction> {
  return (await client.detect(bytes, buffers, key, expected ?? undefined, { details: true }, call)) as DetailedExtraction;
}
