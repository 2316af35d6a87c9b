/** Archives, unpacked where they were dropped: what is in them is as if it had been dropped itself. */
import type { NamedFile } from "./model";

/** The most bytes that an archive may unfold to: a small one could ask for all the memory there is. */
const MOST_BYTES = 2 ** 30;

const ZIP = /\.zip$/i;

/** @throws in words, where an archive is too large or damaged */
export async function unpacked(files: NamedFile[]): Promise<NamedFile[]> {
  return (await Promise.all(files.map((named) => (ZIP.test(named.file.name) ? entriesOf(named) : [named])))).flat();
}

async function entriesOf({ path, file }: NamedFile): Promise<NamedFile[]> {
  const { unzipSync } = await import("fflate");
  let left = MOST_BYTES;
  const filter = ({ originalSize }: { originalSize: number }) => {
    left -= originalSize;
    if (left < 0) {
      throw new Error(`“${file.name}” unfolds to more than 1 GiB. Unpack it, and drop the model that is in it.`);
    }
    return true;
  };
  const bytes = new Uint8Array(await file.arrayBuffer());
  let entries: Record<string, Uint8Array>;
  try {
    entries = unzipSync(bytes, { filter });
  } catch (error) {
    throw left < 0 ? error : new Error(`“${file.name}” cannot be unpacked: ${(error as Error).message}.`);
  }
  const folder = path.replace(ZIP, "/");
  return Object.entries(entries)
    .filter(([name]) => !name.endsWith("/") && !name.startsWith("__MACOSX/"))
    .map(([name, content]) => ({ path: folder + name, file: new File([content as BlobPart], name.slice(name.lastIndexOf("/") + 1)) }));
}
