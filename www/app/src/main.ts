/** The page: three views, one key form, one engine. */
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
const studyTab = find("#study-tab");

const check = new Check(find("#check"));
const protect = new Protect(find("#protect"), (marked) => {
  select(checkTab);
  checkTab.focus();
  void check.take(marked);
});

const study = new Study(find("#study"));
const views = [protect, check, study];

startKeyForm(() => protect.onOtherMark());
const select = startTabs([protectTab, checkTab, studyTab], (panel) => {
  if (panel !== study.root) {
    placeKeyForm(panel);
  }
  protect.onShown(panel === protect.root);
  study.onShown(panel === study.root, protect.shown);
});
select(protectTab);

onDrop((files) => void views.find(({ root }) => !root.hidden)?.takeFiles(files));

engine
  .then((client) => client.version())
  .then(
    (version) => (find("#version").textContent = `meshmark ${version}`),
    (error: unknown) => find("main").prepend(errorCard("Cannot start", error)),
  );

void startOffline();
