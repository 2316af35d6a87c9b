/** The study's module, in a worker of its own. Calls come back in the order in which they were made. */
import type { Errors, ErrorsOptions, Fields, HostsOptions, HostsRow, Parameters, Preparation, Prepared, PrepareOptions, Ranking, StudyMesh, TraceOptions, Tracing } from "../../research-wasm/research.js";
import { Remote, type CallOptions } from "../remote";
import type { Ranked } from "./worker";

const remote = new Remote(() => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));

export function parameters(options?: CallOptions): Promise<Parameters> {
  return remote.call("parameters", [], options);
}

export function prepare(model: Uint8Array, preparation: Preparation, options?: PrepareOptions & CallOptions): Promise<Prepared> {
  return remote.call("prepare", [model, preparation], options);
}

export function rank(mesh: StudyMesh, ranking: Ranking, options?: CallOptions): Promise<Ranked> {
  return remote.call("rank", [mesh, ranking], options);
}

export function fields(mesh: StudyMesh, ranking: Ranking, options?: CallOptions): Promise<Fields> {
  return remote.call("fields", [mesh, ranking], options);
}

export function trace(mesh: StudyMesh, options: TraceOptions & CallOptions): Promise<Tracing> {
  return remote.call("trace", [mesh], options);
}

export function hosts(mesh: StudyMesh, options: HostsOptions & CallOptions): Promise<HostsRow> {
  return remote.call("hosts", [mesh], options);
}

export function errors(mesh: StudyMesh, options: ErrorsOptions & CallOptions): Promise<Errors[]> {
  return remote.call("errors", [mesh], options);
}
