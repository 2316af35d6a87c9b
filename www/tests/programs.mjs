// Programs that people compress models with, and what these do to a compressed copy. A model is `{ model, files }`, as the package has it.
import { GLB_BUFFER, Logger, NodeIO, Verbosity } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { dequantize, draco, flatten, join, meshopt, prune, resample, simplify, sparse, unpartition, weld } from "@gltf-transform/functions";
import draco3d from "draco3dgltf";
import { pack } from "gltfpack";
import { MeshoptDecoder, MeshoptEncoder, MeshoptSimplifier } from "meshoptimizer";

export const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).setLogger(new Logger(Verbosity.ERROR));

/** Before anything else here is called. */
export async function ready() {
  const [decoder, encoder] = await Promise.all([draco3d.createDecoderModule(), draco3d.createEncoderModule()]);
  await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready, MeshoptSimplifier.ready]);
  io.registerDependencies({ "draco3d.decoder": decoder, "draco3d.encoder": encoder, "meshopt.decoder": MeshoptDecoder, "meshopt.encoder": MeshoptEncoder });
}

/** Reads a model and forgets its compression. */
async function read({ model, files = {} }) {
  const { json, binary } = partsOf(model);
  const names = Object.entries(files).map(([name, bytes]) => [encodeURIComponent(name), bytes]);
  const document = await io.readJSON({ json, resources: { ...Object.fromEntries(names), ...files, [GLB_BUFFER]: binary } });
  for (const extension of document.getRoot().listExtensionsUsed()) {
    if (extension.extensionName.endsWith("_compression")) {
      extension.dispose();
    }
  }
  return document.setLogger(new Logger(Verbosity.ERROR));
}

/** The JSON and the chunk of a .glb, or the JSON of a .gltf. */
export function partsOf(model) {
  const text = (bytes) => JSON.parse(new TextDecoder().decode(bytes));
  if (model[0] === "{".charCodeAt(0)) {
    return { json: text(model), binary: new Uint8Array() };
  }
  const length = new DataView(model.buffer, model.byteOffset).getUint32(12, true);
  return { json: text(model.subarray(20, 20 + length)), binary: model.subarray(28 + length) };
}

/** glTF-Transform 4.5.1 flattens positions that are whole numbers and not normalized, as gltfpack writes them, when it quantizes them. */
async function asFloats(document) {
  const meshes = document.getRoot().listMeshes();
  const positions = meshes.flatMap((mesh) => mesh.listPrimitives().map((primitive) => primitive.getAttribute("POSITION")));
  if (positions.some((accessor) => accessor?.getArray() instanceof Uint16Array && !accessor.getNormalized())) {
    await document.transform(dequantize());
  }
}

/** The transforms of glTF-Transform 4.5.1, written as one .glb. */
const transformed =
  (...transforms) =>
  async (model) => {
    const document = await read(model);
    await document.transform(asFloats, unpartition(), ...transforms);
    return { model: await io.writeBinary(document), files: {} };
  };

/** gltfpack 1.3.0. It reads no Draco. */
const packed =
  (...options) =>
  async ({ model, files }) => {
    const written = {};
    const sources = { "in.glb": model, ...files };
    const read = (path) => sources[decodeURIComponent(path)];
    await pack(["-i", "in.glb", "-o", "model.glb", ...options], { read, write: (path, bytes) => (written[path] = bytes.slice()) });
    const { "model.glb": result, ...beside } = written;
    return { model: result, files: beside };
  };

/** As the command `optimize` does it, but for textures, instances and palettes: one mesh has none. */
const optimized = (...more) => [flatten(), join(), weld(), ...more, resample(), prune(), sparse()];

const byDraco = (options) => draco({ method: "edgebreaker", ...options });
const byMeshopt = (level) => meshopt({ encoder: MeshoptEncoder, level });

/** How hosts are compressed. Blender's exporter writes Draco with 14 bits; 11 bits are Draco's own default. */
export const COMPRESSIONS = {
  "Draco, 14 bits": transformed(byDraco()),
  "Draco, 11 bits": transformed(byDraco({ quantizePosition: 11 })),
  "Draco, 11 bits, sequential": transformed(byDraco({ method: "sequential", quantizePosition: 11 })),
  "Draco, densest": transformed(byDraco({ encodeSpeed: 0, decodeSpeed: 0 })),
  "meshopt, medium": transformed(byMeshopt("medium")),
  "meshopt, high": transformed(byMeshopt("high")),
  "gltfpack -c": packed("-c"),
  "gltfpack -cc": packed("-cc"),
  "gltfpack -cf": packed("-cf"),
  "gltfpack -cz": packed("-cz"),
  "gltfpack -cc -vpf": packed("-cc", "-vpf"),
};

/** What comes of a copy on its way. A program that does not read a model throws. */
export const WAYS = {
  decompressed: transformed(),
  "compressed by Draco": transformed(byDraco()),
  "compressed by meshopt": transformed(byMeshopt("medium")),
  "optimized, not simplified": transformed(...optimized(), byMeshopt("high")),
  optimized: transformed(...optimized(simplify({ simplifier: MeshoptSimplifier, ratio: 0, error: 1e-4 })), byMeshopt("high")),
  "decompressed by gltfpack": packed("-noq"),
  "gltfpack -cc": packed("-cc"),
};
