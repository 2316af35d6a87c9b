// Compiled, never run: the package's functions have exactly the types that the module's contract declares.
import type * as contract from "../../src/wasm/types.js";
import * as meshmark from "meshmark";
import { createClient, MeshmarkError, type Client } from "meshmark/client";

type Contract = typeof contract;
type Package = Pick<typeof meshmark, keyof Contract>;
type Same<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : false;

export const sameFunctions: { [F in keyof Contract]: Same<Contract[F], Package[F]> } = {
  deriveKey: true,
  workKey: true,
  embed: true,
  measure: true,
  measureMesh: true,
  extract: true,
  extractMany: true,
  verify: true,
  detect: true,
  detectMesh: true,
  decompress: true,
  inspect: true,
  capacity: true,
  demoModel: true,
  version: true,
};

/** Every function has its promise in the client: with the same result, for the same arguments, and with a signal among the options. */
export const sameResults: {
  [F in keyof Contract]: Same<Promise<ReturnType<Contract[F]>>, ReturnType<Client[F]>>;
} = { ...sameFunctions };
export const sameArguments: {
  [F in keyof Contract]: Parameters<Contract[F]> extends Parameters<Client[F]> ? true : false;
} = { ...sameFunctions };
type LastOf<Arguments extends unknown[]> = Required<Arguments> extends [...unknown[], infer Last] ? Last : undefined;
type OptionNames<Last> = Last extends object ? keyof Last : never;
export const sameOptionsAndSignal: {
  [F in keyof Contract]: Same<OptionNames<LastOf<Parameters<Client[F]>>>, OptionNames<LastOf<Parameters<Contract[F]>>> | "signal">;
} = { ...sameFunctions };

export async function useAll(model: Uint8Array, signal: AbortSignal): Promise<string | null> {
  await meshmark.init();
  const key = meshmark.deriveKey("Jane", "correct horse");
  const { model: marked, report } = meshmark.embed(model, "JANE-1", key, { strength: "strong" });
  const reading = meshmark.extract(meshmark.measure(marked), key);
  const client = await createClient({ workerUrl: "/worker.js", wasmUrl: new URL("https://a.example/meshmark.wasm") });
  try {
    await client.embed(model, 7, key, { files: {}, carriers: ["solid", "ring"], signal, onProgress: (stage, fraction) => void [stage, fraction] });
  } catch (error) {
    return error instanceof MeshmarkError ? error.code : null;
  } finally {
    client.dispose();
  }
  // @ts-expect-error a report holds no key
  report.key;
  // @ts-expect-error what runs to its end cannot be given a signal
  meshmark.measure(model, { signal });
  // @ts-expect-error a key is bytes
  meshmark.extract(marked, "key");
  return reading.tag;
}
