// A mesh of any number of vertices.

/** A long torus with bumps and no symmetry, of `around` times `across` vertices, its triangles turned outwards. */
export function torus(around, across) {
  const positions = new Float64Array(3 * around * across);
  const triangles = [];
  for (let i = 0; i < around; i++) {
    for (let j = 0; j < across; j++) {
      const [u, v] = [(i / around) * 2 * Math.PI, (j / across) * 2 * Math.PI];
      const radius = 0.4 + 0.05 * Math.sin(u + 0.3) + 0.03 * Math.sin(2 * u + v) + 0.02 * Math.sin(7 * u) * Math.cos(3 * v);
      positions.set([1.5 * Math.cos(u) * (1 + radius * Math.cos(v)), Math.sin(u) * (1 + radius * Math.cos(v)), radius * Math.sin(v)], 3 * (i * across + j));
      const corner = (a, b) => ((i + a) % around) * across + ((j + b) % across);
      triangles.push(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1));
    }
  }
  return { positions, triangles: Uint32Array.from(triangles) };
}
