/** Results in words first, then numbers, then details. */
import type { CarrierReading, DetailedExtraction, EmbedReport, Forecast, Verdict } from "meshmark";
import { announce, h } from "./dom";
import { attackWords, CARRIERS, count, LEVELS, odds, percent, problem, significant } from "./words";

/** A result card: a headline, sentences, and whatever follows. */
export function card(verdict: Verdict | "error", headline: string | Node[], sentences: string[], ...rest: Node[]): HTMLElement {
  const said = sentences.map((sentence) => h("p", { class: "sentence" }, sentence));
  return h("section", { class: "card result", "data-verdict": verdict, "aria-label": "Result" }, h("h2", {}, ...[headline].flat()), ...said, ...rest);
}

/** What could not be done, and why; the code is for whoever reports it. */
export function errorCard(what: "Cannot mark" | "Cannot check" | "Cannot attack" | "Cannot study" | "Cannot open" | "Cannot start", error: unknown): HTMLElement {
  const { text, code, path } = problem(error);
  const place = path ? [", at ", h("code", {}, path)] : [];
  const headline = [h("strong", {}, what), document.createTextNode(`: ${text}.`)];
  return card("error", headline, [], h("p", { class: "code" }, "Code ", h("code", {}, code), ...place));
}

/** Something to know that is no result. */
export function note(text: string): HTMLElement {
  return h("p", { class: "card note" }, text);
}

/** Puts a card where the view's results stand, and says its headline and sentences to screen readers. */
export function present(outcome: HTMLElement, card: HTMLElement): void {
  outcome.replaceChildren(card);
  const said = card.matches(".note") ? [card] : [...card.querySelectorAll("h2, .sentence")];
  announce(said.map((element) => element.textContent).join(" "));
}

/** Rows of a term and what belongs to it. */
export function numbers(rows: [term: string, value: Node | string][]): HTMLElement {
  return h("dl", { class: "numbers" }, ...rows.map(([term, value]) => h("div", {}, h("dt", {}, term), h("dd", {}, value))));
}

/** "at most 1 in 10^24", for people. */
export function chance(lnP: number): HTMLElement {
  return h("span", {}, "at most ", oddsOf(lnP));
}

/** "1 in 10^24". */
export function oddsOf(lnP: number): HTMLElement {
  const [text, exponent] = odds(lnP);
  return h("span", {}, text, ...(exponent ? [h("sup", {}, exponent)] : []));
}

/** What a blind reading says, as rows of `numbers`. */
export function readingRows(reading: DetailedExtraction): [string, Node | string][] {
  return [
    ["Tag", reading.tag === null ? "none read" : h("code", {}, reading.tag)],
    ["Chance of this without the key", chance(reading.lnP)],
    ["Agreement", `${Math.round(reading.agreement * 100)} %`],
  ];
}

/** How far vertices move: against the model's size, which says what is seen, and in its own units. */
export function displacement({ rmsRel, maxRel, diagonal, movedVertices, vertices }: EmbedReport): HTMLElement {
  const both = (rel: number) => h("span", { class: "both" }, h("span", {}, `${percent(rel)} of the diagonal`), h("span", {}, `${significant(rel * diagonal)} units`));
  return h(
    "section",
    { class: "displacement", "aria-label": "How far vertices move" },
    h("h3", {}, "How far vertices move"),
    numbers([
      ["RMS", both(rmsRel)],
      ["Largest", both(maxRel)],
      ["Moved", `${count(movedVertices)} of ${count(vertices)}`],
    ]),
  );
}

/** What was tried on the marked copy, one a row, and what came of it: in words and by a sign, never by colour alone. */
export function forecastList(forecast: Forecast[]): HTMLElement {
  const row = ({ attack, level }: Forecast) => {
    const words = attackWords(attack);
    return h("li", { "data-level": level }, h("span", {}, words.charAt(0).toUpperCase() + words.slice(1)), h("span", { class: "level" }, LEVELS[level]));
  };
  return h(
    "section",
    { class: "forecast", "aria-label": "What the mark survives" },
    h("h3", {}, "What the mark survives"),
    h("p", { class: "hint" }, "Each change was made to the marked copy, and the mark looked for in what was left. “Barely” may fail next time."),
    h("ul", {}, ...forecast.map(row)),
  );
}

/** The carriers, one a row, and what each survives. */
export function carrierTable(carriers: CarrierReading[]): HTMLElement {
  const row = (carrier: CarrierReading) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, CARRIERS[carrier.name].name),
      h("td", {}, carrier.tag ?? "–"),
      h("td", {}, oddsOf(carrier.lnP)),
      h("td", {}, `${Math.round(carrier.agreement * 100)} %`),
      h("td", {}, `${count(carrier.ownedAddresses)} of ${count(carrier.addresses)}`),
    );
  const heads = ["Carrier", "Tag", "Chance at most", "Agrees", "Places"].map((text) => h("th", { scope: "col" }, text));
  const table = h("table", {}, h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, ...carriers.map(row)));
  const hints = carriers.map(({ name }) => h("p", { class: "hint" }, h("strong", {}, CARRIERS[name].name), `: ${CARRIERS[name].survives}`));
  return h("div", { class: "carriers" }, h("div", { class: "scroll" }, table), ...hints);
}

export function details(summary: string, ...content: Node[]): HTMLElement {
  return h("details", {}, h("summary", {}, summary), ...content);
}

export function actions(...buttons: Node[]): HTMLElement {
  return h("div", { class: "actions" }, ...buttons);
}
