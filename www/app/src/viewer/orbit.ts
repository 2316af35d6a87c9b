/**
 * An eye on a scene: orbit by mouse, touch and keys, lights that go with it. Draws only when something has changed: the canvas's
 * `data-state` says `moving` until what there is to be seen stands there, and then `still`.
 */
import {
  DirectionalLight,
  HemisphereLight,
  NeutralToneMapping,
  PerspectiveCamera,
  PMREMGenerator,
  Scene,
  Sphere,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Texture,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

export interface Lighting {
  from: Vector3;
  intensity: number;
  surroundings: number;
}

/** Lights go with the eye: from over the left shoulder; or from far left, low over what faces the eye, where bumps throw shade. */
export const SOFT: Lighting = { from: new Vector3(-1, 1.2, 1), intensity: 1.6, surroundings: 0.45 };
export const RAKING: Lighting = { from: new Vector3(-1, 0.35, 0.15), intensity: 4.2, surroundings: 0.1 };

/** Light from above and below in the stead of a room: about as much as from a room, on what mirrors nothing. */
const SKY = 0xffffff;
const GROUND = 0xa8a49c;
const SKY_INTENSITY = 6;

const FIELD_OF_VIEW = 32;
const FIRST_DIRECTION = new Vector3(0.55, 0.35, 1).normalize();
const KEY_TURN = Math.PI / 24;
const KEY_ZOOM = 1.15;

/** A picture of two sides of an upright line: what is drawn on each is chosen just before. */
export interface Wipe {
  /** Where the line stands, from the left: 0 to 1. */
  at: number;
  left(): void;
  right(): void;
}

/** Where the eye is and what it looks at, from the middle of what was framed and in its radii: the same for scenes of any size. */
interface Pose {
  eye: Vector3;
  target: Vector3;
}

export class Orbit {
  readonly scene = new Scene();
  readonly #canvas: HTMLCanvasElement;
  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera(FIELD_OF_VIEW);
  readonly #light = new DirectionalLight();
  readonly #sky = new HemisphereLight(SKY, GROUND);
  #room: Texture | undefined;
  readonly #controls: OrbitControls;
  readonly #bounds = new Sphere();
  #frame = 0;
  #led: Orbit | undefined;
  #isLed = false;
  #front = FIRST_DIRECTION;
  #wipe: Wipe | null = null;

  /** @throws where the browser has no WebGL 2 */
  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.toneMapping = NeutralToneMapping;
    this.scene.add(this.#camera.add(this.#light, this.#light.target), this.#sky);

    // One finger scrolls the page past a canvas, and turns the model once a tap has given it the focus: see `touch-action` in its style.
    canvas.addEventListener("pointerdown", ({ pointerType }) => (this.#controls.enabled = pointerType !== "touch" || document.activeElement === canvas), { capture: true });
    this.#controls = new OrbitControls(this.#camera, canvas);
    canvas.style.touchAction = "";
    this.#controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.#controls.addEventListener("change", () => {
      this.draw();
      if (!this.#isLed) {
        this.#led?.follow(this);
      }
    });
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.light(SOFT);
    new ResizeObserver(() => this.#resize(canvas.clientWidth, canvas.clientHeight)).observe(canvas);
  }

  /** Looks at what is in a sphere, from the front, wherever that is. */
  frame(bounds: Sphere, front = FIRST_DIRECTION): void {
    this.#front = front;
    this.#bounds.copy(bounds);
    this.reset();
  }

  /** Takes another eye along wherever this one goes. */
  lead(other: Orbit): void {
    this.#led = other;
  }

  /** Looks as another eye does, each at its own scene. */
  follow(other: Orbit): void {
    const { eye, target } = other.#pose();
    const { center, radius } = this.#bounds;
    this.#controls.target.copy(target).multiplyScalar(radius).add(center);
    this.#camera.position.copy(eye).multiplyScalar(radius).add(center);
    this.#isLed = true;
    this.#controls.update();
    this.#isLed = false;
    this.draw();
  }

  #pose(): Pose {
    const { center, radius } = this.#bounds;
    const relative = (place: Vector3) => place.clone().sub(center).divideScalar(Math.max(radius, 1e-9));
    return { eye: relative(this.#camera.position), target: relative(this.#controls.target) };
  }

  /** What mirrors its surroundings, as metal does, is in a room; all else does without, for that takes four seconds to prepare where there is no graphics card. */
  light({ from, intensity, surroundings }: Lighting, { isMirrored = false } = {}): void {
    this.#light.position.copy(from);
    this.#light.intensity = intensity;
    this.scene.environment = isMirrored ? (this.#room ??= roomFor(this.#renderer)) : null;
    this.scene.environmentIntensity = surroundings;
    this.#sky.intensity = isMirrored ? 0 : SKY_INTENSITY * surroundings;
    this.draw();
  }

  /** The whole model in view, from where the eye is. */
  fit(): void {
    this.#frameFrom(this.#camera.position.clone().sub(this.#controls.target).normalize());
  }

  /** The whole model in view, from the front. */
  reset(): void {
    this.#frameFrom(this.#front);
  }

  /** From now on draws two sides of a line; with `null`, all as it stands in the scene. */
  wipe(wipe: Wipe | null): void {
    this.#wipe = wipe;
    this.draw();
  }

  /** Draws at the next frame, once; movement that is still dying down asks for the one after it. */
  draw(): void {
    this.#canvas.dataset["state"] = "moving";
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#controls.update();
      this.#render();
      this.#canvas.dataset["state"] = this.#frame ? "moving" : "still";
    });
  }

  #render(): void {
    if (!this.#wipe) {
      this.#renderer.render(this.scene, this.#camera);
      return;
    }
    const { at, left, right } = this.#wipe;
    const { x: width, y: height } = this.#renderer.getSize(new Vector2());
    const line = Math.round(at * width);
    this.#renderer.setScissorTest(true);
    for (const [choose, from, to] of [[left, 0, line], [right, line, width]] as const) {
      choose();
      this.#renderer.setScissor(from, 0, to - from, height);
      this.#renderer.render(this.scene, this.#camera);
    }
    this.#renderer.setScissorTest(false);
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
    this.draw();
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
    this.draw();
  }

  #resize(width: number, height: number): void {
    if (width > 0 && height > 0) {
      this.#renderer.setSize(width, height, false);
      this.#camera.aspect = width / height;
      this.#camera.updateProjectionMatrix();
      this.draw();
    }
  }
}

function roomFor(renderer: WebGLRenderer): Texture {
  const pmrem = new PMREMGenerator(renderer);
  // Without a blur before the filter: nobody sees it.
  const { texture } = pmrem.fromScene(new RoomEnvironment());
  pmrem.dispose();
  return texture;
}
