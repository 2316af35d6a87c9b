import { deriveKey, demoModel, detect, embed, init } from "meshmark";

await init();
const key = deriveKey("Test Owner", "a passphrase for tests only");
const { model } = embed(demoModel(), "BUNDLED", key);
const { verdict, tag } = detect(model, key);
console.log(verdict, tag);
