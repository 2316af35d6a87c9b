/** A model on a canvas: orbit, before and after, edges, heat map. Draws only when something has changed. */
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
import { Layer } from "./layer";

export type Version = "before" | "after";

const FIELD_OF_VIEW = 32;
const FIRST_DIRECTION = new Vector3(0.55, 0.35, 1).normalize();
const KEY_TURN = Math.PI / 24;
const KEY_ZOOM = 1.15;

export class Viewer {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(FIELD_OF_VIEW);
  readonly #controls: OrbitControls;
  readonly #layers: Partial<Record<Version, Layer>> = {};
  readonly #bounds = new Sphere();
  #look = { version: "before" as Version, wireframe: false, heat: false };
  #frame = 0;

  /** @throws where the browser has no WebGL 2 */
  constructor(canvas: HTMLCanvasElement) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.toneMapping = NeutralToneMapping;
    const pmrem = new PMREMGenerator(this.#renderer);
    this.#scene.environment = pmrem.fromScene(new RoomEnvironment(), 0.04).texture;
    pmrem.dispose();
    this.#scene.environmentIntensity = 0.45;
    const key = new DirectionalLight(0xffffff, 1.6); // from over the viewer's left shoulder, wherever they look from
    key.position.set(-1, 1.2, 1);
    this.#scene.add(this.#camera.add(key, key.target));

    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.#controls.addEventListener("change", () => this.#draw());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("webglcontextrestored", () => this.#draw());
    new ResizeObserver(() => this.#resize(canvas.clientWidth, canvas.clientHeight)).observe(canvas);
  }

  /** Shows a model alone, framed. */
  showBefore(root: Object3D): void {
    this.clear();
    this.#add("before", root);
    this.#bounds.copy(this.#layers.before!.bounds());
    this.reset();
  }

  /** Adds the marked version of the model that is shown, with the heat map; returns the largest displacement in scene units. */
  showAfter(root: Object3D): number {
    const before = this.#layers.before!;
    const after = this.#add("after", root);
    const heat = heatOf(before.meshes, after.meshes);
    before.heat(heat);
    after.heat(heat);
    this.look({ version: "after" });
    return heat.max;
  }

  /** Takes the marked version away again. */
  dropAfter(): void {
    this.#layers.after?.dispose();
    delete this.#layers.after;
    this.look({ version: "before", heat: false });
  }

  look(change: Partial<{ version: Version; wireframe: boolean; heat: boolean }>): void {
    this.#look = { ...this.#look, ...change };
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
    this.#look = { version: "before", wireframe: false, heat: false };
    this.#draw();
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
