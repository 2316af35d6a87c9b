/** The worker behind `createClient`: a real file, so that it runs under a strict Content-Security-Policy. */
import {
  capacity,
  copyNumber,
  decompress,
  deriveKey,
  demoModel,
  detect,
  detectMesh,
  embed,
  extract,
  extractMany,
  init,
  initCodecs,
  initCopies,
  inspect,
  measure,
  measureMesh,
  MeshmarkError,
  prepare,
  stamp,
  stateReading,
  trace,
  traceEvidence,
  traceMesh,
  verify,
  version,
  workKey,
} from "./index.js";
import { answer } from "./remote.js";

let codecsUrl: string | undefined;
let informedUrl: string | undefined;

type Informed = typeof import("./informed.js");

/** A function of the module that reads with the original, which is loaded when it is asked for. */
function withOriginal(name: "compare" | "compareMesh" | "compareWithRecord" | "record") {
  return async (...args: unknown[]): Promise<unknown> => {
    const module: Informed = await import("./informed.js");
    await module.init(informedUrl);
    return (module[name] as (...args: unknown[]) => unknown)(...args);
  };
}

let copiesUrl: string | undefined;

/** A function of the module that sellers need, which is loaded with the first call. */
function selling<Arguments extends unknown[], Result>(f: (...args: Arguments) => Result) {
  return async (...args: Arguments): Promise<Result> => {
    await initCopies(copiesUrl);
    return f(...args);
  };
}

/** A function that reads models: where one is compressed, again with the module that has the codecs. */
function reading<Arguments extends unknown[], Result>(f: (...args: Arguments) => Result) {
  return async (...args: Arguments): Promise<Result> => {
    try {
      return f(...args);
    } catch (error) {
      if (!(error instanceof MeshmarkError && error.code === "document.compression-unsupported")) {
        throw error;
      }
    }
    await initCodecs(codecsUrl);
    return f(...args);
  };
}

answer(
  {
    deriveKey,
    workKey,
    embed: reading(embed),
    measure: reading(measure),
    measureMesh,
    extract,
    extractMany,
    verify,
    detect: reading(detect),
    detectMesh,
    decompress: reading(decompress),
    inspect: reading(inspect),
    capacity: reading(capacity),
    compare: withOriginal("compare"),
    compareMesh: withOriginal("compareMesh"),
    compareWithRecord: withOriginal("compareWithRecord"),
    record: withOriginal("record"),
    demoModel,
    version,
    prepare: selling(prepare),
    stamp: selling(stamp),
    trace: selling(trace),
    traceMesh: selling(traceMesh),
    traceEvidence: selling(traceEvidence),
    stateReading: selling(stateReading),
    copyNumber: selling(copyNumber),
  },
  (setup) => {
    codecsUrl = setup?.["codecsUrl"];
    informedUrl = setup?.["informedUrl"];
    copiesUrl = setup?.["copiesUrl"];
    return init(setup?.["wasmUrl"]);
  },
);
