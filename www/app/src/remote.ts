/**
 * Modules in workers, as the package has its own. From a file that the package does not export: an export is kept for years, and no
 * page but this one needs it.
 */
export { answer, Remote, type CallOptions } from "../../meshmark/dist/remote.js";
