/** A finished copy in words and figures, and what can be done with it. */
import { downloads, reportOf, whose, type Copy } from "./copy";
import { button, h } from "./dom";
import { renamed } from "./model";
import { actions, card, carrierTable, details, displacement, forecastList, numbers, readingRows, type Row } from "./outcome";
import { saveJson } from "./save";
import { CARRIERS, holders, isMark, losses, plain, significant } from "./words";

export interface CopyEvents {
  /** A file of the copy is wanted. */
  onSave(name: string): void;
  onCheck(): void;
  onDismiss(): void;
  /** What takes the key and the original; a copy from before a reload is without. */
  ofThisVisit?: { onSaveKey(): void; onBreak(): void; onStronger(): void };
}

export function copyCard(copy: Copy, { onSave, onCheck, onDismiss, ofThisVisit }: CopyEvents): HTMLElement {
  const { marked, report, owner, work, asked } = copy;
  const { readBack } = report;
  const holds = isMark(readBack);
  const small = report.number === null ? [`The model is too small to hold the tag ${asked.tag}: its mark says whose it is, and no more.`] : [];
  const lost = holds ? losses(report.forecast) : null;
  const stronger = ofThisVisit && asked.strength !== "strong" ? [actions(button(`Mark again, ${asked.strength === "subtle" ? "balanced" : "strong"}`, ofThisVisit.onStronger))] : [];
  const earlier = ofThisVisit ? [] : [`Made ${new Date(copy.made).toLocaleString()}, and not downloaded since. This browser keeps it until you download or dismiss it.`];
  return card(
    readBack.verdict,
    holds ? "Your mark is in the copy" : "The mark does not hold in this model",
    [holds ? `${marked.name} carries ${whose(copy)}: it was read back from the finished file.` : `${marked.name}: ${plain(readBack.reason ?? readBack.sentence)}`, ...small, ...earlier],
    ...(lost === null ? [] : [h("p", { class: "sentence warning" }, lost), ...stronger]),
    actions(...downloads(copy).map((name) => button(`Download ${name}`, () => onSave(name), "primary"))),
    forecastList(report.forecast),
    numbers([
      ...readingRows(readBack),
      ["Owner", owner ?? "a key file"],
      ...rowsOf(work),
      ["Read from", holders(readBack).map((name) => CARRIERS[name].name).join(", "), "Where the mark lives in this copy: in its shape, or in how its vertices are connected."],
    ]),
    displacement(report),
    details(
      "Carriers and files",
      carrierTable(readBack.carriers),
      numbers([
        ["Diagonal", `${significant(report.diagonal)} units`, "Of the box around the model, in the units of its file."],
        ["Tag as a number", report.number === null ? "none" : String(report.number)],
        ["SHA-256 of the original", h("code", { class: "hash" }, report.hostSha256)],
        ["SHA-256 of the copy", h("code", { class: "hash" }, report.markedSha256)],
      ]),
    ),
    h("h3", {}, "To keep beside the original"),
    h("p", { class: "hint" }, "Keep the original to yourself, with the report and the key: together they show later what you marked, when, and how. Whoever has the key file has the key."),
    ...(work ? [h("p", { class: "hint" }, "The key file that is saved here is this work’s: use it without a title.")] : []),
    actions(
      button("Save report (JSON)", async () => saveJson(renamed(marked.name, "report.json"), await reportOf(copy))),
      ...(ofThisVisit ? [button("Save key file", ofThisVisit.onSaveKey)] : []),
    ),
    actions(button("Check this copy", onCheck), ...(holds && ofThisVisit ? [button("Try to break it", ofThisVisit.onBreak)] : []), button("Dismiss", onDismiss)),
  );
}

function rowsOf(work: string | null): Row[] {
  return work ? [["Title of the work", work, "Checking a copy needs it, as it is written here."]] : [];
}
