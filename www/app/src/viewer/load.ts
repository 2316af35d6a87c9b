/** A model for the eye: three.js reads it, every URL in it answered from memory. */
import { LoadingManager, Mesh, MeshStandardMaterial, type Group, type Material } from "three";
import { GLTFLoader, type GLTF } from "three/addons/loaders/GLTFLoader.js";
import { engine } from "../engine";
import { decoded, type Model } from "../model";

/** A grey between light grounds and dark ones. */
const BARE = 0x8d9299;

/**
 * The model's scene. No URL in a model reaches the network: files that were handed in and data: URIs become blob: URLs,
 * anything else becomes an empty one.
 */
export async function loadScene(compressed: Model): Promise<Group> {
  const model = await plain(compressed);
  const made: string[] = [];
  const manager = new LoadingManager();
  manager.setURLModifier((url) => {
    if (url.startsWith("blob:")) {
      return url;
    }
    const content = url.startsWith("data:") ? dataOf(url) : (model.buffers[decoded(url)] ?? model.images[decoded(url)]);
    const local = URL.createObjectURL(new Blob(content ? [content as BlobPart] : []));
    made.push(local);
    return local;
  });
  try {
    const gltf = await new GLTFLoader(manager).parseAsync(model.bytes.slice().buffer, "");
    gltf.scene.traverse((object) => object instanceof Mesh && colorBare(gltf, object.material));
    return gltf.scene;
  } finally {
    made.forEach((url) => URL.revokeObjectURL(url));
  }
}

/** What three.js would need codecs of its own for. */
async function plain(model: Model): Promise<Model> {
  const start = new TextDecoder().decode(model.bytes.subarray(0, 2 ** 24));
  if (!/"(KHR_draco_mesh|\w+_meshopt)_compression"/.test(start)) {
    return model;
  }
  const { model: bytes, files } = await (await engine).decompress(model.bytes, { files: model.buffers });
  return { ...model, bytes: bytes as Model["bytes"], buffers: { ...model.buffers, ...files } };
}

/** What has no material is white by glTF's rules: on a light ground nothing is seen of it. */
function colorBare({ parser }: GLTF, material: Material): void {
  if (parser.associations.get(material)?.materials === undefined && material instanceof MeshStandardMaterial && !material.vertexColors) {
    material.color.set(BARE);
    material.metalness = 0;
  }
}

function dataOf(uri: string): Uint8Array | undefined {
  const [, isBase64, text] = /^data:[^,]*?(;base64)?,(.*)$/s.exec(uri) ?? [];
  if (text === undefined) {
    return undefined;
  }
  return isBase64 ? Uint8Array.from(atob(text), (c) => c.charCodeAt(0)) : new TextEncoder().encode(decoded(text));
}
