/** The worker behind the study: it loads the study's module with the first call. */
import load, * as study from "../../research-wasm/research.js";
import type { Ranking, StudyMesh } from "../../research-wasm/research.js";
import { answer } from "../remote";

// By their module: while it is still being built its stand-in has none of them.
const { errors, fields, hosts, parameters, prepare, rank, trace } = study;

export interface Ranked {
  /** Vertices, the most stable first. */
  order: Uint32Array;
  /** How long that took, in milliseconds, the way to this worker and back left out. */
  ms: number;
}

function timedRank(mesh: StudyMesh, ranking: Ranking): Ranked {
  const since = performance.now();
  const order = rank(mesh, ranking);
  return { order, ms: performance.now() - since };
}

answer({ parameters, prepare, rank: timedRank, fields, trace, hosts, errors }, () => (load as () => Promise<unknown>)());
