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
} from "./index.js";
import { answer } from "./remote.js";

let codecsUrl: string | undefined;
let informedUrl: string | undefined;

/** The module that reads with the original, once it was asked for. */
async function informed(): Promise<typeof import("./informed.js")> {
  const module = await import("./informed.js");
  await module.init(informedUrl);
  return module;
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
    compare: async (...args: Parameters<typeof import("./informed.js").compare>) => (await informed()).compare(...args),
    compareMesh: async (...args: Parameters<typeof import("./informed.js").compareMesh>) => (await informed()).compareMesh(...args),
    demoModel,
    version,
  },
  (setup) => {
    codecsUrl = setup?.["codecsUrl"];
    informedUrl = setup?.["informedUrl"];
    return init(setup?.["wasmUrl"]);
  },
);
