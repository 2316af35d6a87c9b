/** The worker behind the attacks: it loads their module with the first call. */
import load, * as attacks from "../../research-wasm/research.js";
import { answer } from "../remote";

// By their module: while it is still being built its stand-in has none of them.
const { catalogue, attack, quality } = attacks;

answer({ catalogue, attack, quality }, () => (load as () => Promise<unknown>)());
