/** The tab list, by the ARIA pattern: arrow keys move, Home and End jump, one tab stop. */
export function startTabs(tabs: HTMLElement[], onSelect: (panel: HTMLElement) => void): (tab: HTMLElement) => void {
  const panelOf = (tab: HTMLElement) => document.getElementById(tab.getAttribute("aria-controls")!)!;
  const select = (tab: HTMLElement) => {
    for (const other of tabs) {
      other.setAttribute("aria-selected", String(other === tab));
      other.tabIndex = other === tab ? 0 : -1;
      panelOf(other).hidden = other !== tab;
    }
    onSelect(panelOf(tab));
  };
  for (const [i, tab] of tabs.entries()) {
    tab.addEventListener("click", () => select(tab));
    tab.addEventListener("keydown", (event) => {
      const target = { ArrowLeft: i - 1, ArrowRight: i + 1, Home: 0, End: -1 }[event.key];
      if (target !== undefined) {
        event.preventDefault();
        const next = tabs.at(target % tabs.length)!;
        select(next);
        next.focus();
      }
    });
  }
  return select;
}
