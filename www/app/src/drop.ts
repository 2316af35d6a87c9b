/** Drop anywhere: files and whole folders, onto any part of the page. */
import { find } from "./dom";
import type { NamedFile } from "./model";

export function onDrop(receive: (files: NamedFile[]) => void): void {
  const veil = find(".drop-veil");
  const show = (event: DragEvent) => {
    event.preventDefault();
    veil.hidden = !event.dataTransfer?.types.includes("Files");
  };
  addEventListener("dragenter", show);
  addEventListener("dragover", show);
  addEventListener("dragleave", (event) => {
    veil.hidden ||= event.relatedTarget === null;
  });
  addEventListener("drop", async (event) => {
    event.preventDefault();
    veil.hidden = true;
    const files = event.dataTransfer ? await filesOf(event.dataTransfer) : [];
    if (files.length > 0) {
      receive(files);
    }
  });
}

async function filesOf(transfer: DataTransfer): Promise<NamedFile[]> {
  // All entries first: the transfer is empty after the first wait.
  const entries = [...transfer.items].flatMap((item) => item.webkitGetAsEntry() ?? []);
  return (await Promise.all(entries.map(walk))).flat();
}

async function walk(entry: FileSystemEntry): Promise<NamedFile[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ path: entry.fullPath.replace(/^\//, ""), file }];
  }
  const files: NamedFile[] = [];
  for await (const child of children(entry as FileSystemDirectoryEntry)) {
    files.push(...(await walk(child)));
  }
  return files;
}

/** A directory is read in batches, the last of which is empty. */
async function* children(directory: FileSystemDirectoryEntry): AsyncGenerator<FileSystemEntry> {
  const reader = directory.createReader();
  for (;;) {
    const batch = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (batch.length === 0) {
      return;
    }
    yield* batch;
  }
}
