// What each of these pages does with the package.
import { createClient } from "meshmark/client";

/** Marks the demo model and reads the mark back, in the worker; gives `found BUNDLED`, or the error. */
export async function markAndFind(options) {
  try {
    const client = await createClient(options);
    const key = await client.deriveKey("Test Owner", "a passphrase for tests only");
    const { model } = await client.embed(await client.demoModel(), "BUNDLED", key);
    const { verdict, tag } = await client.detect(model, key);
    client.dispose();
    return `${verdict} ${tag}`;
  } catch (error) {
    return String(error);
  }
}
