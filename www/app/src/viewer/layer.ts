/** One version of a model in the scene, with the ways it can be shown. */
import { Box3, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial, MeshStandardMaterial, Sphere, Texture, Vector3, type BufferAttribute, type Material, type Object3D } from "three";
import type { Heat } from "./heat";
import { smoothNormals } from "./normals";

/** `surface`: the file's materials. `clay`: none. `raking`: clay under a low light. `heat`: how far each vertex moved. */
export type Shading = "surface" | "clay" | "raking" | "heat";

/** Which normals the clay is shaded with: those that the geometry has, or those that the file says it has. */
export type Normals = "geometry" | "file";

const BEHIND_WIRES = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }; // so that edges drawn on a surface are whole
export const HEAT = new MeshBasicMaterial({ vertexColors: true, toneMapped: false, ...BEHIND_WIRES });
export const CLAY = new MeshStandardMaterial({ color: 0xb9b4aa, roughness: 1, ...BEHIND_WIRES });
const CLAY_SHEET = CLAY.clone(); // seen from both sides
CLAY_SHEET.side = DoubleSide;
export const WIRES = new MeshBasicMaterial({ wireframe: true, color: 0x70787f, transparent: true, opacity: 0.3, toneMapped: false });

export class Layer {
  readonly meshes: Mesh[] = [];
  /** Whether every mesh comes with normals of its own. */
  readonly hasNormals: boolean;
  /** Whether a material of the file mirrors its surroundings. */
  readonly hasMirrors: boolean;
  readonly #surfaces: { geometry: BufferGeometry; material: Material | Material[] }[];
  #hot: BufferGeometry[] | undefined;
  #smooth: BufferGeometry[] | undefined;
  readonly #wires: Mesh[];

  constructor(readonly root: Object3D) {
    root.updateMatrixWorld(true);
    root.traverse((object) => {
      if (object instanceof Mesh) {
        this.meshes.push(object);
      }
    });
    this.hasNormals = this.meshes.every(({ geometry }) => geometry.hasAttribute("normal"));
    this.#surfaces = this.meshes.map(({ geometry, material }) => ({ geometry, material }));
    const materials = this.#surfaces.flatMap(({ material }) => material);
    materials.forEach((material) => Object.assign(material, BEHIND_WIRES));
    this.hasMirrors = materials.some((material) => material instanceof MeshStandardMaterial && material.metalness > 0);
    this.#wires = this.meshes.map(wiresOf);
  }

  /** Makes the heat map showable. */
  heat(heat: Heat): void {
    this.#hot?.forEach((geometry) => geometry.dispose());
    this.#hot = this.#with("color", heat.colors);
  }

  /** A tight sphere about the model as it stands, centred in its box. */
  bounds(): Sphere {
    const sphere = new Box3().setFromObject(this.root, true).getBoundingSphere(new Sphere());
    if (this.meshes.length === 0) {
      return sphere; // points and lines alone
    }
    const point = new Vector3();
    let radius = 0;
    for (const mesh of this.meshes) {
      for (let v = 0; v < mesh.geometry.getAttribute("position").count; v++) {
        radius = Math.max(radius, mesh.getVertexPosition(v, point).applyMatrix4(mesh.matrixWorld).distanceTo(sphere.center));
      }
    }
    return new Sphere(sphere.center, radius);
  }

  show(look: { visible: boolean; wireframe: boolean; shading: Shading; normals: Normals }): void {
    this.root.visible = look.visible;
    this.#wires.forEach((wires) => (wires.visible = look.wireframe));
    if (look.visible) {
      const geometries = this.#geometries(look.shading, look.normals);
      this.meshes.forEach((mesh, i) => {
        const own = this.#surfaces[i]!;
        mesh.geometry = geometries?.[i] ?? own.geometry;
        mesh.material = isClay(look.shading) ? clayFor(own.material) : geometries ? HEAT : own.material;
      });
    }
  }

  /** What takes the place of the meshes' own geometries, if anything does. */
  #geometries(shading: Shading, normals: Normals): BufferGeometry[] | undefined {
    if (isClay(shading) && normals === "geometry") {
      return (this.#smooth ??= this.#with("normal", smoothNormals(this.meshes)));
    }
    return shading === "heat" ? this.#hot : undefined;
  }

  /** The meshes' geometries with one attribute in place of their own, the other arrays shared. */
  #with(name: "color" | "normal", attributes: BufferAttribute[]): BufferGeometry[] {
    return this.#surfaces.map(({ geometry }, i) => {
      const changed = new BufferGeometry();
      changed.setIndex(geometry.index);
      changed.attributes = { ...geometry.attributes, [name]: attributes[i]! };
      changed.morphAttributes = geometry.morphAttributes;
      changed.morphTargetsRelative = geometry.morphTargetsRelative;
      changed.groups = geometry.groups;
      return changed;
    });
  }

  dispose(): void {
    this.root.removeFromParent();
    for (const geometry of [...(this.#hot ?? []), ...(this.#smooth ?? [])]) {
      geometry.dispose();
    }
    for (const { geometry, material } of this.#surfaces) {
      geometry.dispose();
      [material].flat().forEach(disposeMaterial);
    }
  }
}

function isClay(shading: Shading): boolean {
  return shading === "clay" || shading === "raking";
}

function clayFor(material: Material | Material[]): Material {
  return [material].flat().some(({ side }) => side === DoubleSide) ? CLAY_SHEET : CLAY;
}

/** The mesh's edges, moving with it: skins and instances are cloned with what they hang on. */
function wiresOf(mesh: Mesh): Mesh {
  const wires = mesh.clone(false);
  wires.material = WIRES;
  wires.visible = false;
  mesh.parent!.add(wires);
  return wires;
}

function disposeMaterial(material: Material): void {
  for (const value of Object.values(material)) {
    if (value instanceof Texture) {
      value.dispose();
    }
  }
  material.dispose();
}
