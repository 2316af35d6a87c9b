/** A model on a canvas: orbit, before and after, edges, raking light, heat map. Draws only when something has changed. */
import {
  DirectionalLight,
  NeutralToneMapping,
  PerspectiveCamera,
  PMREMGenerator,
  Scene,
  Sphere,
  Spherical,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { heatOf } from "./heat";
import { Layer, type Normals, type Shading } from "./layer";

export type Version = "before" | "after";

export interface Look {
  version: Version;
  wireframe: boolean;
  shading: Shading;
  normals: Normals;
}

const FIRST_LOOK: Look = { version: "before", wireframe: false, shading: "surface", normals: "geometry" };

/** Lights go with the eye: from over the left shoulder; or from far left, low over what faces the eye, where bumps throw shade. */
const SOFT = { from: new Vector3(-1, 1.2, 1), intensity: 1.6, surroundings: 0.45 };
const RAKING = { from: new Vector3(-1, 0.35, 0.15), intensity: 4.2, surroundings: 0.1 };

const FIELD_OF_VIEW = 32;
const FIRST_DIRECTION = new Vector3(0.55, 0.35, 1).normalize();
const KEY_TURN = Math.PI / 24;
const KEY_ZOOM = 1.15;

export class Viewer {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(FIELD_OF_VIEW);
  readonly #light = new DirectionalLight();
  readonly #controls: OrbitControls;
  readonly #layers: Partial<Record<Version, Layer>> = {};
  readonly #bounds = new Sphere();
  #look = FIRST_LOOK;
  #frame = 0;

  /** @throws where the browser has no WebGL 2 */
  constructor(canvas: HTMLCanvasElement) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.toneMapping = NeutralToneMapping;
    const pmrem = new PMREMGenerator(this.#renderer);
    this.#scene.environment = pmrem.fromScene(new RoomEnvironment(), 0.04).texture;
    pmrem.dispose();
    this.#scene.add(this.#camera.add(this.#light, this.#light.target));

    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.#controls.addEventListener("change", () => this.#draw());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("webglcontextrestored", () => this.#draw());
    this.look({});
    new ResizeObserver(() => this.#resize(canvas.clientWidth, canvas.clientHeight)).observe(canvas);
  }

  /** Shows a model alone, framed. */
  showBefore(root: Object3D): void {
    this.clear();
    this.#add("before", root);
    this.#bounds.copy(this.#layers.before!.bounds());
    this.reset();
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
    const { from, intensity, surroundings } = this.#look.shading === "raking" ? RAKING : SOFT;
    this.#light.position.copy(from);
    this.#light.intensity = intensity;
    this.#scene.environmentIntensity = surroundings;
    for (const version of ["before", "after"] as const) {
      this.#layers[version]?.show({ ...this.#look, visible: version === this.#look.version });
    }
    this.#draw();
  }

  /** The whole model in view, from where the eye is. */
  fit(): void {
    this.#frameFrom(this.#camera.position.clone().sub(this.#controls.target).normalize());
  }

  /** The whole model in view, from the front. */
  reset(): void {
    this.#frameFrom(FIRST_DIRECTION);
  }

  clear(): void {
    this.#layers.before?.dispose();
    this.#layers.after?.dispose();
    delete this.#layers.before;
    delete this.#layers.after;
    this.look(FIRST_LOOK);
  }

  #add(version: Version, root: Object3D): Layer {
    this.#scene.add(root);
    const layer = new Layer(root);
    this.#layers[version] = layer;
    this.look({});
    return layer;
  }

  #frameFrom(direction: Vector3): void {
    const { center, radius } = this.#bounds;
    const size = Math.max(radius, 1e-9);
    const halfAngle = (FIELD_OF_VIEW / 2) * (Math.PI / 180);
    const distance = (size / Math.sin(Math.atan(Math.tan(halfAngle) * Math.min(this.#camera.aspect, 1)))) * 1.04;
    this.#camera.near = size / 100;
    this.#camera.far = distance + size * 100;
    this.#camera.updateProjectionMatrix();
    this.#controls.minDistance = size / 10;
    this.#controls.maxDistance = size * 20;
    this.#controls.target.copy(center);
    this.#camera.position.copy(center).addScaledVector(direction, distance);
    this.#controls.update();
    this.#draw();
  }

  #key(event: KeyboardEvent): void {
    const turn = (theta: number, phi: number) => () => this.#orbit(theta, phi, 1);
    const zoom = (factor: number) => () => this.#orbit(0, 0, factor);
    const action = {
      ArrowLeft: turn(-KEY_TURN, 0),
      ArrowRight: turn(KEY_TURN, 0),
      ArrowUp: turn(0, -KEY_TURN),
      ArrowDown: turn(0, KEY_TURN),
      "+": zoom(1 / KEY_ZOOM),
      "=": zoom(1 / KEY_ZOOM),
      "-": zoom(KEY_ZOOM),
      "0": () => this.reset(),
    }[event.key];
    if (action && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      action();
    }
  }

  #orbit(theta: number, phi: number, factor: number): void {
    const offset = this.#camera.position.clone().sub(this.#controls.target);
    const spherical = new Spherical().setFromVector3(offset);
    spherical.theta += theta;
    spherical.phi += phi;
    spherical.radius *= factor;
    this.#camera.position.copy(this.#controls.target).add(offset.setFromSpherical(spherical.makeSafe()));
    this.#controls.update();
    this.#draw();
  }

  #resize(width: number, height: number): void {
    if (width > 0 && height > 0) {
      this.#renderer.setSize(width, height, false);
      this.#camera.aspect = width / height;
      this.#camera.updateProjectionMatrix();
      this.#draw();
    }
  }

  /** Draws at the next frame, once; movement that is still dying down asks for the one after it. */
  #draw(): void {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#controls.update();
      this.#renderer.render(this.#scene, this.#camera);
    });
  }
}
