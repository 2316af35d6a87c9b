/**
 * The tab list, by the ARIA pattern: arrow keys move, Home and End jump, one tab stop. Each tab is an entry of the history, named by its
 * panel in the address: Back goes to the tab before, and a reload stays.
 *
 * Opens the tab that the address names, or else the first. Returns how to go to another one.
 */
export function startTabs(tabs: HTMLElement[], onSelect: (panel: HTMLElement) => void): (tab: HTMLElement) => void {
  const nameOf = (tab: HTMLElement) => tab.getAttribute("aria-controls")!;
  const panelOf = (tab: HTMLElement) => document.getElementById(nameOf(tab))!;
  const show = (tab: HTMLElement) => {
    for (const other of tabs) {
      other.setAttribute("aria-selected", String(other === tab));
      other.tabIndex = other === tab ? 0 : -1;
      panelOf(other).hidden = other !== tab;
    }
    onSelect(panelOf(tab));
  };
  const named = () => tabs.find((tab) => `#${nameOf(tab)}` === location.hash) ?? tabs[0]!;
  const go = (tab: HTMLElement) => {
    if (panelOf(tab).hidden) {
      history.pushState(null, "", `#${nameOf(tab)}`);
      show(tab);
    }
  };
  addEventListener("popstate", () => show(named()));
  for (const [i, tab] of tabs.entries()) {
    tab.addEventListener("click", () => go(tab));
    tab.addEventListener("keydown", (event) => {
      const target = { ArrowLeft: i - 1, ArrowRight: i + 1, Home: 0, End: -1 }[event.key];
      if (target !== undefined) {
        event.preventDefault();
        const next = tabs.at(target % tabs.length)!;
        go(next);
        next.focus();
      }
    });
  }
  show(named());
  return go;
}
