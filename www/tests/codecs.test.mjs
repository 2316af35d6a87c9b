// Compressed models, by other people's encoders: what is decoded is what those people's decoders give; such models are marked and found.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { Logger, NodeIO, Verbosity } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { draco, meshopt } from "@gltf-transform/functions";
import draco3d from "draco3dgltf";
import { decompress, deriveKey, detect, embed, init, initFull, inspect } from "meshmark";
import { MeshoptDecoder, MeshoptEncoder } from "meshoptimizer";
import { assertNoNewErrors, OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).setLogger(new Logger(Verbosity.ERROR));
const variants = {
  "Draco, 14 bits": [draco({ method: "edgebreaker" })],
  "Draco, 11 bits, sequential": [draco({ method: "sequential", quantizePosition: 11 })],
  "Draco, densest": [draco({ method: "edgebreaker", encodeSpeed: 0, decodeSpeed: 0 })],
  "meshopt, medium": [meshopt({ encoder: MeshoptEncoder, level: "medium" })],
  "meshopt, high": [meshopt({ encoder: MeshoptEncoder, level: "high" })],
};
let host;
let key;

before(async () => {
  const [decoder, encoder] = await Promise.all([draco3d.createDecoderModule(), draco3d.createEncoderModule(), init(), MeshoptEncoder.ready, MeshoptDecoder.ready]);
  io.registerDependencies({ "draco3d.decoder": decoder, "draco3d.encoder": encoder, "meshopt.decoder": MeshoptDecoder, "meshopt.encoder": MeshoptEncoder });
  host = await smallModel();
  key = deriveKey(OWNER, PASSPHRASE);
});

async function compressed(transforms) {
  const document = await io.readBinary(host);
  await document.transform(...transforms);
  return io.writeBinary(document);
}

/** All vertices and triangles of the first primitive. */
async function contentOf(model) {
  const document = await io.readBinary(model);
  const [primitive] = document.getRoot().listMeshes()[0].listPrimitives();
  const numbers = (accessor) => Array.from(accessor.getArray());
  const attributes = primitive.listSemantics().map((name) => [name, numbers(primitive.getAttribute(name))]);
  return { indices: numbers(primitive.getIndices()), ...Object.fromEntries(attributes) };
}

test("without the codecs a compressed model is refused, with what helps", async () => {
  const model = await compressed(variants["Draco, 14 bits"]);
  assert.throws(() => inspect(model), { code: "document.compression-unsupported", message: /initFull/ });
  assert.deepEqual(decompress(host).model, host);
  await initFull();
});

for (const [name, transforms] of Object.entries(variants)) {
  test(`${name}: decoded as others decode it, marked, and found`, async (t) => {
    await initFull();
    const model = await compressed(transforms);
    const plain = decompress(model);
    assert.deepEqual(plain.files, {});
    assert.deepEqual(await contentOf(plain.model), await contentOf(model));
    const { model: marked, report } = embed(model, TAG, key);
    t.diagnostic(`${model.length} bytes, marked ${marked.length}, ln p ${report.readBack.lnP.toFixed(1)}`);
    const growth = marked.length / model.length - 1; // a moved surface is less regular
    assert.ok(growth < 0.1, `${marked.length} bytes of ${model.length}`);
    const larger = `the copy is ${(100 * growth).toFixed(1)} % larger than its host`;
    assert.deepEqual(report.warnings.map((text) => text.split(":")[0]), growth > 0.03 ? [larger] : []);
    await assertNoNewErrors(model, marked);
    assert.equal(detect(marked, key).tag, TAG);
    // Others decode what was encoded here to what is decoded here.
    assert.deepEqual(await contentOf(decompress(marked).model), await contentOf(marked));
    const extensions = async (bytes) => (await io.readBinary(bytes)).getRoot().listExtensionsUsed().map(({ extensionName }) => extensionName);
    assert.deepEqual(await extensions(marked), await extensions(model));
  });
}

test("a mark is found after compression by either codec", async () => {
  const { model: marked } = embed(host, TAG, key);
  for (const [name, transforms] of Object.entries(variants)) {
    const document = await io.readBinary(marked);
    await document.transform(...transforms);
    assert.equal(detect(await io.writeBinary(document), key).tag, TAG, name);
  }
});
