/** What the client and the worker say to each other: one request, then any number of progress replies, then the end. */
import type {
  EmbedOptions,
  Embedding,
  Extraction,
  Files,
  Inspection,
  MeshmarkErrorObject,
  Payload,
  ReadOptions,
  Stage,
  Verification,
} from "./index.js";

/** Every call a worker answers: its arguments and its result. */
export interface Calls {
  deriveKey: { args: [owner: string, passphrase: string]; result: Uint8Array };
  embed: {
    args: [model: Uint8Array, files: Files | undefined, payload: Payload, key: Uint8Array, options: EmbedOptions | undefined];
    result: Embedding;
  };
  measure: { args: [model: Uint8Array, files: Files | undefined]; result: Uint8Array };
  extract: { args: [evidence: Uint8Array, key: Uint8Array, options: ReadOptions | undefined]; result: Extraction };
  verify: {
    args: [evidence: Uint8Array, key: Uint8Array, expected: Payload, options: ReadOptions | undefined];
    result: Verification;
  };
  detect: {
    args: [
      model: Uint8Array,
      files: Files | undefined,
      key: Uint8Array,
      expected: Payload | undefined,
      options: ReadOptions | undefined,
    ];
    result: Extraction;
  };
  inspect: { args: [model: Uint8Array, files: Files | undefined]; result: Inspection };
  demoModel: { args: []; result: Uint8Array };
  version: { args: []; result: string };
}

export type Method = keyof Calls;

/** `wasmUrl` comes with every request: the worker's first one loads the module. */
export type Request = { [M in Method]: { method: M; args: Calls[M]["args"]; wasmUrl: string | undefined } }[Method];

export type Reply =
  | { kind: "progress"; stage: Stage; fraction: number }
  | { kind: "result"; result: Calls[Method]["result"] }
  | { kind: "error"; error: MeshmarkErrorObject };
