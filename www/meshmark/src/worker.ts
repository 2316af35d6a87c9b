/** The worker behind `createClient`: a real file, so that it runs under a strict Content-Security-Policy. */
import {
  capacity,
  compare,
  compareMesh,
  compareWithRecord,
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
  initFull,
  inspect,
  measure,
  measureMesh,
  MeshmarkError,
  prepare,
  record,
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

let fullUrl: string | undefined;

/** A function of the full module, which is loaded with the first call. */
function full<Arguments extends unknown[], Result>(f: (...args: Arguments) => Result) {
  return async (...args: Arguments): Promise<Result> => {
    await initFull(fullUrl);
    return f(...args);
  };
}

/** A function that reads models: where one is compressed, again with the full module, which has the codecs. */
function reading<Arguments extends unknown[], Result>(f: (...args: Arguments) => Result) {
  return async (...args: Arguments): Promise<Result> => {
    try {
      return f(...args);
    } catch (error) {
      if (!(error instanceof MeshmarkError && error.code === "document.compression-unsupported")) {
        throw error;
      }
    }
    await initFull(fullUrl);
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
    compare: full(compare),
    compareMesh: full(compareMesh),
    compareWithRecord: full(compareWithRecord),
    record: full(record),
    demoModel,
    version,
    prepare: full(prepare),
    stamp: full(stamp),
    trace: full(trace),
    traceMesh: full(traceMesh),
    traceEvidence: full(traceEvidence),
    stateReading: full(stateReading),
    copyNumber: full(copyNumber),
  },
  (setup) => {
    fullUrl = setup?.["fullUrl"];
    return init(setup?.["wasmUrl"]);
  },
);
