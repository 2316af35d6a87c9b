/** The page: four views, one key form, one engine. */
import { Break } from "./break/break";
import { Check } from "./check";
import { find } from "./dom";
import { onDrop } from "./drop";
import { engine } from "./engine";
import { placeKeyForm, startKeyForm } from "./key-form";
import { startOffline } from "./offline";
import { errorCard } from "./outcome";
import { Protect } from "./protect";
import { Study } from "./study/study";
import { startTabs } from "./tabs";

const protectTab = find("#protect-tab");
const checkTab = find("#check-tab");
const breakTab = find("#break-tab");
const studyTab = find("#study-tab");

const check = new Check(find("#check"));
const attack = new Break(find("#break"));
const protect = new Protect(find("#protect"), {
  onCheck: (marked) => {
    go(checkTab);
    void check.take(marked);
  },
  onBreak: () => go(breakTab),
});

const study = new Study(find("#study"));
const views = [protect, check, attack, study];

startKeyForm(() => views.forEach((view) => view.onOther()));
const select = startTabs([protectTab, checkTab, breakTab, studyTab], (panel) => {
  if (panel !== study.root) {
    placeKeyForm(panel, { isNew: panel === protect.root, areSeveral: panel === check.root });
  }
  check.onOther();
  protect.onShown(panel === protect.root);
  attack.onShown(panel === attack.root, protect.marked);
  study.onShown(panel === study.root, protect.shown);
});

function go(tab: HTMLElement): void {
  select(tab);
  tab.focus();
}

addEventListener("beforeunload", (event) => {
  if (protect.isAnythingLeft || views.some(({ isBusy }) => isBusy)) {
    event.preventDefault(); // the browser asks
  }
});

onDrop((files) => void views.find(({ root }) => !root.hidden)?.takeFiles(files));

engine
  .then((client) => client.version())
  .then(
    (version) => (find("#version").textContent = `meshmark ${version}`),
    (error: unknown) => find("main").prepend(errorCard("Cannot start", error)),
  );

void startOffline();
