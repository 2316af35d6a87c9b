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
  traceMesh,
  verify,
  version,
} from "./index.js";
import { answer } from "./remote.js";

let codecsUrl: string | undefined;
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
    demoModel,
    version,
    prepare: selling(prepare),
    stamp: selling(stamp),
    trace: selling(trace),
    traceMesh: selling(traceMesh),
    stateReading: selling(stateReading),
    copyNumber: selling(copyNumber),
  },
  (setup) => {
    codecsUrl = setup?.["codecsUrl"];
    copiesUrl = setup?.["copiesUrl"];
    return init(setup?.["wasmUrl"]);
  },
);
