// Real models through the optimiser that the web uses: weld, reorder, quantize to 14 bits, prune. The mark is still found.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { Logger, NodeIO, Verbosity } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { prune, quantize, reorder, weld } from "@gltf-transform/functions";
import { deriveKey, embed, extract, init, measure } from "meshmark";
import { MeshoptEncoder } from "meshoptimizer";
import { assertNoNewErrors, glbFromObj, OWNER, PASSPHRASE, sharedModel, TAG } from "./support.mjs";

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).setLogger(new Logger(Verbosity.ERROR));
let key;

before(async () => {
  await Promise.all([init(), MeshoptEncoder.ready]);
  key = deriveKey(OWNER, PASSPHRASE);
});

for (const [path, read] of [
  ["gltf/chr_knight.glb", (bytes) => bytes],
  ["gltf/ShapeCollection.glb", (bytes) => bytes],
  ["obj/stanford-bunny.obj", (bytes) => glbFromObj(new TextDecoder().decode(bytes))],
]) {
  test(`${path} is marked, optimised, and its mark found`, async (t) => {
    const file = sharedModel(path, t);
    if (!file) {
      return;
    }
    const host = read(file);
    const { model: marked, report } = embed(host, TAG, key);
    t.diagnostic(`RMS ${(report.rmsRel * 100).toFixed(4)} % of the diagonal; as marked ${bounds(report.readBack)}`);
    await assertNoNewErrors(host, marked);
    const optimised = await optimise(marked);
    const reading = extract(measure(optimised), key);
    t.diagnostic(`after the optimiser ${bounds(reading)}`);
    assert.equal(reading.verdict, "found", reading.reason ?? "");
    assert.equal(reading.tag, TAG);
  });
}

/** ln p, over all carriers and of each. */
function bounds({ lnP, carriers }) {
  return `ln p ${lnP.toFixed(1)} (${carriers.map((carrier) => `${carrier.name} ${carrier.lnP.toFixed(1)}`).join(", ")})`;
}

async function optimise(model) {
  const document = await io.readBinary(model);
  await document.transform(weld(), reorder({ encoder: MeshoptEncoder }), quantize({ quantizePosition: 14 }), prune());
  return io.writeBinary(document);
}
