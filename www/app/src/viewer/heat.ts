/** How far each vertex moved between two versions of one model, as colours. */
import { BufferAttribute, Color, SRGBColorSpace, Vector3, type Mesh } from "three";
import { colorAt } from "./colormap";

export interface Heat {
  /** Per mesh, in order. */
  colors: BufferAttribute[];
  /** The largest displacement, in scene units: the upper end of the scale. */
  max: number;
}

/** Both lists hold the same meshes in the same order, with the same vertices. Scene units, skins and morphs as they stand. */
export function heatOf(before: Mesh[], after: Mesh[]): Heat {
  const distances = after.map((mesh, i) => displacements(before[i]!, mesh));
  const max = distances.reduce((m, list) => list.reduce((a, b) => Math.max(a, b), m), 0);
  return { colors: distances.map((list) => colorsOf(list, max)), max };
}

function displacements(before: Mesh, after: Mesh): Float32Array {
  const from = new Vector3();
  const to = new Vector3();
  return Float32Array.from({ length: after.geometry.getAttribute("position").count }, (_, v) => {
    before.getVertexPosition(v, from).applyMatrix4(before.matrixWorld);
    after.getVertexPosition(v, to).applyMatrix4(after.matrixWorld);
    return from.distanceTo(to);
  });
}

function colorsOf(distances: Float32Array, max: number): BufferAttribute {
  const colors = new BufferAttribute(new Float32Array(distances.length * 3), 3);
  const color = new Color();
  distances.forEach((distance, v) => {
    color.setRGB(...colorAt(max > 0 ? distance / max : 0), SRGBColorSpace);
    colors.setXYZ(v, color.r, color.g, color.b);
  });
  return colors;
}
