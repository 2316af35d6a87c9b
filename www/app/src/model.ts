/** A model as the person handed it in: one main file, and the files that it names. */
import type { Files } from "meshmark";
import { isForeign, surfaceOf } from "./foreign";

export interface Model {
  /** The main file's name, without folders. */
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
  /** By URI, percent-decoded: what the geometry is read from, and what is only looked at. */
  buffers: Files;
  images: Files;
  /** The file itself, where `bytes` is what its surface was made into, for it is no glTF. */
  original?: Uint8Array<ArrayBuffer>;
}

export interface NamedFile {
  /** With folders, `/` between them. */
  path: string;
  file: File;
}

/** A model among some files, not read yet: several may be too much to hold in memory. */
export interface Found {
  name: string;
  open(): Promise<Model>;
}

const MAIN = /\.(glb|gltf|vrm)$/i;
const EVIDENCE = /\.mmev$/i;
const GLB_MAGIC = 0x46546c67;

/** What a file is that is no model, and what to do with it. */
const OTHERS: [ending: RegExp, words: string][] = [
  [/\.(png|jpe?g|webp|ktx2|gif|bmp|tiff?)$/i, "is a picture. If a .gltf names it, drop both together, or the .gltf first"],
  [/\.bin$/i, "is a part of a .gltf. Drop both together, or the .gltf first"],
  [/\.(7z|rar|tar|gz)$/i, "is an archive. Unpack it, and drop the model that is in it"],
  [/\.(obj|stl|ply|fbx|dae|3mf|usdz)$/i, "is a model, but not of glTF. It can be checked as it is; to mark it, open it in a program such as Blender and export it as glTF (.glb)"],
  [/\.(blend|3ds|usd[ac]?|max|ma|mb|step|stp|iges)$/i, "is a model, but not of glTF. Open it in a program such as Blender and export it as glTF (.glb)"],
  [/\.key$/i, "seems to be a key. Choose it in the form, under “Key file”"],
  [EVIDENCE, "is evidence, measured from a model. Drop it in Check"],
];

/**
 * The models among some files, each with the files beside it that it names. Of suspects also those that are no glTF, where there is none that
 * is, and evidence, which stands for a model.
 *
 * @throws where there is none, in words
 */
export function modelsIn(files: NamedFile[], areSuspects = false): Found[] {
  const gltf = files.filter(({ path }) => MAIN.test(path) || (areSuspects && EVIDENCE.test(path)));
  const mains = gltf.length === 0 && areSuspects ? files.filter(({ path }) => isForeign(path)) : gltf;
  if (mains.length === 0) {
    throw new Error(otherWords(files));
  }
  return mains.map((main) => ({ name: main.file.name, open: () => open(main, files) }));
}

async function open(main: NamedFile, files: NamedFile[]): Promise<Model> {
  const bytes = new Uint8Array(await main.file.arrayBuffer());
  if (isForeign(main.path)) {
    return { name: main.file.name, bytes: await surfaceOf(main.file.name, bytes), buffers: {}, images: {}, original: bytes };
  }
  const folder = main.path.slice(0, main.path.lastIndexOf("/") + 1);
  const { buffers, images } = urisOf(bytes);
  return { name: main.file.name, bytes, buffers: await pick(buffers, files, folder), images: await pick(images, files, folder) };
}

function otherWords(files: NamedFile[]): string {
  for (const { file } of files) {
    const words = OTHERS.find(([ending]) => ending.test(file.name))?.[1];
    if (words) {
      return `“${file.name}” ${words}.`;
    }
  }
  return "There is no .glb, .gltf or .vrm file in this.";
}

/** The files that a model names and that were not handed in. */
export function missingFiles({ bytes, buffers, images }: Model): { buffers: string[]; images: string[] } {
  const named = urisOf(bytes);
  return { buffers: named.buffers.filter((uri) => !(uri in buffers)), images: named.images.filter((uri) => !(uri in images)) };
}

/** Of all its files, in bytes. */
export function sizeOf({ bytes, buffers, images, original }: Model): number {
  return [original ?? bytes, ...Object.values(buffers), ...Object.values(images)].reduce((sum, { length }) => sum + length, 0);
}

/** Whether it is the JSON text alone, whatever its name says: else it is a .glb, or the same under the name .vrm. */
export function isGltf({ bytes }: Model): boolean {
  return !isGlb(bytes);
}

/** Whether it is no model, but what was measured of one. By its name alone: nobody may hand in evidence that passes for a model. */
export function isEvidence({ name }: Pick<Model, "name">): boolean {
  return EVIDENCE.test(name);
}

function isGlb(bytes: Uint8Array): boolean {
  return bytes.length >= 4 && new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true) === GLB_MAGIC;
}

/** `chair.glb` and `marked.glb` make `chair.marked.glb`. */
export function renamed(name: string, ending: string): string {
  return name.replace(/\.[^.]*$/, "") + `.${ending}`;
}

/** The name of a copy: `chair.glb` and `marked` make `chair.marked.glb`, with the ending that is right for what it is. */
export function copyName(model: Model, what: string): string {
  const ending = isGltf(model) ? "gltf" : /\.vrm$/i.test(model.name) ? "vrm" : "glb";
  return renamed(model.name, `${what}.${ending}`);
}

/** The external URIs of a model. What is no JSON names none: the module will say what is wrong with it. */
function urisOf(bytes: Uint8Array): { buffers: string[]; images: string[] } {
  let root: unknown;
  try {
    root = JSON.parse(new TextDecoder().decode(isGlb(bytes) ? jsonChunk(bytes) : bytes));
  } catch {
    return { buffers: [], images: [] };
  }
  return { buffers: externalUris(root, "buffers"), images: externalUris(root, "images") };
}

/** The first chunk of a .glb: 12 bytes of header, its length, its kind, its content. */
function jsonChunk(bytes: Uint8Array): Uint8Array {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  return bytes.subarray(20, 20 + length);
}

function externalUris(root: unknown, key: "buffers" | "images"): string[] {
  const entries = (root as Record<string, unknown> | null)?.[key];
  return (Array.isArray(entries) ? entries : [])
    .map((entry: { uri?: unknown } | null) => entry?.uri)
    .filter((uri): uri is string => typeof uri === "string" && !uri.startsWith("data:"))
    .map(decoded);
}

/** A URI as a file's name; what is not well encoded stays as it is. */
export function decoded(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** By the path from the model's folder; else, for files dropped loose, by name alone where only one file has it. */
async function pick(uris: string[], files: NamedFile[], folder: string): Promise<Files> {
  const picked: Files = {};
  for (const uri of uris) {
    const path = folder + uri.replace(/^\.\//, "");
    const baseName = uri.slice(uri.lastIndexOf("/") + 1);
    const sameName = files.filter(({ file }) => file.name === baseName);
    const match = files.find((file) => file.path === path) ?? (sameName.length === 1 ? sameName[0] : undefined);
    if (match) {
      picked[uri] = new Uint8Array(await match.file.arrayBuffer());
    }
  }
  return picked;
}
