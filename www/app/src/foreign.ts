/** Suspects in other formats, through three.js's loaders: their surfaces, as a plain .glb in memory. Each loader comes when it is needed. */
import type { Object3D } from "three";

type Bytes = Uint8Array<ArrayBuffer>;

/** What is read of each kind. */
const READERS: Record<string, (bytes: Bytes) => Promise<Object3D>> = {
  "3mf": async (bytes) => new (await import("three/addons/loaders/3MFLoader.js")).ThreeMFLoader().parse(bytes.buffer),
  dae: async (bytes) => {
    const { ColladaLoader } = await import("three/addons/loaders/ColladaLoader.js");
    return new ColladaLoader(await offline()).parse(text(bytes), "")!.scene;
  },
  fbx: async (bytes) => new (await import("three/addons/loaders/FBXLoader.js")).FBXLoader(await offline()).parse(bytes.buffer, ""),
  obj: async (bytes) => new (await import("three/addons/loaders/OBJLoader.js")).OBJLoader().parse(text(bytes)),
  ply: async (bytes) => {
    const [{ PLYLoader }, { Mesh }] = await Promise.all([import("three/addons/loaders/PLYLoader.js"), import("three")]);
    return new Mesh(new PLYLoader().parse(bytes.buffer));
  },
  stl: async (bytes) => {
    const [{ STLLoader }, { Mesh }] = await Promise.all([import("three/addons/loaders/STLLoader.js"), import("three")]);
    return new Mesh(new STLLoader().parse(bytes.buffer));
  },
  usdz: async (bytes) => new (await import("three/addons/loaders/USDLoader.js")).USDLoader(await offline()).parse(bytes.buffer) as unknown as Object3D,
};

const ENDINGS = new RegExp(`\\.(${Object.keys(READERS).join("|")})$`, "i");

/** Whether a file is of a kind that is read here, by its name. */
export function isForeign(name: string): boolean {
  return ENDINGS.test(name);
}

/** The surface of a file as a .glb: every triangle that it shows, in one mesh. */
export async function surfaceOf(name: string, bytes: Bytes): Promise<Bytes> {
  const kind = ENDINGS.exec(name)![1]!.toLowerCase();
  let object: Object3D;
  try {
    object = await READERS[kind]!(bytes.slice());
  } catch (error) {
    throw new Error(`“${name}” is no .${kind} file that can be read: ${(error as Error).message}.`);
  }
  return glb(await trianglesOf(object));
}

/** Materials name textures, which nobody looks at here: no URL is fetched. */
async function offline() {
  const { LoadingManager } = await import("three");
  const manager = new LoadingManager();
  manager.setURLModifier(() => "data:,");
  return manager;
}

function text(bytes: Bytes): string {
  return new TextDecoder().decode(bytes);
}

interface Triangles {
  positions: number[];
  indices: number[];
}

async function trianglesOf(object: Object3D): Promise<Triangles> {
  const { Mesh, Vector3 } = await import("three");
  object.updateMatrixWorld(true);
  const [positions, indices]: [number[], number[]] = [[], []];
  const corner = new Vector3();
  object.traverse((node) => {
    const attribute = node instanceof Mesh ? node.geometry.getAttribute("position") : undefined;
    if (!(node instanceof Mesh) || !attribute) {
      return;
    }
    const first = positions.length / 3;
    for (let i = 0; i < attribute.count; i++) {
      corner.fromBufferAttribute(attribute, i).applyMatrix4(node.matrixWorld);
      positions.push(corner.x, corner.y, corner.z);
    }
    const { index } = node.geometry;
    const corners = Array.from({ length: (index ?? attribute).count }, (_, i) => first + (index ? index.getX(i) : i));
    const isMirrored = node.matrixWorld.determinant() < 0;
    for (let i = 0; i + 2 < corners.length; i += 3) {
      const [a, b, c] = [corners[i]!, corners[i + 1]!, corners[i + 2]!];
      indices.push(...(isMirrored ? [a, c, b] : [a, b, c]));
    }
  });
  return { positions, indices };
}

/** A .glb of one mesh without normals or material. */
function glb({ positions, indices }: Triangles): Bytes {
  const [vertices, corners] = [new Float32Array(positions), new Uint32Array(indices)];
  const bounds = [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => reduce(vertices, axis, pick)));
  const json = {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: vertices.length / 3, type: "VEC3", min: bounds[0], max: bounds[1] },
      { bufferView: 1, componentType: 5125, count: corners.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: vertices.byteLength },
      { buffer: 0, byteOffset: vertices.byteLength, byteLength: corners.byteLength },
    ],
    buffers: [{ byteLength: vertices.byteLength + corners.byteLength }],
  };
  const head = new TextEncoder().encode(JSON.stringify(json));
  const padded = Math.ceil(head.length / 4) * 4;
  const length = 28 + padded + vertices.byteLength + corners.byteLength;
  const bytes = new Uint8Array(length);
  bytes.fill(0x20, 20, 20 + padded);
  bytes.set(head, 20);
  const view = new DataView(bytes.buffer);
  const words = [0x46546c67, 2, length, padded, 0x4e4f534a];
  words.forEach((word, i) => view.setUint32(4 * i, word, true));
  view.setUint32(20 + padded, vertices.byteLength + corners.byteLength, true);
  view.setUint32(24 + padded, 0x004e4942, true);
  bytes.set(new Uint8Array(vertices.buffer), 28 + padded);
  bytes.set(new Uint8Array(corners.buffer), 28 + padded + vertices.byteLength);
  return bytes;
}

function reduce(numbers: Float32Array, axis: number, pick: (a: number, b: number) => number): number {
  let best = numbers[axis] ?? 0;
  for (let i = axis; i < numbers.length; i += 3) {
    best = pick(best, numbers[i]!);
  }
  return best;
}
