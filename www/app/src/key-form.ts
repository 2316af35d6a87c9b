/** Where the key comes from: a name and a passphrase, or a key file. It is made for each use, and stored nowhere. */
import type { Client } from "meshmark/client";
import { find, setProblem } from "./dom";
import { save } from "./save";
import type { Progress } from "./task";

const KEY_BYTES = 32;
/** A list of keys is not longer. */
const MOST_LIST_BYTES = 1e6;
const DIFFERENT = "The two passphrases differ.";

const root = find<HTMLFieldSetElement>("#key");
const owner = find<HTMLInputElement>("#owner");
const passphrase = find<HTMLInputElement>("#passphrase");
const again = find<HTMLInputElement>("#passphrase-again");
const strength = find("#passphrase-strength");
const work = find<HTMLInputElement>("#work");
const keyFile = find<HTMLInputElement>("#key-file");
const state = find("#key-file-state");

/** The keys of the files that were chosen, or the one that was made here. */
let fileKeys: NamedKey[] = [];
/** Whether a passphrase is chosen here, not one that exists: a slip would make a key that nobody has. */
let isNew = false;
/** Whether several keys can be used here at once. */
let areSeveral = false;

/** Makes the key's 32 bytes, the caller's to overwrite after use. */
export type KeyMaker = (client: Client, progress: Progress) => Promise<Uint8Array>;

/** A key as the fields said it at one time. */
export interface KeySource {
  /** Whose it is; `null` where a key file says no name. */
  owner: string | null;
  /** The title of the work whose key it is; `null` where the owner's works share one. */
  work: string | null;
  make: KeyMaker;
  /** Whether the fields say it still. */
  isInForm(): boolean;
}

/** A key of a file, or of a line in a list of keys. */
export interface NamedKey {
  name: string;
  bytes: Uint8Array;
}

/** Makes the form ready; it stands in no view yet. `onChange` hears of every other key that it comes to name. */
export function startKeyForm(onChange: () => void): void {
  root.addEventListener("change", () => {
    showFields();
    onChange();
  });
  root.addEventListener("input", () => {
    void rate();
    onChange();
  });
  keyFile.addEventListener("change", () => void readKeyFile().then(onChange));
  find("#make-key-file").addEventListener("click", () => {
    makeKeyFile();
    onChange();
  });
  owner.addEventListener("input", () => setProblem(owner, null));
  for (const field of [passphrase, again]) {
    field.addEventListener("input", () => {
      setProblem(passphrase, null);
      setProblem(again, isSlip() && again.value.length >= passphrase.value.length ? DIFFERENT : null);
    });
  }
  const show = find("#show-passphrase");
  show.addEventListener("click", () => {
    const visible = passphrase.type === "password";
    passphrase.type = visible ? "text" : "password";
    show.setAttribute("aria-pressed", String(visible));
    show.textContent = visible ? "Hide" : "Show";
    showFields();
    onChange();
  });
}

/**
 * Moves the one key form into a view.
 *
 * @param use whether keys are chosen there, not only used, and whether there can be several
 */
export function placeKeyForm(view: Element, use: { isNew: boolean; areSeveral: boolean }): void {
  ({ isNew, areSeveral } = use);
  keyFile.multiple = areSeveral;
  find("#several-keys-hint").hidden = !areSeveral;
  find("[data-key-slot]", view).append(root);
  showFields();
  void rate();
}

/** Whether there is all that a key is made from. */
export function isKeyComplete(): boolean {
  return source() === "file" ? fileKeys.length === 1 : owner.value.trim() !== "" && passphrase.value !== "" && !isSlip();
}

/** The first field that is not filled in as it should be, told so; `null` where all are. */
export function incompleteKeyField(): HTMLElement | null {
  if (source() === "file") {
    const isRight = fileKeys.length === 1 || (areSeveral && fileKeys.length > 1);
    setProblem(keyFile, isRight ? null : fileKeys.length > 1 ? "Several keys are for Check: choose one key file." : "Choose your key file, or make one.");
    return isRight ? null : keyFile;
  }
  setProblem(owner, owner.value.trim() ? null : "Whose mark is it? Give a name.");
  setProblem(passphrase, passphrase.value ? null : "Give the passphrase.");
  setProblem(again, passphrase.value && isSlip() ? (again.value ? DIFFERENT : "Type it once more, or show it above: a slip would make a key that you do not have.") : null);
  return [owner, passphrase, again].find((field) => field.getAttribute("aria-invalid") === "true") ?? null;
}

/** Makes a key that nobody will have again. */
export const strangerKey: KeyMaker = async () => crypto.getRandomValues(new Uint8Array(KEY_BYTES));

/** The key of what the fields say now, whatever they say later. */
export function keySource(): KeySource {
  const of = ownersKey();
  const title = work.value.trim();
  const isInForm = () => of.isInForm() && work.value.trim() === title;
  return title === "" ? { ...of, work: null, isInForm } : { ...of, work: title, make: workKey(of.make, title), isInForm };
}

function ownersKey(): Omit<KeySource, "work"> {
  if (source() === "file") {
    const key = fileKeys[0]!.bytes;
    return { owner: null, make: async () => key.slice(), isInForm: () => source() === "file" && fileKeys.length === 1 && isSame(fileKeys[0]!.bytes, key) };
  }
  const [name, secret] = [owner.value, passphrase.value];
  return {
    owner: name,
    make: (client, { signal, stage }) => {
      stage("key");
      return client.deriveKey(name, secret, { signal });
    },
    isInForm: () => source() === "passphrase" && owner.value.trim() === name.trim() && passphrase.value === secret,
  };
}

function workKey(make: KeyMaker, title: string): KeyMaker {
  return async (client, progress) => {
    const owners = await make(client, progress);
    try {
      return await client.workKey(owners, title, { signal: progress.signal });
    } finally {
      owners.fill(0);
    }
  };
}

/** The keys of the files, where they are several. */
export function severalKeys(): NamedKey[] {
  return source() === "file" && fileKeys.length > 1 ? fileKeys : [];
}

function source(): string {
  return find<HTMLInputElement>('input[name="key-source"]:checked', root).value;
}

/** Whether a new passphrase that is not to be seen was not typed twice alike. */
function isSlip(): boolean {
  return isNew && passphrase.type === "password" && again.value !== passphrase.value;
}

function showFields(): void {
  for (const part of root.querySelectorAll<HTMLElement>("[data-source]")) {
    part.hidden = part.dataset["source"] !== source();
  }
  find("#again-field").hidden = !isNew || passphrase.type !== "password";
}

/** Says how long a new passphrase would stand. */
async function rate(): Promise<void> {
  const [name, secret] = [owner.value, passphrase.value];
  if (!isNew || secret === "") {
    strength.textContent = "";
    return;
  }
  const { strengthWords } = await import("./passphrase").catch(() => ({ strengthWords: () => ({ words: "", isWeak: false }) })); // an estimate is not worth an error
  if (name === owner.value && secret === passphrase.value) {
    const { words, isWeak } = strengthWords(secret, name);
    strength.textContent = words;
    strength.toggleAttribute("data-weak", isWeak);
  }
}

async function readKeyFile(): Promise<void> {
  const files = [...(keyFile.files ?? [])];
  const keys: NamedKey[] = [];
  let problem: string | null = null;
  for (const file of files) {
    const found = file.size === KEY_BYTES ? [{ name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) }] : areSeveral && file.size < MOST_LIST_BYTES ? keysInList(await file.text()) : [];
    keys.push(...found);
    if (found.length === 0) {
      problem = `A key file has exactly ${KEY_BYTES} bytes; this one has ${file.size}.`;
    }
  }
  fileKeys = problem === null ? keys : [];
  setProblem(keyFile, problem);
  state.textContent = fileKeys.length === 0 ? "" : fileKeys.length === 1 ? "This key file is in use." : `${fileKeys.length} keys are in use.`;
}

/** Keys as the command line takes them: in each line 64 hexadecimal digits and a name; none where a line is something else. */
function keysInList(text: string): NamedKey[] {
  const lines = [...text.split("\n").entries()].map(([i, line]) => ({ line: line.trim(), number: i + 1 })).filter(({ line }) => line !== "" && !line.startsWith("#"));
  const keys = lines.map(({ line, number }) => {
    const [, digits, name] = /^([0-9a-f]{64})(?:\s+(.*))?$/i.exec(line) ?? [];
    return digits ? [{ name: name ?? `line ${number}`, bytes: Uint8Array.from({ length: KEY_BYTES }, (_, i) => parseInt(digits.slice(2 * i, 2 * i + 2), 16)) }] : [];
  });
  return keys.every((found) => found.length === 1) ? keys.flat() : [];
}

function makeKeyFile(): void {
  const key = crypto.getRandomValues(new Uint8Array(KEY_BYTES));
  save("meshmark.key", key);
  fileKeys = [{ name: "meshmark.key", bytes: key }];
  keyFile.value = "";
  setProblem(keyFile, null);
  state.textContent = "A new key was saved as meshmark.key and is in use. Keep a copy where you will find it.";
}

function isSame(a: Uint8Array, b: Uint8Array): boolean {
  return a.every((byte, i) => byte === b[i]);
}
