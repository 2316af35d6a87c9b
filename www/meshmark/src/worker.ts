/** The worker behind `createClient`: a real file, so that it runs under a strict Content-Security-Policy. */
import { capacity, deriveKey, demoModel, detect, embed, extract, extractMany, init, inspect, measure, verify, version } from "./index.js";
import { answer } from "./remote.js";

answer({ capacity, deriveKey, embed, measure, extract, extractMany, verify, detect, inspect, demoModel, version }, init);
