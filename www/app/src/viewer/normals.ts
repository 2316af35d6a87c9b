/** Normals as the geometry has them, whatever the file says: they show a displacement that the file's own normals hide. */
import { BufferAttribute, Matrix3, Vector3, type Mesh } from "three";

/**
 * Smooth vertex normals, one attribute a mesh, in the mesh's own space as NORMAL is: the mean of the triangles around a
 * place, weighted by their areas, across the seams of texture coordinates and of meshes. Skins and morphs at rest.
 */
export function smoothNormals(meshes: Mesh[]): BufferAttribute[] {
  const places = placesOf(meshes);
  const first = firstAtPlace(places);
  const sums = sumNormals(meshes, places, first);
  let start = 0;
  return meshes.map((mesh) => {
    const count = mesh.geometry.getAttribute("position").count;
    const toLocal = new Matrix3().setFromMatrix4(mesh.matrixWorld).transpose(); // undoes the renderer's inverse transpose
    const normals = new BufferAttribute(new Float32Array(count * 3), 3);
    const normal = new Vector3();
    for (let v = 0; v < count; v++) {
      normal.fromArray(sums, first[start + v]! * 3).applyMatrix3(toLocal).normalize();
      normals.setXYZ(v, normal.x, normal.y, normal.z);
    }
    start += count;
    return normals;
  });
}

/** World positions of all meshes' vertices, one after another, as `x y z`. */
function placesOf(meshes: Mesh[]): Float32Array {
  const total = meshes.reduce((sum, { geometry }) => sum + geometry.getAttribute("position").count, 0);
  const places = new Float32Array(total * 3);
  const point = new Vector3();
  let at = 0;
  for (const { geometry, matrixWorld } of meshes) {
    const positions = geometry.getAttribute("position");
    for (let v = 0; v < positions.count; v++, at += 3) {
      point.fromBufferAttribute(positions, v).applyMatrix4(matrixWorld).toArray(places, at);
    }
  }
  return places;
}

/** For each vertex, one that stands for all that are at the same place. */
function firstAtPlace(places: Float32Array): Uint32Array {
  const compare = (a: number, b: number) =>
    places[a * 3]! - places[b * 3]! || places[a * 3 + 1]! - places[b * 3 + 1]! || places[a * 3 + 2]! - places[b * 3 + 2]!;
  const order = Uint32Array.from({ length: places.length / 3 }, (_, v) => v).sort(compare);
  const first = new Uint32Array(order.length);
  order.forEach((vertex, i) => {
    const previous = order[i - 1];
    first[vertex] = previous !== undefined && compare(previous, vertex) === 0 ? first[previous]! : vertex;
  });
  return first;
}

/** At each vertex that stands for a place, the sum of its triangles' normals, each as long as twice the triangle's area. */
function sumNormals(meshes: Mesh[], places: Float32Array, first: Uint32Array): Float64Array {
  const sums = new Float64Array(places.length);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  let start = 0;
  for (const { geometry, matrixWorld } of meshes) {
    const { index } = geometry;
    const count = geometry.getAttribute("position").count;
    const outward = Math.sign(matrixWorld.determinant()); // a mirror turns triangles round
    const corner = (i: number) => start + (index ? index.getX(i) : i);
    for (let i = 0; i + 2 < (index?.count ?? count); i += 3) {
      const corners = [corner(i), corner(i + 1), corner(i + 2)] as const;
      a.fromArray(places, corners[0] * 3);
      b.fromArray(places, corners[1] * 3).sub(a);
      c.fromArray(places, corners[2] * 3).sub(a);
      b.cross(c).multiplyScalar(outward);
      for (const vertex of corners) {
        const at = first[vertex]! * 3;
        sums[at]! += b.x;
        sums[at + 1]! += b.y;
        sums[at + 2]! += b.z;
      }
    }
    start += count;
  }
  return sums;
}
