/** The worker behind the attacks: it loads their module with the first call. */
import load, { attack, catalogue, quality } from "../../attacks-wasm/attacks.js";
import { answer } from "../remote";

answer({ catalogue, attack, quality }, () => (load as () => Promise<unknown>)());
