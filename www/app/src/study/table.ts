/** Table I: how many hosts are found again, as rows come in. */
import type { HostsRow, Rule, RuleCounts, Spread } from "../../research-wasm/research.js";
import { h } from "../dom";
import { count, significant } from "../words";
import { RANKINGS, RULES } from "./words";

const HEADS = ["Iterations", "By chance", "Random", ...Object.values(RANKINGS).map(({ name }) => name)];

/** One body of rows for each rule; beside each ranking's count how many times the random one it is. */
export function hostsTable(rows: HostsRow[]): HTMLElement {
  const bodies = (Object.keys(RULES) as Rule[]).map((rule) => {
    const { name, hint } = RULES[rule];
    const head = h("tr", { class: "rule" }, h("th", { scope: "rowgroup", colspan: String(HEADS.length) }, name, h("span", { class: "hint" }, hint)));
    return h("tbody", {}, head, ...rows.map((row) => rowOf(row, row.rules.find((counts) => counts.rule === rule)!)));
  });
  const heads = HEADS.map((text) => h("th", { scope: "col" }, text));
  return h("div", { class: "scroll" }, h("table", {}, h("thead", {}, h("tr", {}, ...heads)), ...bodies));
}

function rowOf({ iterations }: HostsRow, { chance, random, ranked }: RuleCounts): HTMLElement {
  const counts = Object.keys(RANKINGS).map((ranking) => ranked.find((count) => count.ranking === ranking)!);
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, String(iterations)),
    h("td", {}, chance === null ? "–" : count(Math.round(chance))),
    h("td", {}, spread(random)),
    ...counts.map(({ count: found, ratio }) => h("td", {}, count(found), ...(ratio === null ? [] : [h("span", { class: "ratio" }, `×${significant(ratio)}`)]))),
  );
}

function spread({ mean, deviation }: Spread): string {
  return `${count(Math.round(mean))} ± ${significant(deviation)}`;
}
