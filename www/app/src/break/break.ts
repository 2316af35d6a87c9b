/** Try to break it: a marked model and its key in, and what is left of the mark after whatever is done to it. */
import { announce, find, h } from "../dom";
import { engine } from "../engine";
import { incompleteKeyField, isKeyComplete, keySource } from "../key-form";
import { unpacked } from "../archive";
import { modelsIn, type Model, type NamedFile } from "../model";
import { card, errorCard } from "../outcome";
import { View } from "../view";
import { isMark, VERDICTS } from "../words";
import { Attempt, type Copy, type Work } from "./attempt";
import { Bench, SECOND_MARK } from "./bench";
import { Chain } from "./chain";
import { SurvivalMap } from "./map";
import { picker } from "./picker";
import { ownTool } from "./own";
import { Now } from "./now";
import { Queue } from "./queue";
import { Rows } from "./rows";
import { BreakStage } from "./stage";
import { cameOf, capital, choices, stepsWords, type Step } from "./words";

export class Break extends View<BreakStage> {
  readonly #tools = find("#break-tools");
  readonly #tried = find("#tried");
  readonly #survival = find("#survival");
  readonly #families = find("#attack-families");
  readonly #seed = find<HTMLInputElement>("#seed");
  readonly #chain = new Chain(find("#chain"), (steps) => this.#try(steps));
  readonly #queue = new Queue();
  readonly #now = new Now(find("#break-now"), () => this.#tried.scrollIntoView({ block: "start" }));
  /** How the result of a tool that is not ours comes in. */
  readonly #own: HTMLElement;
  #bench: Bench | undefined;
  #rows: Rows | undefined;
  #map: SurvivalMap | undefined;
  /** The attempt that the stage tells of, and the copy of it that stands there. */
  #shown: Attempt | undefined;
  #broughtCopy: Copy | undefined;
  /** The copy of another view that was last taken from there. */
  #offered: Model | undefined;

  constructor(root: HTMLElement) {
    super(root, "Cannot attack", BreakStage);
    find('[data-choose="demo"]', root).remove(); // it has no mark
    find("#reseed").addEventListener("click", () => {
      this.#seed.valueAsNumber = crypto.getRandomValues(new Uint16Array(1))[0]!;
      this.#onSeed();
    });
    this.#seed.addEventListener("change", () => this.#onSeed());
    this.#own = ownTool((files) => void this.takeFiles(files));
  }

  /** Begins with the copy that was just marked in another view. */
  onShown(isShown: boolean, marked: Model | undefined): void {
    if (isShown && marked && marked !== this.#offered) {
      void this.begin(marked);
    }
  }

  /** Takes a copy, and reads it at once where there is a key to read it with. */
  async begin(marked: Model): Promise<void> {
    this.#offered = marked;
    await this.take(marked);
    if (isKeyComplete() && marked === this.model) {
      await this.submit();
    }
  }

  /** What comes once attacks are under way is what a person's own tool has made. */
  override async takeFiles(files: NamedFile[]): Promise<void> {
    const bench = this.#bench;
    if (!bench) {
      return super.takeFiles(files);
    }
    try {
      const found = modelsIn(await unpacked(files));
      this.outcome.tell();
      for (const { name, open } of found) {
        this.#ask(this.#made(name, "a file of your own", false, bench.judge(await open())));
      }
    } catch (error) {
      this.outcome.tell(errorCard("Cannot open", error));
    }
  }

  override async take(model: Model): Promise<void> {
    this.#end();
    await super.take(model);
  }

  protected override close(): void {
    this.#offered = undefined;
    this.#end();
    super.close();
  }

  protected async submit(): Promise<void> {
    const model = this.ready(incompleteKeyField());
    if (!model) {
      return;
    }
    const key = keySource();
    const bench = await this.run(`Reading ${model.name}`, async (task) => Bench.open(model, await key.make(await engine, task), task));
    if (bench) {
      this.#open(bench);
    }
  }

  override get isBusy(): boolean {
    return this.isRunning || this.#queue.isBusy;
  }

  #open(bench: Bench): void {
    const { reading } = bench.first;
    if (!isMark(reading) && reading.verdict !== "partial") {
      bench.close();
      const why = "There is nothing to break: mark the model with this key first, or give the key that it was marked with.";
      const nothing = card(reading.verdict, VERDICTS[reading.verdict], [why]);
      this.outcome.tell(nothing);
      this.outcome.present(nothing);
      return;
    }
    const every = choices(bench.catalogue);
    this.#bench = bench;
    const rows = (this.#rows = new Rows(bench.first, { onShow: (attempt) => this.#look(attempt), onAgain: (attempt) => this.#ask(attempt) }));
    this.#map = new SurvivalMap(every, {
      attempt: (step) => this.#attempt([step]),
      onFill: (attempts) => this.#queue.fill(attempts),
      onChoose: (attempt) => this.#choose(attempt),
    });
    this.#families.replaceChildren(...picker(every, { onTry: (step) => this.#try([step]), onAdd: (step) => this.#chain.add(step) }));
    const hint = "By chance: a model made without the key would show as much at most so often; also for each place where the mark lives. Cost: average and largest distance from the marked model, in % of its size, and how visible the difference is, from 0 to 1 (MSDM).";
    this.#tried.replaceChildren(section("What was tried", hint, rows.root, this.#own));
    this.#survival.replaceChildren(section("Survival map", "Each attack at each level, weakest first. Choose a cell to see its copy; what you try meanwhile comes first.", this.#map.root));
    this.#setOpen(true);
    announce("The mark is there. Try to break it.");
    const headline = find("h2", this.#tools);
    headline.tabIndex = -1;
    headline.focus({ preventScroll: true }); // Begin had it, and is gone
    find("[data-stage]", this.root).scrollIntoView({ block: "start" });
  }

  /** What stands in the map was drawn from the seed before: a map that has been begun stays until it is begun anew. */
  #onSeed(): void {
    if (this.#map?.isUntouched) {
      this.#map.reset();
    }
  }

  #setOpen(isOpen: boolean): void {
    this.form.hidden = isOpen;
    this.#tools.hidden = !isOpen;
  }

  /** Ends what goes on and forgets the key. */
  #end(): void {
    this.#queue.clear();
    this.#bench?.close();
    this.#bench = this.#rows = this.#map = this.#shown = undefined;
    this.#chain.clear();
    this.#now.hide();
    this.#tried.replaceChildren();
    this.#survival.replaceChildren();
    this.#setOpen(false);
  }

  #attempt(steps: Step[]): Attempt {
    const bench = this.#bench!;
    const seed = Math.max(0, Math.floor(this.#seed.valueAsNumber || 0)) % 2 ** 32;
    const work: Work = (telling) => bench.attack(steps.map(({ name }) => name), seed)(telling);
    // A second mark's key is drawn anew each time.
    const isFresh = steps.some(({ name }) => name === SECOND_MARK);
    return this.#made(stepsWords(steps), isFresh ? `seed ${seed}, a fresh key` : `seed ${seed}`, !isFresh, work);
  }

  #made(title: string, hint: string, isRepeatable: boolean, work: Work): Attempt {
    const attempt = new Attempt(title, hint, isRepeatable, work);
    attempt.onChange(() => this.#follow(attempt));
    return attempt;
  }

  /** What was tried before, and would come to the same, is shown again. */
  #try(steps: Step[]): void {
    const attempt = this.#attempt(steps);
    this.#choose(this.#rows?.like(attempt) ?? attempt);
  }

  /** A cell of the map: what it holds is shown, what it holds not yet is tried. */
  #choose(attempt: Attempt): void {
    if (attempt.state === "done") {
      this.#rows?.add(attempt);
      this.#look(attempt);
      announce(`${attempt.title}: ${cameOf(attempt)}`);
    } else {
      this.#ask(attempt);
    }
  }

  #look(attempt: Attempt): void {
    this.#watch(attempt);
    find("[data-stage]", this.root).scrollIntoView({ block: "nearest" });
  }

  /** Tries something as soon as can be, and shows its copy when there is one. */
  #ask(attempt: Attempt): void {
    this.#rows?.add(attempt);
    this.#watch(attempt);
    this.#queue.ask(attempt);
  }

  /** Shows an attempt's copy, the one it has or the one it comes to have. */
  #watch(attempt: Attempt): void {
    this.#shown = attempt;
    this.#broughtCopy = undefined;
    this.#rows?.point(attempt);
    if (!attempt.copy) {
      this.stage.dropCopy();
    }
    this.#follow(attempt);
  }

  /** Says how the attempt that is shown stands, and brings its copy when there is another one. */
  #follow(attempt: Attempt): void {
    const { state, finding, words, title, copy } = attempt;
    if (attempt !== this.#shown) {
      return;
    }
    const came = state === "running" ? words : capital(cameOf(attempt));
    this.stage.describeCopy(title, came, state === "done" ? (finding?.level ?? null) : null);
    this.#now.tell(title, came, state === "done" ? (finding?.level ?? null) : null);
    if (copy && copy !== this.#broughtCopy) {
      this.#broughtCopy = copy;
      void this.stage.showCopy(copy);
    }
  }
}

function section(headline: string, hint: string, ...content: HTMLElement[]): HTMLElement {
  return h("section", { class: "card", "aria-label": headline }, h("h2", {}, headline), h("p", { class: "hint" }, hint), ...content);
}
