/** The worker behind `createClient`: a real file, so that it runs under a strict Content-Security-Policy. */
import {
  capacity,
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
  inspect,
  measure,
  measureMesh,
  MeshmarkError,
  verify,
  version,
  workKey,
} from "./index.js";
import { answer } from "./remote.js";

let codecsUrl: string | undefined;

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
    demoModel,
    version,
  },
  (setup) => {
    codecsUrl = setup?.["codecsUrl"];
    return init(setup?.["wasmUrl"]);
  },
);
