/** A mesh and its hosts on a canvas, before and after smoothing: the paper's Figs. 3 and 4. */
import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  Points,
  PointsMaterial,
  SRGBColorSpace,
  type Material,
  type Object3D,
} from "three";
import type { StudyMesh, Tracing } from "../../research-wasm/research.js";
import { colorAt } from "../viewer/colormap";
import { CLAY, HEAT, WIRES } from "../viewer/layer";
import { Orbit } from "../viewer/orbit";
import type { Field } from "./field";
import { FATES, PATH_SCALE, type Fate } from "./fate";

export type Version = "before" | "after";

/** What there is to be seen. */
export interface Sight {
  version: Version;
  mesh: StudyMesh;
  tracing: Tracing | undefined;
  /** What the surface is coloured by, if it is. */
  field: Field | null;
  hosts: "none" | "stability" | "fate";
  paths: boolean;
  wireframe: boolean;
}

const UNKNOWN = new Color(0xb9b4aa);
const SIZE = 9; // of a host, in CSS pixels
const BEHIND_HOSTS = { polygonOffsetFactor: SIZE, polygonOffsetUnits: SIZE }; // so that a host is whole on a slope
const COLORED = Object.assign(HEAT.clone(), BEHIND_HOSTS);
const PLAIN = Object.assign(CLAY.clone(), BEHIND_HOSTS);
const PATHS = new LineBasicMaterial({ color: 0xb0306a, toneMapped: false });

export class StudyViewer {
  readonly #orbit: Orbit;
  readonly #signs = new Map<string, PointsMaterial>();
  readonly #surfaces = new Map<StudyMesh, Mesh>();
  #shown: Object3D[] = [];

  /** @throws where the browser has no WebGL 2 */
  constructor(canvas: HTMLCanvasElement) {
    this.#orbit = new Orbit(canvas);
  }

  /** Looks at a mesh from the front. */
  frame(mesh: StudyMesh): void {
    const { geometry } = this.#surface(mesh);
    geometry.computeBoundingSphere();
    this.#orbit.frame(geometry.boundingSphere!);
  }

  fit(): void {
    this.#orbit.fit();
  }

  reset(): void {
    this.#orbit.reset();
  }

  clear(): void {
    this.#forget([]);
    this.#orbit.draw();
  }

  show({ version, mesh, tracing, field, hosts, paths, wireframe }: Sight): void {
    this.#forget(tracing ? [mesh, tracing] : [mesh]);
    const standing = (version === "after" && tracing) || mesh;
    const surface = this.#surface(standing);
    surface.material = field ? COLORED : PLAIN;
    if (field) {
      surface.geometry.setAttribute("color", colorsOf(field));
    }
    this.#add(surface);
    if (wireframe) {
      this.#add(new Mesh(surface.geometry, WIRES));
    }
    if (tracing && hosts === "stability") {
      this.#add(this.#points(standing, tracing.hosts, "disc", shades(tracing.hosts.length)));
    } else if (tracing && hosts === "fate") {
      for (const [fate, vertices] of fatesOf(tracing, version)) {
        this.#add(this.#points(standing, vertices, fate));
      }
    }
    if (tracing && paths && hosts !== "none") {
      this.#add(new LineSegments(pathsOf(mesh, tracing, version), PATHS));
    }
    this.#orbit.draw();
  }

  #add(object: Object3D): void {
    this.#shown.push(object);
    this.#orbit.scene.add(object);
  }

  /** Takes everything away, and keeps only these meshes' surfaces to be shown again. */
  #forget(kept: StudyMesh[]): void {
    const surfaces = new Set<BufferGeometry>();
    for (const [mesh, { geometry }] of this.#surfaces) {
      if (kept.includes(mesh)) {
        surfaces.add(geometry);
      } else {
        geometry.dispose();
        this.#surfaces.delete(mesh);
      }
    }
    for (const object of this.#shown.splice(0)) {
      object.removeFromParent();
      const { geometry } = object as Mesh;
      if (!surfaces.has(geometry)) {
        geometry.dispose();
      }
    }
  }

  #surface(mesh: StudyMesh): Mesh {
    const known = this.#surfaces.get(mesh);
    if (known) {
      return known;
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(mesh.positions), 3));
    geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
    geometry.computeVertexNormals();
    const surface = new Mesh(geometry);
    this.#surfaces.set(mesh, surface);
    return surface;
  }

  #points({ positions }: StudyMesh, vertices: ArrayLike<number>, sign: Fate | "disc", colors?: BufferAttribute): Points {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(Array.from(vertices).flatMap((v) => [...positions.subarray(v * 3, v * 3 + 3)])), 3));
    if (colors) {
      geometry.setAttribute("color", colors);
    }
    return new Points(geometry, this.#sign(sign));
  }

  #sign(sign: Fate | "disc"): Material {
    const known = this.#signs.get(sign);
    if (known) {
      return known;
    }
    const material = new PointsMaterial({
      map: new CanvasTexture(drawing(sign)),
      vertexColors: sign === "disc",
      size: SIZE * Math.min(devicePixelRatio, 2),
      sizeAttenuation: false,
      alphaTest: 0.4,
      toneMapped: false,
    });
    material.map!.colorSpace = SRGBColorSpace;
    this.#signs.set(sign, material);
    return material;
  }
}

/** Hosts by what became of them; afterwards also those that took the places of the lost ones. */
function fatesOf({ hosts, found, hostsAfter }: Tracing, version: Version): [Fate, number[]][] {
  const were = new Set(hosts);
  const newcomers = version === "after" ? [...hostsAfter].filter((v) => !were.has(v)) : [];
  const by = (isFound: boolean) => [...hosts].filter((_, i) => found[i] === isFound);
  return [
    ["newcomer", newcomers],
    ["lost", by(false)],
    ["found", by(true)],
  ];
}

/** From where hosts stand, back or on along the way that they have gone, `PATH_SCALE` times as far. */
function pathsOf({ positions: from }: StudyMesh, { positions: to, hosts }: Tracing, version: Version): BufferGeometry {
  const [start, sense] = version === "before" ? [from, PATH_SCALE] : [to, -PATH_SCALE];
  const ends = [...hosts].flatMap((v) => {
    const axes = [v * 3, v * 3 + 1, v * 3 + 2];
    return [...axes.map((i) => start[i]!), ...axes.map((i) => start[i]! + sense * (to[i]! - from[i]!))];
  });
  return new BufferGeometry().setAttribute("position", new BufferAttribute(Float32Array.from(ends), 3));
}

/** From the first host to the last. */
function shades(count: number): BufferAttribute {
  return colorsBy(Float64Array.from({ length: count }, (_, i) => 1 - i / Math.max(count - 1, 1)), 0, 1);
}

function colorsOf({ values, range: [least, most] }: Field): BufferAttribute {
  return colorsBy(values, least, most);
}

function colorsBy(values: Float64Array, least: number, most: number): BufferAttribute {
  const colors = new BufferAttribute(new Float32Array(values.length * 3), 3);
  const color = new Color();
  values.forEach((value, v) => {
    if (Number.isNaN(value)) {
      color.copy(UNKNOWN);
    } else {
      color.setRGB(...colorAt(most > least ? (value - least) / (most - least) : 0), SRGBColorSpace);
    }
    colors.setXYZ(v, color.r, color.g, color.b);
  });
  return colors;
}

/** A sign on a transparent square: told apart by shape as by colour, with a rim that shows it on any surface. */
function drawing(sign: Fate | "disc"): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d")!;
  const { path, color } = sign === "disc" ? { path: FATES.found.path, color: "#ffffff" } : FATES[sign];
  const shape = new Path2D(path);
  context.scale(64 / 16, 64 / 16);
  context.lineWidth = 1.6;
  context.strokeStyle = sign === "disc" ? "#ffffff" : "#16181a";
  context.stroke(shape);
  context.fillStyle = color;
  context.fill(shape);
  return canvas;
}
