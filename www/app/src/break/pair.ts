/** Two models side by side, seen by eyes that move together. */
import type { Model } from "../model";
import { loadScene } from "../viewer/load";
import { Viewer } from "../viewer/viewer";

export interface PairLook {
  wireframe: boolean;
  raking: boolean;
}

export class Pair {
  readonly #marked: Viewer;
  readonly #copy: Viewer;
  #look: PairLook = { wireframe: false, raking: false };

  /** @throws where the browser has no WebGL 2 */
  constructor(marked: HTMLCanvasElement, copy: HTMLCanvasElement) {
    [this.#marked, this.#copy] = [new Viewer(marked), new Viewer(copy)];
    this.#marked.lead(this.#copy);
    this.#copy.lead(this.#marked);
  }

  async showMarked(model: Model): Promise<void> {
    this.clear();
    this.#marked.showBefore(await loadScene(model));
    this.look(this.#look);
  }

  /** @param isWanted whether it still is, once it has been read */
  async showCopy(model: Model, isWanted: () => boolean): Promise<void> {
    const scene = await loadScene(model);
    if (isWanted()) {
      this.#copy.showBeside(scene, this.#marked);
      this.look(this.#look);
    }
  }

  /** Clay, unless in raking light: attacked copies are bare triangles, and so is the model beside them. */
  look(look: PairLook): void {
    this.#look = look;
    for (const viewer of [this.#marked, this.#copy]) {
      viewer.look({ wireframe: look.wireframe, shading: look.raking ? "raking" : "clay" });
    }
  }

  dropCopy(): void {
    this.#copy.clear();
  }

  fit(): void {
    this.#marked.fit();
  }

  reset(): void {
    this.#marked.reset();
  }

  clear(): void {
    this.#marked.clear();
    this.#copy.clear();
  }
}
