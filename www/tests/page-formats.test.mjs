// What people drop that is no plain .glb: compressed models, archives, folders, suspects in other formats, avatars.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before } from "node:test";
import { Logger, NodeIO, Verbosity } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { draco, meshopt } from "@gltf-transform/functions";
import draco3d from "draco3dgltf";
import { unzipSync, zipSync } from "fflate";
import * as meshmark from "meshmark";
import { MeshoptDecoder, MeshoptEncoder } from "meshoptimizer";
import { BufferGeometry, Float32BufferAttribute, Mesh, MeshStandardMaterial } from "three";
import { OBJExporter } from "three/addons/exporters/OBJExporter.js";
import { PLYExporter } from "three/addons/exporters/PLYExporter.js";
import { STLExporter } from "three/addons/exporters/STLExporter.js";
import { USDZExporter } from "three/addons/exporters/USDZExporter.js";
import { button, check, comeToLook, drop, dropped, facts, fillKey, folder, headline, mark, onDisk, onPage, page, picture, result, saved, unseen, view } from "./page.mjs";
import { OWNER, PASSPHRASE, smallModel, TAG } from "./support.mjs";
import { as3mf, asDae, asFbx } from "./writers.mjs";

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).setLogger(new Logger(Verbosity.ERROR));
let small;
let marked;

before(async () => {
  const [decoder, encoder] = await Promise.all([draco3d.createDecoderModule(), draco3d.createEncoderModule(), MeshoptEncoder.ready, MeshoptDecoder.ready]);
  io.registerDependencies({ "draco3d.decoder": decoder, "draco3d.encoder": encoder, "meshopt.decoder": MeshoptDecoder, "meshopt.encoder": MeshoptEncoder });
  small = await smallModel();
  marked = meshmark.embed(small, TAG, meshmark.deriveKey(OWNER, PASSPHRASE)).model;
});

async function compressed(model, transform) {
  const document = await io.readBinary(model);
  return document.transform(transform);
}

/** The model as a .gltf with its buffers and a texture in folders. */
async function asFolder(name, document) {
  const { json, resources } = await io.writeJSON(document, { basename: "scene" });
  json.images = [{ uri: "pictures/wood%20a.png" }];
  const files = { "scene.gltf": Buffer.from(JSON.stringify(json)), "pictures/wood a.png": Buffer.from("no picture, but its name is right") };
  Object.entries(resources).forEach(([uri, bytes]) => (files[uri] = Buffer.from(bytes)));
  const root = join(folder, name);
  for (const [path, bytes] of Object.entries(files)) {
    mkdirSync(join(root, path, ".."), { recursive: true });
    writeFileSync(join(root, path), bytes);
  }
  return { root, files };
}

onPage("a model compressed by Draco is shown, marked and checked", async () => {
  await dropped(onDisk("draco.glb", await io.writeBinary(await compressed(small, draco()))));
  await facts().getByText(/3,\d+ vertices/).waitFor();
  assert.ok(await comeToLook(([seen]) => seen.length > 10_000), "there is nothing to be seen");
  await picture("draco");
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  await picture("draco-marked");
  const copy = await saved("Download draco.marked.glb");
  const { json } = await io.binaryToJSON(readFileSync(copy));
  assert.deepEqual(json.extensionsRequired, ["KHR_draco_mesh_compression"]);
  await page.getByRole("tab", { name: "Check" }).click();
  await drop(copy);
  await facts().getByText("draco.marked.glb").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
});

unseen("a folder with a model compressed by meshopt is marked, and had as an archive that opens", async () => {
  const { root } = await asFolder("meshopt", await compressed(small, meshopt({ encoder: MeshoptEncoder })));
  await drop(root);
  await facts().getByText("scene.gltf").waitFor();
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const archive = await saved("Download scene.marked.zip");
  const files = unzipSync(readFileSync(archive));
  assert.deepEqual(Object.keys(files).sort(), ["pictures/wood a.png", "scene.bin", "scene.marked.gltf"]);
  await page.getByRole("tab", { name: "Check" }).click();
  await drop(archive);
  await facts().getByText("scene.marked.gltf").waitFor();
  await check();
  assert.equal(await headline(), "Your mark was found");
});

unseen("a model in several files has a folder for each buyer's copy", async () => {
  const { root, files } = await asFolder("copies", await io.readBinary(small));
  await drop(root);
  await facts().getByText("scene.gltf").waitFor();
  await view().getByText("One copy for each buyer").click();
  await page.getByLabel("Names of the buyers").fill("Grace\nLin");
  await fillKey();
  await button("Make the copies").click();
  await view().getByText("2 copies, each read back with its number").waitFor();
  const made = unzipSync(readFileSync(await saved("Download all (.zip)")));
  const each = ["pictures/wood a.png", "scene.bin", "scene.gltf"];
  assert.deepEqual(Object.keys(made).sort(), [...each.map((name) => `1/${name}`), ...each.map((name) => `2/${name}`), "ledger.csv", "ledger.json"]);
  assert.deepEqual(Buffer.from(made["1/pictures/wood a.png"]), files["pictures/wood a.png"]);
  assert.notDeepEqual(made["1/scene.bin"], made["2/scene.bin"]);
  assert.match(Buffer.from(made["ledger.csv"]).toString(), /\n2,Lin,2\/scene\.gltf,/);
  await page.getByRole("tab", { name: "Check" }).click();
  await drop(onDisk("leaked.zip", zipSync(Object.fromEntries(each.map((name) => [name, made[`2/${name}`]])))));
  await page.getByLabel("Ledger of buyers").setInputFiles(onDisk("buyers.csv", made["ledger.csv"]));
  await check();
  assert.deepEqual(await result().locator("li strong").allTextContents(), ["Lin"]);
});

unseen("an archive is as good as what is in it", async () => {
  const { files } = await asFolder("plain", await io.readBinary(small));
  await drop(onDisk("all.zip", zipSync({ "deep/": new Uint8Array(), ...Object.fromEntries(Object.entries(files).map(([path, bytes]) => [`deep/${path}`, bytes])) })));
  await facts().getByText("scene.gltf").waitFor();
  assert.equal(await facts().getByText("which it names").count(), 0, "something is missing");
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const copy = unzipSync(readFileSync(await saved("Download scene.marked.zip")));
  assert.deepEqual(Buffer.from(copy["pictures/wood a.png"]), files["pictures/wood a.png"]);
  await drop(onDisk("torn.zip", "PK no archive"));
  await result().getByText(/“torn\.zip” cannot be unpacked/).waitFor();
});

/** The surface of a model of one primitive. */
async function surfaceOf(model) {
  const document = await io.readBinary(model);
  const [primitive] = document.getRoot().listMeshes()[0].listPrimitives();
  return { positions: primitive.getAttribute("POSITION").getArray(), indices: primitive.getIndices().getArray() };
}

/** The same as three.js's exporters take it: Z up, in millimetres. */
function meshOf({ positions, indices }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setIndex([...indices]);
  geometry.computeVertexNormals();
  const mesh = new Mesh(geometry, new MeshStandardMaterial());
  mesh.rotation.x = Math.PI / 2;
  mesh.scale.setScalar(1000);
  mesh.updateMatrixWorld(true);
  return mesh;
}

/** What three.js's exporters write of a mesh, and the command line reads too. */
function exported(mesh) {
  return {
    "copy.stl": Buffer.from(new STLExporter().parse(mesh, { binary: true }).buffer),
    "text.stl": new STLExporter().parse(mesh),
    "copy.obj": new OBJExporter().parse(mesh),
    "copy.ply": new PLYExporter().parse(mesh, undefined, {}),
    "binary.ply": Buffer.from(new PLYExporter().parse(mesh, undefined, { binary: true, littleEndian: true })),
  };
}

onPage("suspects in other formats are shown and checked, and not taken for marking", async () => {
  const files = exported(meshOf(await surfaceOf(marked)));
  await drop(onDisk("copy.stl", files["copy.stl"]));
  await result().getByText(/“copy\.stl” is a model, but not of glTF\. It can be checked as it is/).waitFor();
  await page.getByRole("tab", { name: "Check" }).click();
  for (const [name, content] of Object.entries(files)) {
    await drop(onDisk(name, content));
    await facts().getByText(name, { exact: true }).waitFor();
    await facts().getByText(/3,\d+ vertices/).waitFor();
    await check();
    assert.equal(await headline(), "Your mark was found", name);
  }
  assert.ok(await comeToLook(([seen]) => seen.length > 10_000), "there is nothing to be seen");
  await picture("suspect-ply");
  await drop(onDisk("torn.fbx", "nothing"));
  await result().getByText(/“torn\.fbx” is no \.fbx file that can be read/).waitFor();
});

unseen("suspects in formats that the page alone reads are checked", async () => {
  const surface = await surfaceOf(marked);
  const files = {
    "copy.3mf": as3mf(surface),
    "copy.dae": asDae(surface),
    "copy.fbx": asFbx(surface),
    "copy.usdz": await new USDZExporter().parseAsync(meshOf(surface)),
  };
  await page.getByRole("tab", { name: "Check" }).click();
  for (const [name, content] of Object.entries(files)) {
    await drop(onDisk(name, content));
    await facts().getByText(name, { exact: true }).waitFor();
    await check();
    assert.equal(await headline(), "Your mark was found", name);
  }
});

unseen("an avatar is marked under its own name", async () => {
  const document = await io.readBinary(small);
  const { json, resources } = await io.writeJSON(document);
  json.extensionsUsed = json.extensionsRequired = ["VRMC_vrm"];
  json.extensions = { VRMC_vrm: { specVersion: "1.0" } };
  const [bin] = Object.values(resources);
  delete json.buffers[0].uri;
  const head = Buffer.from(JSON.stringify(json).padEnd(Math.ceil(JSON.stringify(json).length / 4) * 4));
  const chunk = (kind, data) => [Buffer.from(Uint32Array.of(data.length).buffer), Buffer.from(kind), data];
  const body = Buffer.concat([...chunk("JSON", head), ...chunk("BIN\0", Buffer.from(bin))]);
  await drop(onDisk("avatar.vrm", Buffer.concat([Buffer.from("glTF"), Buffer.from(Uint32Array.of(2, 12 + body.length).buffer), body])));
  await facts().getByText("avatar.vrm").waitFor();
  await mark();
  assert.equal(await headline(), "Your mark is in the copy");
  const copy = new Uint8Array(readFileSync(await saved("Download avatar.marked.vrm")));
  assert.equal(meshmark.detect(copy, meshmark.deriveKey(OWNER, PASSPHRASE)).tag, TAG);
});
