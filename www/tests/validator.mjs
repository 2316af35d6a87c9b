// Khronos's judge of glTF files.
import validator from "gltf-validator";

/** Errors that Khronos's validator finds, as `CODE pointer`. */
export async function validationErrors(model, files = {}) {
  const report = await validator.validateBytes(model, {
    externalResourceFunction: (uri) =>
      files[decodeURIComponent(uri)] ? Promise.resolve(files[decodeURIComponent(uri)]) : Promise.reject(`no file ${uri}`),
  });
  return report.issues.messages.filter(({ severity }) => severity === 0).map(({ code, pointer }) => `${code} ${pointer}`);
}
