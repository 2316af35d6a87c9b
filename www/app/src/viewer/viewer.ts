/** A model on a canvas: before and after, edges, raking light, heat map; or a suspect that lies on its original. */
import type { Object3D, Sphere } from "three";
import { heatOf } from "./heat";
import type { Laid, LaidLook } from "./laid";
import { Layer, type Normals, type Shading } from "./layer";
import { Orbit, RAKING, SOFT } from "./orbit";

export type Version = "before" | "after";

export interface Look {
  version: Version;
  wireframe: boolean;
  shading: Shading;
  normals: Normals;
}

/** Two models stand in the same place where their spheres' middles are so near, and their radii so much alike, in radii. */
const SAME_PLACE = 0.7;

const FIRST_LOOK: Look = { version: "before", wireframe: false, shading: "surface", normals: "geometry" };

export class Viewer {
  readonly #orbit: Orbit;
  readonly #layers: Partial<Record<Version, Layer>> = {};
  #look = FIRST_LOOK;
  #bounds: Sphere | undefined;
  /** What lies on an original, and how that is looked at: not at all where the model is. */
  #laid: Laid | undefined;
  #laidLook: LaidLook | undefined;

  /** @throws where the browser has no WebGL 2 */
  constructor(canvas: HTMLCanvasElement) {
    this.#orbit = new Orbit(canvas);
  }

  /** Shows a model alone, framed. */
  showBefore(root: Object3D): void {
    this.clear();
    this.#add("before", root);
    this.#bounds = this.#layers.before!.bounds();
    this.#orbit.frame(this.#bounds);
  }

  /** Shows a model alone as another viewer shows its own: in the same frame, unless it stands elsewhere or is of another size. */
  showBeside(root: Object3D, other: Viewer): void {
    this.showBefore(root);
    if (other.#bounds && this.#bounds && isInPlace(this.#bounds, other.#bounds)) {
      this.#orbit.frame(other.#bounds);
    }
    this.#orbit.follow(other.#orbit);
  }

  /** Takes another viewer's eye along wherever this one's goes. */
  lead(other: Viewer): void {
    this.#orbit.lead(other.#orbit);
  }

  /**
   * Adds the marked version of the model that is shown, in place of any other, with the heat map; returns the largest
   * displacement in scene units.
   */
  showAfter(root: Object3D): number {
    this.#layers.after?.dispose();
    const before = this.#layers.before!;
    const after = this.#add("after", root);
    const heat = heatOf(before.meshes, after.meshes);
    before.heat(heat);
    after.heat(heat);
    this.look({});
    return heat.max;
  }

  /** Adds a suspect that lies on its original; `lookAtLaid` shows it. */
  lay(laid: Laid): void {
    this.#laid?.dispose();
    this.#laid = laid;
    laid.root.visible = false;
    this.#orbit.scene.add(laid.root);
  }

  /**
   * Looks at the suspect on its original; `undefined`: at the model again.
   *
   * @param at where the line of a wipe stands, from the left: 0 to 1
   */
  lookAtLaid(look: LaidLook | undefined, at = 0.5): void {
    const laid = this.#laid;
    if (!laid) {
      return;
    }
    if ((look === undefined) !== (this.#laidLook === undefined)) {
      if (look) {
        this.#orbit.frame(laid.bounds(), laid.from);
      } else {
        this.#orbit.frame(this.#bounds!);
      }
    }
    this.#laidLook = look;
    this.#orbit.wipe(look === "wipe" ? { at, ...laid.wipe } : null);
    this.look({});
  }

  /** Takes the marked version away again. */
  dropAfter(): void {
    this.#layers.after?.dispose();
    delete this.#layers.after;
    this.look({ version: "before" });
  }

  /** Whether the model comes with normals of its own, beside which recomputed ones can be seen. */
  get hasNormals(): boolean {
    return this.#layers.before?.hasNormals ?? false;
  }

  look(change: Partial<Look>): void {
    this.#look = { ...this.#look, ...change };
    const isMirrored = this.#look.shading === "surface" && !this.#laidLook && this.#layers[this.#look.version]?.hasMirrors;
    this.#orbit.light(this.#look.shading === "raking" && !this.#laidLook ? RAKING : SOFT, { isMirrored });
    for (const version of ["before", "after"] as const) {
      this.#layers[version]?.show({ ...this.#look, visible: version === this.#look.version && !this.#laidLook });
    }
    if (this.#laid) {
      this.#laid.root.visible = this.#laidLook !== undefined;
      this.#laid.show(this.#laidLook ?? "difference", this.#look.wireframe);
    }
    this.#orbit.draw();
  }

  /** The whole model in view, from where the eye is. */
  fit(): void {
    this.#orbit.fit();
  }

  /** The whole model in view, from the front. */
  reset(): void {
    this.#orbit.reset();
  }

  clear(): void {
    this.#layers.before?.dispose();
    this.#layers.after?.dispose();
    delete this.#layers.before;
    delete this.#layers.after;
    this.#laid?.dispose();
    this.#laid = this.#laidLook = undefined;
    this.#orbit.wipe(null);
    this.look(FIRST_LOOK);
  }

  #add(version: Version, root: Object3D): Layer {
    this.#orbit.scene.add(root);
    const layer = new Layer(root);
    this.#layers[version] = layer;
    this.look({});
    return layer;
  }
}

/** Whether a part of what was in `whole`, or all of it, may be in `part`. */
function isInPlace(part: Sphere, whole: Sphere): boolean {
  return part.center.distanceTo(whole.center) < SAME_PLACE * whole.radius && part.radius > (1 - SAME_PLACE) * whole.radius && part.radius < (1 + SAME_PLACE) * whole.radius;
}
