/** A model as the person handed it in: one main file, and the files that a .gltf names. */
import type { Files } from "meshmark";

export interface Model {
  /** The main file's name, without folders. */
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
  /** By URI, percent-decoded: what the geometry is read from, and what is only looked at. */
  buffers: Files;
  images: Files;
}

export interface NamedFile {
  /** With folders, `/` between them. */
  path: string;
  file: File;
}

/** Finds the one model among some files, and beside it the files it names. */
export async function modelFrom(files: NamedFile[]): Promise<Model> {
  const mains = files.filter(({ path }) => /\.(glb|gltf)$/i.test(path));
  const [main] = mains;
  if (!main) {
    throw new Error("There is no .glb or .gltf file in this.");
  }
  if (mains.length > 1) {
    throw new Error(`There are ${mains.length} models in this; drop one of them, with its own files.`);
  }
  const bytes = new Uint8Array(await main.file.arrayBuffer());
  const model: Model = { name: main.file.name, bytes, buffers: {}, images: {} };
  if (/\.gltf$/i.test(main.path)) {
    const folder = main.path.slice(0, main.path.lastIndexOf("/") + 1);
    const named = urisOf(bytes);
    model.buffers = await pick(named.buffers, files, folder);
    model.images = await pick(named.images, files, folder);
  }
  return model;
}

export function isGltf(model: Model): boolean {
  return /\.gltf$/i.test(model.name);
}

/** `chair.glb` and `marked.glb` make `chair.marked.glb`. */
export function renamed(name: string, ending: string): string {
  return name.replace(/\.[^.]*$/, "") + `.${ending}`;
}

/** The external URIs of a .gltf. What is no JSON names none: the module will say what is wrong with it. */
function urisOf(bytes: Uint8Array): { buffers: string[]; images: string[] } {
  let root: unknown;
  try {
    root = JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    return { buffers: [], images: [] };
  }
  return { buffers: externalUris(root, "buffers"), images: externalUris(root, "images") };
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
