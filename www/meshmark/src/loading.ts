/** How a WebAssembly module is loaded, in a browser and in Node. */

/** Where a module can come from: an address, a response, its bytes, or the compiled module. */
export type InitInput = string | URL | Request | Response | BufferSource | WebAssembly.Module;

/** What wasm-bindgen exports beside the functions that the types declare. */
export interface Loadable {
  default(options: { module_or_path: InitInput }): Promise<unknown>;
}

export async function load(module: Loadable, input: InitInput): Promise<void> {
  await module.default({ module_or_path: isFileUrl(input) ? await readFile(input) : input });
}

function isFileUrl(input: InitInput): input is string | URL {
  return (typeof input === "string" || input instanceof URL) && String(input).startsWith("file:");
}

/** Node's `fetch` knows no `file:` URLs. Asked for by name at run time, so that bundlers for browsers see no import. */
async function readFile(url: string | URL): Promise<BufferSource> {
  const { process } = globalThis as unknown as {
    process: { getBuiltinModule(id: "node:fs/promises"): { readFile(url: URL): Promise<Uint8Array<ArrayBuffer>> } };
  };
  return process.getBuiltinModule("node:fs/promises").readFile(new URL(url));
}
