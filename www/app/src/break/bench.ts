/** A marked model and its key, and whatever can be done to the one and read with the other. */
import type { Extraction } from "meshmark";
import { createClient, type Client } from "meshmark/client";
import type { Attack } from "../../research-wasm/research.js";
import { renamed, type Model } from "../model";
import { detect } from "../reading";
import type { Progress } from "../task";
import { STAGES } from "../words";
import type { Finding, Level, Telling, Work } from "./attempt";
import { attack, catalogue, quality } from "./engine";

/** What no catalogue has, for it takes a key: the copy is marked again, by nobody's key. */
export const SECOND_MARK = "second mark by another key";

const KEY_BYTES = 32;

export class Bench {
  readonly #key: Uint8Array;
  readonly #client: Client;

  /** What is left of the mark before anything is done. */
  private constructor(
    readonly marked: Model,
    key: Uint8Array,
    client: Client,
    readonly first: Finding,
    readonly catalogue: Attack[],
  ) {
    this.#key = key;
    this.#client = client;
  }

  /** Reads a model, and keeps the key for all that is read later: it is overwritten by `close`. */
  static async open(marked: Model, key: Uint8Array, progress: Progress): Promise<Bench> {
    const client = await createClient(); // of its own: the other views need not wait
    try {
      const reading = await detect(client, marked, key, null, progress);
      const { vertices, triangles } = await client.inspect(marked.bytes, { files: marked.buffers, signal: progress.signal });
      const nothing = { rmsRel: 0, hausdorffRel: 0, msdm: 0, vertices, triangles };
      const first = { reading, quality: nothing, level: levelOf(reading, reading.number) };
      return new Bench(marked, key, client, first, await catalogue({ signal: progress.signal }));
    } catch (error) {
      key.fill(0);
      client.dispose();
      throw error;
    }
  }

  close(): void {
    this.#key.fill(0);
    this.#client.dispose();
  }

  /** Steps of the catalogue and second marks, one upon the other. */
  attack(steps: string[], seed: number): Work {
    return async (telling) => {
      let copy = this.marked;
      for (const group of groups(steps)) {
        copy = group[0] === SECOND_MARK ? await this.#markAgain(copy, telling) : await this.#attack(copy, group, seed, telling);
      }
      const { name } = this.marked;
      const blob = new Blob([copy.bytes]);
      const made = async () => glb(renamed(name, `${slug(steps)}.glb`), new Uint8Array(await blob.arrayBuffer()));
      telling.made(made);
      return this.#judge(copy, telling);
    };
  }

  /** Whatever a person has made of the marked model elsewhere. */
  judge(copy: Model): Work {
    return async (telling) => {
      telling.made(async () => copy);
      return this.#judge(copy, telling);
    };
  }

  async #attack(model: Model, steps: string[], seed: number, { say, signal }: Telling): Promise<Model> {
    say("Making the copy …", null);
    const bytes = await attack(model.bytes, steps, { files: model.buffers, seed, signal });
    return glb(model.name, bytes as Model["bytes"]);
  }

  async #markAgain(model: Model, { say, signal }: Telling): Promise<Model> {
    const tag = "OTHER";
    const key = crypto.getRandomValues(new Uint8Array(KEY_BYTES));
    say("Marking the copy by another key …", null);
    const { model: bytes, files } = await this.#client.embed(model.bytes, tag, key, { files: model.buffers, signal });
    return { ...model, bytes: bytes as Model["bytes"], buffers: { ...model.buffers, ...files } };
  }

  async #judge(copy: Model, { say, signal }: Telling): Promise<Finding> {
    say("Measuring what was paid …", null);
    const { bytes, buffers: referenceFiles } = this.marked;
    const cost = await quality(bytes, copy.bytes, { referenceFiles, files: copy.buffers, signal });
    say(`${STAGES.test} …`, null);
    const reading = await detect(this.#client, copy, this.#key, null, { signal, onProgress: (stage, fraction) => say(`${STAGES[stage]} …`, fraction) });
    return { reading, quality: cost, level: levelOf(reading, this.first.reading.number) };
  }
}

function levelOf({ verdict, number }: Extraction, own: number | null): Level {
  if ((verdict === "found" && (own === null || number === own)) || (verdict === "present" && own === null)) {
    return "green";
  }
  return verdict === "partial" || verdict === "present" ? "amber" : "red";
}

/** Steps that one module takes together; a second mark by itself. */
function groups(steps: string[]): string[][] {
  const groups: string[][] = [];
  for (const step of steps) {
    const last = groups.at(-1);
    if (last && step !== SECOND_MARK && last[0] !== SECOND_MARK) {
      last.push(step);
    } else {
      groups.push([step]);
    }
  }
  return groups;
}

function glb(name: string, bytes: Model["bytes"]): Model {
  return { name: renamed(name, "glb"), bytes, buffers: {}, images: {} };
}

/** Steps as a part of a file's name. */
function slug(steps: string[]): string {
  return steps.join("-").toLowerCase().replaceAll(" %", "").replaceAll(/[^a-z0-9.]+/g, "-");
}
