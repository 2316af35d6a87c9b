/** What this package throws, and what its promises reject with. */
export class MeshmarkError extends Error {
  override readonly name = "MeshmarkError";

  /**
   * @param code stable, for programs: `document.truncated`, `aborted`, ...
   * @param message for people
   * @param path for documents, a JSON pointer to the offending value; else `null`
   */
  constructor(
    readonly code: string,
    message: string,
    readonly path: string | null = null,
    options?: ErrorOptions,
  ) {
    super(message, options);
  }
}

/**
 * What a caller should see of something the module threw: its plain `{code, message, path}` as a `MeshmarkError`, a trap
 * or an exhausted memory as code `internal`, anything else (a mistake of the caller's) as it is.
 */
export function asMeshmarkError(thrown: unknown): unknown {
  if (thrown instanceof WebAssembly.RuntimeError || thrown instanceof RangeError) {
    return new MeshmarkError("internal", `The module stopped: ${thrown.message}`, null, { cause: thrown });
  }
  if (isErrorObject(thrown)) {
    return new MeshmarkError(thrown.code, thrown.message, thrown.path ?? null);
  }
  return thrown;
}

function isErrorObject(value: unknown): value is { code: string; message: string; path?: string | null } {
  return (
    typeof value === "object" &&
    value !== null &&
    !(value instanceof Error) &&
    typeof (value as { code?: unknown }).code === "string" &&
    typeof (value as { message?: unknown }).message === "string"
  );
}
