/** Finished copies that nobody has downloaded yet, kept by the browser through a reload. Where it keeps nothing, nothing is kept. */
import type { Copy } from "./copy";

const [DATABASE, COPIES] = ["meshmark", "copies"];

/** Says whether it is kept. */
export async function keep(copy: Copy): Promise<boolean> {
  return within("readwrite", (copies) => copies.put(copy)).then(
    () => true,
    () => false,
  );
}

export async function forget(id: string): Promise<void> {
  await within("readwrite", (copies) => copies.delete(id)).catch(() => {});
}

/** The oldest first. */
export async function kept(): Promise<Copy[]> {
  const copies = await within<Copy[]>("readonly", (copies) => copies.getAll()).catch(() => []);
  return copies.sort((a, b) => a.made.localeCompare(b.made));
}

async function within<T>(mode: IDBTransactionMode, ask: (copies: IDBObjectStore) => IDBRequest): Promise<T> {
  const database = await opened();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = database.transaction(COPIES, mode);
      const request = ask(transaction.objectStore(COPIES));
      transaction.oncomplete = () => resolve(request.result as T);
      transaction.onabort = () => reject(transaction.error);
    });
  } finally {
    database.close();
  }
}

function opened(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(DATABASE, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(COPIES, { keyPath: "id" });
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
