/** A suspect that lies on its original: both in one place, and in colours how far they are from each other and what speaks for the mark. */
import type { Overlay, Sheet } from "meshmark";
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, Mesh, MeshStandardMaterial, Sphere, SRGBColorSpace, Vector3 } from "three";
import { colorAt } from "./colormap";
import { WIRES } from "./layer";
import type { Wipe } from "./orbit";

/** `wipe`: the original on the left of a line, the suspect on its right. `difference`, `evidence`: maps on the original. */
export type LaidLook = "wipe" | "difference" | "evidence";

const COMMON = { roughness: 1, flatShading: true, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
const ORIGINAL = new MeshStandardMaterial({ color: 0xb9b4aa, ...COMMON });
const SUSPECT = new MeshStandardMaterial({ color: 0x5b93c4, ...COMMON });
/** The legend's colours are those of these: see `.key` in the style. */
const CUT = new MeshStandardMaterial({ color: 0xb8b8b8, ...COMMON });
const ADDED = new MeshStandardMaterial({ color: 0xdb4d29, ...COMMON });
const GHOST = new MeshStandardMaterial({ color: 0xb9b4aa, roughness: 1, transparent: true, opacity: 0.22, depthWrite: false });
const MAP = new MeshStandardMaterial({ vertexColors: true, toneMapped: false, ...COMMON });

export class Laid {
  readonly root = new Group();
  /** The ends of the maps' scales: as a share of the diagonal, and in nats. */
  readonly ends: Record<"difference" | "evidence", number>;
  readonly hasEvidence: boolean;
  readonly from: Vector3;
  readonly wipe: Omit<Wipe, "at">;
  readonly #parts: Record<"original" | "suspect" | "cut" | "ghost" | "added" | "difference" | "evidence", Mesh>;
  readonly #wires: Record<"original" | "suspect", Mesh>;
  #hasWires = false;

  constructor({ original, suspect, differences, additions, mostDifference, evidence, mostEvidence, from }: Overlay) {
    this.from = new Vector3(...(from as [number, number, number]));
    this.hasEvidence = evidence !== null;
    this.ends = { difference: mostDifference, evidence: mostEvidence };
    const places = new BufferAttribute(original.positions, 3);
    const [near, cut] = split(original, differences);
    const [, added] = split(suspect, additions);
    const whole = geometryOf(places, original.triangles);
    const own = geometryOf(new BufferAttribute(suspect.positions, 3), suspect.triangles);
    const rest = geometryOf(places, cut);
    const map = (values: Float32Array, most: number) => geometryOf(places, near).setAttribute("color", colorsOf(values, most));
    this.#parts = {
      original: new Mesh(whole, ORIGINAL),
      suspect: new Mesh(own, SUSPECT),
      cut: new Mesh(rest, CUT),
      ghost: new Mesh(rest, GHOST),
      added: new Mesh(geometryOf(own.getAttribute("position") as BufferAttribute, added), ADDED),
      difference: new Mesh(map(differences, mostDifference), MAP),
      evidence: new Mesh(map(evidence ?? new Float32Array(differences.length), mostEvidence), MAP),
    };
    this.#wires = { original: new Mesh(whole, WIRES), suspect: new Mesh(own, WIRES) };
    this.root.add(...Object.values(this.#parts), ...Object.values(this.#wires));
    this.wipe = { left: () => this.#only(["original"], "original"), right: () => this.#only(["suspect", "ghost"], "suspect") };
    this.show("difference", false);
  }

  /** Shows a map; of a wipe, what is drawn is chosen side by side. */
  show(look: LaidLook, wireframe: boolean): void {
    this.#hasWires = wireframe;
    if (look !== "wipe") {
      this.#only([look, "cut", "added"], "suspect");
    }
  }

  bounds(): Sphere {
    const { geometry } = this.#parts.original;
    geometry.computeBoundingBox();
    const sphere = geometry.boundingBox!.getBoundingSphere(new Sphere());
    const [positions, point] = [geometry.getAttribute("position"), new Vector3()];
    sphere.radius = 0;
    for (let v = 0; v < positions.count; v++) {
      sphere.radius = Math.max(sphere.radius, point.fromBufferAttribute(positions, v).distanceTo(sphere.center));
    }
    return sphere;
  }

  dispose(): void {
    this.root.removeFromParent();
    Object.values(this.#parts).forEach(({ geometry }) => geometry.dispose());
  }

  #only(names: string[], wires: "original" | "suspect"): void {
    Object.entries(this.#parts).forEach(([name, part]) => (part.visible = names.includes(name)));
    Object.entries(this.#wires).forEach(([name, part]) => (part.visible = this.#hasWires && name === wires));
  }
}

function geometryOf(positions: BufferAttribute, triangles: Uint32Array): BufferGeometry {
  return new BufferGeometry().setAttribute("position", positions).setIndex(new BufferAttribute(triangles, 1));
}

/** The triangles of a sheet whose corners all have a finite value, and the others. */
function split({ triangles }: Sheet, values: Float32Array): [Uint32Array, Uint32Array] {
  const parts: [number[], number[]] = [[], []];
  for (let i = 0; i < triangles.length; i += 3) {
    const corners = [triangles[i]!, triangles[i + 1]!, triangles[i + 2]!];
    parts[corners.every((v) => Number.isFinite(values[v]!)) ? 0 : 1].push(...corners);
  }
  return [Uint32Array.from(parts[0]), Uint32Array.from(parts[1])];
}

function colorsOf(values: Float32Array, most: number): BufferAttribute {
  const colors = new BufferAttribute(new Float32Array(values.length * 3), 3);
  const color = new Color();
  values.forEach((value, v) => {
    color.setRGB(...colorAt(most > 0 && Number.isFinite(value) ? value / most : 0), SRGBColorSpace);
    colors.setXYZ(v, color.r, color.g, color.b);
  });
  return colors;
}
