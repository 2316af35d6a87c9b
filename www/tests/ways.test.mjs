// Models that programs have compressed: marked, judged by Khronos's validator, opened by three.js in Chromium, and found again after what programs do to
// a compressed copy.
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { deriveKey, detect, embed, initFull } from "meshmark";
import { openShop } from "./in-chromium.mjs";
import { COMPRESSIONS, ready, WAYS } from "./programs.mjs";
import { OWNER, PASSPHRASE, RARELY, repository, smallModel, TAG } from "./support.mjs";
import { validationErrors } from "./validator.mjs";

/** What a commit tries: one of each codec. */
const OFTEN = ["Draco, 14 bits", "gltfpack -cf"];
/** glTF-Transform 4.5.1 reads no KHR_meshopt_compression, and gltfpack 1.3.0 no Draco. */
const NOT_READ = [/Missing required extension, "KHR_meshopt_compression"/, /file requires Draco mesh compression support/];

const pictures = new URL("test-output/", repository);
let host;
let key;
let shop;

before(async () => {
  mkdirSync(pictures, { recursive: true });
  await Promise.all([ready(), initFull()]);
  host = await smallModel();
  key = deriveKey(OWNER, PASSPHRASE);
  shop = await openShop();
});

after(() => shop?.close());

for (const [name, compress] of Object.entries(COMPRESSIONS)) {
  test(`${name}: marked, sound, shown, and found after all that programs do`, { skip: OFTEN.includes(name) ? false : RARELY }, async (t) => {
    const compressed = await compress({ model: host, files: {} });
    const { model, files, report } = embed(compressed.model, TAG, key, { files: compressed.files });
    const copy = { model, files };
    assert.deepEqual(report.warnings.filter((words) => !words.includes("larger than its host")), []);
    assert.deepEqual(await validationErrors(model, files), await validationErrors(compressed.model, compressed.files));
    const [before, shown] = [await shop.show(compressed), await shop.show(copy)];
    writeFileSync(new URL(`${name}.png`, pictures), shown.picture);
    assert.deepEqual([shown.triangles, shown.errors], [before.triangles, []]);
    assert.ok(shown.seen > 0.05 && Math.abs(shown.seen / before.seen - 1) < 0.02, `${shown.seen}, ${before.seen}`);
    assert.equal(detect(shown.exported, key).tag, TAG, "exported by three.js");
    let tried = 0;
    for (const [way, program] of Object.entries(WAYS)) {
      const made = await program(copy).catch((error) => NOT_READ.some((words) => words.test(error.message)) || assert.fail(error));
      if (made !== true) {
        assert.equal(detect(made.model, key, { files: made.files }).tag, TAG, way);
        tried += 1;
      }
    }
    t.diagnostic(`${tried} of ${Object.keys(WAYS).length} ways; its size is ${(model.length / compressed.model.length).toFixed(3)} of its host's`);
    assert.ok(tried >= 2);
  });
}
