// Prints how many meshes three.js shows of each file of the corpus, `null` where it refuses, as JSON. In a process of its own: the loader leaves
// promises behind that fail.
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { looseFiles, malformedFiles } from "./corpus.mjs";

const PATIENCE = 2000;
globalThis.self ??= globalThis; // it expects a browser
globalThis.ProgressEvent ??= class extends Event {};
console.error = console.warn = () => {};

async function shown(bytes) {
  try {
    const { scene } = await new Promise((resolve, reject) => {
      setTimeout(() => reject(new Error("it never ends")), PATIENCE).unref();
      new GLTFLoader().parse(bytes.slice().buffer, "", resolve, reject);
    });
    let meshes = 0;
    scene?.traverse((object) => (meshes += object.isMesh ? 1 : 0));
    return meshes;
  } catch {
    return null;
  }
}

const all = async (files) => {
  const shownOf = {};
  for (const { name, bytes } of files) {
    shownOf[name] = await shown(bytes);
  }
  return shownOf;
};
process.stdout.write(JSON.stringify({ ...(await all(looseFiles())), ...(await all(malformedFiles())) }), () => process.exit());
