/** Results in words first, then numbers, then details. */
import type { CarrierReading, DetailedExtraction, EmbedReport, Forecast, Verdict } from "meshmark";
import { announce, find, h } from "./dom";
import { attackWords, CARRIERS, count, LEVELS, odds, percent, problem, significant } from "./words";

/** A result card: a headline, sentences, and whatever follows. */
export function card(verdict: Verdict | "error", headline: string | Node[], sentences: string[], ...rest: Node[]): HTMLElement {
  const said = sentences.map((sentence) => h("p", { class: "sentence" }, sentence));
  const flag = h("p", { class: "sentence flag", role: "status" });
  return h("section", { class: "card result", "data-verdict": verdict, "aria-label": "Result" }, h("h2", {}, ...[headline].flat()), flag, ...said, ...rest);
}

/** Says of a result what the form says now that is not what it was made with; nothing where all is the same. */
export function flag(card: HTMLElement, others: string[], then: string): void {
  const words = others.length === 0 ? "" : `The form says something else now: ${new Intl.ListFormat("en").format(others)}. ${then}`;
  const flag = find(".flag", card);
  if (flag.textContent !== words) {
    flag.textContent = words;
    card.toggleAttribute("data-other", words !== "");
  }
}

/** What could not be done, and why; the code is for whoever reports it. */
export function errorCard(what: "Cannot mark" | "Cannot check" | "Cannot attack" | "Cannot study" | "Cannot open" | "Cannot start", error: unknown): HTMLElement {
  const { text, code, path } = problem(error);
  const place = path ? [", at ", h("code", {}, path)] : [];
  const headline = [h("strong", {}, what), document.createTextNode(`: ${text}.`)];
  return card("error", headline, [], ...(code === null ? [] : [h("p", { class: "code" }, "Code ", h("code", {}, code), ...place)]));
}

/** Something to know that is no result. */
export function note(text: string): HTMLElement {
  return h("p", { class: "card note" }, text);
}

/**
 * Where a view says what comes of its work: what goes on, below it what is to be known, below that what was finished. None takes
 * the place of another: an error leaves a result where it is.
 */
export class Outcome {
  readonly #work = h("div", { class: "slot" });
  readonly #notice = h("div", { class: "slot" });
  readonly #finished = h("div", { class: "slot" });

  constructor(readonly root: HTMLElement) {
    root.append(this.#work, this.#notice, this.#finished);
  }

  /** Something goes on, until the card is removed. */
  work(card: HTMLElement): void {
    this.#work.replaceChildren(card);
    this.#reveal(card);
  }

  /** Says something beside what is finished, in place of what was said last; nothing takes that back. */
  tell(...cards: HTMLElement[]): void {
    this.#notice.replaceChildren(...cards);
    for (const card of cards) {
      announceCard(card);
      card.scrollIntoView({ block: "nearest" });
    }
  }

  /** Shows what is finished, in place of what was. */
  finish(...cards: HTMLElement[]): void {
    if (cards.length !== this.#finished.children.length || cards.some((card, i) => card !== this.#finished.children[i])) {
      this.#finished.replaceChildren(...cards); // what stays where it is keeps the focus
    }
  }

  /** Brings the start of a card in here to the eye, its headline to whoever listens. */
  present(card: HTMLElement): void {
    this.#reveal(card);
    announceCard(card);
  }

  /** Scrolls to the start of a card and puts the focus on its headline, unless a person has it elsewhere on purpose. */
  #reveal(card: HTMLElement): void {
    const headline = find("h2", card);
    const focused = document.activeElement;
    if (!focused || focused === document.body || focused.matches(":disabled, [type=submit]") || this.root.contains(focused)) {
      headline.tabIndex = -1;
      headline.focus({ preventScroll: true });
    }
    card.scrollIntoView({ block: "start" });
  }
}

/** Says a card's headline and sentences to screen readers. */
function announceCard(card: HTMLElement): void {
  const said = card.matches(".note") ? [card] : [...card.querySelectorAll("h2, .sentence")];
  announce(said.map((element) => element.textContent).join(" "));
}

/** A term, what belongs to it, and where the term says too little, what it means. */
export type Row = [term: string, value: Node | string, meaning?: string];

export function numbers(rows: Row[]): HTMLElement {
  const row = ([term, value, meaning]: Row) => h("div", {}, h("dt", {}, term), h("dd", {}, value), ...(meaning ? [h("dd", { class: "hint" }, meaning)] : []));
  return h("dl", { class: "numbers" }, ...rows.map(row));
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
export function readingRows(reading: DetailedExtraction): Row[] {
  const isInPiece = reading.carriers.some(({ piece }) => piece !== null);
  const where = reading.foundIn ? `${reading.foundIn.name ?? "a piece without a name"}, ${count(reading.foundIn.parts)} of ${count(reading.foundIn.ofParts)} parts` : "a piece of the model";
  const agreement: Row = ["Agreement", `${Math.round(reading.agreement * 100)} %`, "How well what was read fits that tag: 100 % is perfect, 0 % is chance."];
  const piece: Row = ["Found in", where, "Read alone, whatever stands beside it."];
  return [
    ["Tag", reading.tag === null ? "none read" : h("code", {}, reading.tag)],
    ...(isInPiece ? [piece] : []),
    ["Chance of this without the key", chance(reading.lnP)],
    ...(reading.verdict === "present" ? [] : [agreement]),
  ];
}

/** How far vertices move: against the model's size, which says what is seen, and in its own units. */
export function displacement({ rmsRel, maxRel, diagonal, movedVertices, vertices, worstPartRel, worstTurnDegrees, warnings }: EmbedReport): HTMLElement {
  const both = (rel: number) => h("span", { class: "both" }, h("span", {}, `${percent(rel)} of its size`), h("span", {}, `${significant(rel * diagonal)} units`));
  return h(
    "section",
    { class: "displacement", "aria-label": "How far vertices move" },
    h("h3", {}, "How far vertices move"),
    numbers([
      ["On average", both(rmsRel)],
      ["At most", both(maxRel)],
      ["Moved", `${count(movedVertices)} of ${count(vertices)}`],
      ["Bent part", `at most ${percent(worstPartRel)} of its own size`, "A part is what hangs together: a wheel, a leaf."],
      ["Turned triangle", `at most ${significant(worstTurnDegrees)}°`],
    ]),
    ...warnings.map((warning) => h("p", { class: "sentence warning" }, `${warning.charAt(0).toUpperCase()}${warning.slice(1)}.`)),
    h("p", { class: "hint" }, "The size is the diagonal of the box around the model, a unit the one of its file; the average is the root of the mean square."),
  );
}

/** What was tried on the marked copy, one a row, and what came of it: in words and by a sign, never by colour alone. */
export function forecastList(forecast: Forecast[]): HTMLElement {
  const row = ({ attack, level }: Forecast) => {
    const { name, meaning } = attackWords(attack);
    const what = h("span", {}, name.charAt(0).toUpperCase() + name.slice(1), ...(meaning ? [h("span", { class: "hint" }, meaning)] : []));
    return h("li", { "data-level": level }, what, h("span", { class: "level" }, LEVELS[level]));
  };
  return h(
    "section",
    { class: "forecast", "aria-label": "What the mark survives" },
    h("h3", {}, "What the mark survives"),
    h("p", { class: "hint" }, "Each change was made to the marked copy, and the mark looked for in what was left. “Maybe” was found too, and may be lost next time or by another program."),
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
  const heads = ["Where", "Tag", "Chance at most", "Agrees", "Places"].map((text) => h("th", { scope: "col" }, text));
  const table = h("table", {}, h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, ...carriers.map(row)));
  const hints = carriers.map(({ name }) => h("p", { class: "hint" }, h("strong", {}, CARRIERS[name].name), `: ${CARRIERS[name].survives}`));
  const places = h("p", { class: "hint" }, "Places are what a mark’s symbols can stand in: those that this key uses, of those that the model has.");
  return h("div", { class: "carriers" }, h("div", { class: "scroll" }, table), places, ...hints);
}

export function details(summary: string, ...content: Node[]): HTMLElement {
  return h("details", {}, h("summary", {}, summary), ...content);
}

export function actions(...buttons: Node[]): HTMLElement {
  return h("div", { class: "actions" }, ...buttons);
}
