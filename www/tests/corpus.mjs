// Files of every kind that a reader meets, made here: sound ones in all their variety, and malformed ones. Each as `{ name, bytes, files }`.

const TRIANGLE = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const COMPONENTS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };

/** A tetrahedron: a description of JSON, and the bytes of its one buffer. */
function sound({ indexType = 5123, positionType = 5126, mode = 4, isIndexed = true } = {}) {
  const scale = positionType === 5126 ? 1 : 100;
  const positions = COMPONENTS[positionType].from(TRIANGLE, (number) => number * scale);
  const size = positions.BYTES_PER_ELEMENT * 3;
  const stride = Math.ceil(size / 4) * 4;
  const bytes = new Uint8Array(4 * stride);
  for (let vertex = 0; vertex < 4; vertex++) {
    bytes.set(new Uint8Array(positions.buffer, vertex * size, size), vertex * stride);
  }
  const corners = mode === 4 ? [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3] : [0, 1, 2, 3];
  const indices = new Uint8Array(COMPONENTS[indexType].from(corners).buffer);
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, children: [1] }, { mesh: 0, translation: [3, 0, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, mode, ...(isIndexed && { indices: 1 }) }] }],
    accessors: [
      { bufferView: 0, componentType: positionType, count: 4, type: "VEC3", min: [0, 0, 0], max: [scale, scale, scale] },
      { bufferView: 1, componentType: indexType, count: corners.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: bytes.length, byteStride: stride },
      { buffer: 0, byteOffset: bytes.length, byteLength: indices.length },
    ],
    buffers: [{ byteLength: bytes.length + indices.length }],
    ...(positionType !== 5126 && { extensionsUsed: ["KHR_mesh_quantization"], extensionsRequired: ["KHR_mesh_quantization"] }),
  };
  return { json, binary: Buffer.concat([bytes, indices]) };
}

export function glb(json, binary, { pad = true } = {}) {
  const text = typeof json === "string" ? json : JSON.stringify(json);
  const head = Buffer.from(pad ? text.padEnd(Math.ceil(text.length / 4) * 4) : text);
  const chunk = (kind, data) => Buffer.concat([Buffer.from(Uint32Array.of(data.length).buffer), Buffer.from(kind), data]);
  const padded = Buffer.concat([binary, Buffer.alloc((4 - (binary.length % 4)) % 4)]);
  const body = Buffer.concat([chunk("JSON", head), chunk("BIN\0", padded)]);
  return new Uint8Array(Buffer.concat([Buffer.from("glTF"), Buffer.from(Uint32Array.of(2, 12 + body.length).buffer), body]));
}

/** Sound files: each kind of number, mode, container and placing that glTF 2.0 has for triangles. */
export function soundFiles() {
  const files = [];
  const add = (name, { json, binary }, change = () => {}) => {
    change(json);
    files.push({ name, bytes: glb(json, binary) });
  };
  for (const indexType of [5121, 5123, 5125]) {
    for (const mode of [4, 5, 6]) {
      add(`indices ${indexType}, mode ${mode}`, sound({ indexType, mode }));
    }
  }
  for (const positionType of [5120, 5121, 5122, 5123]) {
    add(`positions ${positionType}`, sound({ positionType }));
  }
  for (const mode of [4, 5, 6]) {
    add(`no indices, mode ${mode}`, sound({ isIndexed: false, mode }));
  }
  add("a matrix", sound(), (json) => (json.nodes[0].matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]));
  add("a mirrored node", sound(), (json) => (json.nodes[0].scale = [-1, 1, 1]));
  add("no scene", sound(), (json) => (delete json.scenes, delete json.scene));
  add("two scenes", sound(), (json) => json.scenes.push({ nodes: [0] }));
  add("a sparse accessor", sound(), (json) => {
    json.accessors[0].sparse = { count: 1, indices: { bufferView: 2, componentType: 5123 }, values: { bufferView: 3 } };
    json.bufferViews.push({ buffer: 0, byteOffset: 48, byteLength: 2 }, { buffer: 0, byteOffset: 0, byteLength: 12 });
  });
  add("instances", sound(), (json) => {
    json.extensionsUsed = json.extensionsRequired = ["EXT_mesh_gpu_instancing"];
    json.nodes[0].extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: 2 } } };
    json.accessors.push({ bufferView: 0, componentType: 5126, count: 4, type: "VEC3" });
  });
  add("a morph target", sound(), (json) => {
    json.meshes[0].primitives[0].targets = [{ POSITION: 2 }];
    json.accessors.push({ bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] });
  });
  const { json, binary } = sound();
  json.buffers[0].uri = `data:application/octet-stream;base64,${binary.toString("base64")}`;
  files.push({ name: "a data URI", bytes: new TextEncoder().encode(JSON.stringify(json)) });
  json.buffers[0].uri = "a%20b.bin";
  files.push({ name: "a file", bytes: new TextEncoder().encode(JSON.stringify(json)), files: { "a b.bin": new Uint8Array(binary) } });
  return files;
}

/** What glTF forbids and loaders open: what people's files are like. */
export function looseFiles() {
  const files = [];
  const add = (name, change, { json, binary } = sound()) => files.push({ name, bytes: glb(change(json, binary) ?? json, binary) });
  add("a scene that lists a child", (json) => void json.scenes[0].nodes.push(1));
  add("a node with two parents", (json) => void (json.nodes.push({ children: [1] }), json.scenes[0].nodes.push(2)));
  add("a child listed twice", (json) => void json.nodes[0].children.push(1));
  add("no numbers where no triangle looks", (json) => void (json.meshes[0].primitives[0].indices = 1), nowhere());
  add("a required extension of data", (json) => void (json.extensionsUsed = json.extensionsRequired = ["OMI_seat"]));
  const trailing = glb(sound().json, sound().binary);
  files.push({ name: "bytes after the end", bytes: new Uint8Array(Buffer.concat([trailing, Buffer.from("more")])) });
  return files;
}

/** A fifth vertex that is nowhere, and that no triangle uses. */
function nowhere() {
  const { json, binary } = sound();
  const vertex = Buffer.from(new Float32Array([NaN, 0, 0]).buffer);
  json.accessors[0].count = 5;
  json.bufferViews[0].byteLength += 12;
  json.bufferViews[1].byteOffset += 12;
  json.buffers[0].byteLength += 12;
  return { json, binary: Buffer.concat([binary.subarray(0, 48), vertex, binary.subarray(48)]) };
}

/** Values that stand in the place of every value of a sound file, one at a time. */
const WRONG = [-1, 1e99, 4294967295, 7, 0.5, null, "x", [], {}, true];

/** Malformed files: every member of a sound one taken away or made wrong, every part of its container cut or changed. */
export function malformedFiles() {
  const files = [];
  const { json, binary } = sound();
  const places = [];
  const walk = (value, path) => {
    for (const [name, child] of Object.entries(value)) {
      places.push([...path, name]);
      if (child && typeof child === "object") {
        walk(child, [...path, name]);
      }
    }
  };
  walk(json, []);
  const changed = (path, change) => {
    const copy = structuredClone(json);
    const parent = path.slice(0, -1).reduce((value, name) => value[name], copy);
    change(parent, path.at(-1));
    return glb(copy, binary);
  };
  for (const path of places) {
    const name = path.join("/");
    files.push({ name: `without ${name}`, bytes: changed(path, (parent, last) => (Array.isArray(parent) ? parent.splice(last, 1) : delete parent[last])) });
    for (const wrong of WRONG) {
      files.push({ name: `${name}: ${JSON.stringify(wrong)}`, bytes: changed(path, (parent, last) => (parent[last] = wrong)) });
    }
  }
  const whole = glb(json, binary);
  for (let length = 0; length < whole.length; length += 16) {
    files.push({ name: `cut at ${length}`, bytes: whole.slice(0, length) });
  }
  for (let place = 0; place < 24; place++) {
    const bytes = whole.slice();
    bytes[place] ^= 0xff;
    files.push({ name: `byte ${place} changed`, bytes });
  }
  return files;
}
