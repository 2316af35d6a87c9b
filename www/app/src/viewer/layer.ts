/** One version of a model in the scene, with the ways it can be shown. */
import { Box3, BufferGeometry, Mesh, MeshBasicMaterial, Sphere, Texture, Vector3, type Material, type Object3D } from "three";
import type { Heat } from "./heat";

const HEAT = new MeshBasicMaterial({ vertexColors: true, toneMapped: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
const WIRES = new MeshBasicMaterial({ wireframe: true, color: 0x70787f, transparent: true, opacity: 0.3, toneMapped: false });

export class Layer {
  readonly meshes: Mesh[] = [];
  readonly #surfaces: { geometry: BufferGeometry; material: Material | Material[] }[];
  #hot: BufferGeometry[] | undefined;
  readonly #wires: Mesh[];

  constructor(readonly root: Object3D) {
    root.updateMatrixWorld(true);
    root.traverse((object) => {
      if (object instanceof Mesh) {
        this.meshes.push(object);
      }
    });
    this.#surfaces = this.meshes.map(({ geometry, material }) => ({ geometry, material }));
    this.#surfaces.flatMap(({ material }) => material).forEach(behindWires);
    this.#wires = this.meshes.map(wiresOf);
  }

  /** Makes the heat map showable. */
  heat(heat: Heat): void {
    this.#hot = this.#surfaces.map(({ geometry }, i) => withColors(geometry, heat.colors[i]!));
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

  show(options: { visible: boolean; wireframe: boolean; heat: boolean }): void {
    this.root.visible = options.visible;
    this.#wires.forEach((wires) => (wires.visible = options.wireframe));
    this.meshes.forEach((mesh, i) => {
      const hot = options.heat ? this.#hot?.[i] : undefined;
      mesh.geometry = hot ?? this.#surfaces[i]!.geometry;
      mesh.material = hot ? HEAT : this.#surfaces[i]!.material;
    });
  }

  dispose(): void {
    this.root.removeFromParent();
    this.#hot?.forEach((geometry) => geometry.dispose());
    for (const { geometry, material } of this.#surfaces) {
      geometry.dispose();
      [material].flat().forEach(disposeMaterial);
    }
  }
}

/** Pushes a surface back a little, so that the edges drawn on it are whole. */
function behindWires(material: Material): void {
  Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
}

/** The mesh's edges, moving with it: skins and instances are cloned with what they hang on. */
function wiresOf(mesh: Mesh): Mesh {
  const wires = mesh.clone(false);
  wires.material = WIRES;
  wires.visible = false;
  mesh.parent!.add(wires);
  return wires;
}

/** The same geometry with other vertex colours, its arrays shared. */
function withColors(geometry: BufferGeometry, colors: Heat["colors"][number]): BufferGeometry {
  const hot = new BufferGeometry();
  hot.setIndex(geometry.index);
  hot.attributes = { ...geometry.attributes, color: colors };
  hot.morphAttributes = geometry.morphAttributes;
  hot.morphTargetsRelative = geometry.morphTargetsRelative;
  hot.groups = geometry.groups;
  return hot;
}

function disposeMaterial(material: Material): void {
  for (const value of Object.values(material)) {
    if (value instanceof Texture) {
      value.dispose();
    }
  }
  material.dispose();
}
