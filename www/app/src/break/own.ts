/** The result of a person's own tool: dropped anywhere, or chosen here. */
import { button, h } from "../dom";
import type { NamedFile } from "../model";

export function ownTool(receive: (files: NamedFile[]) => void): HTMLElement {
  const input = h("input", { type: "file", id: "own-files", multiple: "", accept: ".glb,.gltf,.bin,model/gltf-binary,model/gltf+json,image/*", hidden: "" });
  input.addEventListener("change", () => {
    const files = [...(input.files ?? [])].map((file) => ({ path: file.name, file }));
    input.value = ""; // so that the same file can be chosen again
    receive(files);
  });
  const words = h("p", { class: "hint" }, "Do what you like to the marked model with a tool of your own, and drop the result here: one more row.");
  return h("div", { class: "own" }, words, button("Choose its result", () => input.click()), input);
}
