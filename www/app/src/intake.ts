/** The empty state's buttons: how a model comes in without being dropped. */
import { find, instantiate } from "./dom";
import type { NamedFile } from "./model";

export interface IntakeEvents {
  onFiles(files: NamedFile[]): void;
  onDemo(): void;
}

/** Puts the buttons at the end of `intake`. */
export function startIntake(intake: HTMLElement, events: IntakeEvents): void {
  intake.append(instantiate("#intake-actions"));
  for (const kind of ["files", "folder"]) {
    const input = find<HTMLInputElement>(`[data-input="${kind}"]`, intake);
    find(`[data-choose="${kind}"]`, intake).addEventListener("click", () => input.click());
    input.addEventListener("change", () => {
      const files = [...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
      input.value = ""; // so that the same file can be chosen again
      if (files.length > 0) {
        events.onFiles(files);
      }
    });
  }
  find('[data-choose="demo"]', intake).addEventListener("click", () => events.onDemo());
}
