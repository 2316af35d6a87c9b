/** Where the key comes from: a name and a passphrase, or a key file. It is made for each use, and stored nowhere. */
import type { Client } from "meshmark/client";
import { find, setProblem } from "./dom";
import { save } from "./save";
import type { Progress } from "./task";

const KEY_BYTES = 32;

const root = find<HTMLFieldSetElement>("#key");
const owner = find<HTMLInputElement>("#owner");
const passphrase = find<HTMLInputElement>("#passphrase");
const keyFile = find<HTMLInputElement>("#key-file");
const state = find("#key-file-state");

/** The key of the file that was chosen, or made here. */
let fileKey: Uint8Array | undefined;

/** Makes the form ready; it stands in no view yet. `onChange` hears of every other key that it comes to name. */
export function startKeyForm(onChange: () => void): void {
  root.addEventListener("change", showSource);
  root.addEventListener("input", onChange);
  keyFile.addEventListener("change", () => void readKeyFile().then(onChange));
  find("#make-key-file").addEventListener("click", () => {
    makeKeyFile();
    onChange();
  });
  owner.addEventListener("input", () => setProblem(owner, null));
  passphrase.addEventListener("input", () => setProblem(passphrase, null));
  const show = find("#show-passphrase");
  show.addEventListener("click", () => {
    const visible = passphrase.type === "password";
    passphrase.type = visible ? "text" : "password";
    show.setAttribute("aria-pressed", String(visible));
    show.textContent = visible ? "Hide" : "Show";
  });
}

/** Moves the one key form into a view. */
export function placeKeyForm(view: Element): void {
  find("[data-key-slot]", view).append(root);
}

/** Whether there is all that a key is made from. */
export function isKeyComplete(): boolean {
  return source() === "file" ? fileKey !== undefined : owner.value.trim() !== "" && passphrase.value !== "";
}

/** The first field that is not filled in as it should be, told so; `null` where all are. */
export function incompleteKeyField(): HTMLElement | null {
  if (source() === "file") {
    setProblem(keyFile, fileKey ? null : "Choose your key file, or make one.");
    return fileKey ? null : keyFile;
  }
  setProblem(owner, owner.value.trim() ? null : "Whose mark is it? Give a name.");
  setProblem(passphrase, passphrase.value ? null : "Give the passphrase.");
  return [owner, passphrase].find((field) => field.getAttribute("aria-invalid") === "true") ?? null;
}

/** Makes the key's 32 bytes, the caller's to overwrite after use. */
export type KeyMaker = (client: Client, progress: Progress) => Promise<Uint8Array>;

/** Makes a key that nobody will have again. */
export const strangerKey: KeyMaker = async () => crypto.getRandomValues(new Uint8Array(KEY_BYTES));

/** Makes the key of what the fields say now, whatever they say later. */
export function keyMaker(): KeyMaker {
  if (source() === "file") {
    const key = fileKey!.slice();
    return async () => key;
  }
  const [name, secret] = [owner.value, passphrase.value];
  return (client, { signal, stage }) => {
    stage("key");
    return client.deriveKey(name, secret, { signal });
  };
}

function source(): string {
  return find<HTMLInputElement>('input[name="key-source"]:checked', root).value;
}

function showSource(): void {
  for (const part of root.querySelectorAll<HTMLElement>("[data-source]")) {
    part.hidden = part.dataset["source"] !== source();
  }
}

async function readKeyFile(): Promise<void> {
  const file = keyFile.files?.[0];
  fileKey = undefined;
  state.textContent = "";
  if (!file) {
    return;
  }
  if (file.size !== KEY_BYTES) {
    setProblem(keyFile, `A key file has exactly ${KEY_BYTES} bytes; this one has ${file.size}.`);
    return;
  }
  fileKey = new Uint8Array(await file.arrayBuffer());
  setProblem(keyFile, null);
  state.textContent = "This key file is in use.";
}

function makeKeyFile(): void {
  const key = crypto.getRandomValues(new Uint8Array(KEY_BYTES));
  save("meshmark.key", key);
  fileKey = key;
  keyFile.value = "";
  setProblem(keyFile, null);
  state.textContent = "A new key was saved as meshmark.key and is in use. Keep a copy where you will find it.";
}
