// meshoptimizer's simplifier on every primitive, whatever the error: meshoptimizer.mjs SOURCE TARGET simplify|simplifySloppy KEPT%
//
// Attributes other than positions go first: where they are discontinuous, it would simplify less than it is asked to.

import { prune, weld } from '@gltf-transform/functions';
import { MeshoptSimplifier } from 'meshoptimizer';
import { io } from './gltf.mjs';

const ANY_ERROR = 1; // of the mesh's extent

const [source, target, method, kept] = process.argv.slice(2);
const document = await io.read(source);
await MeshoptSimplifier.ready;
const primitives = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives());
for (const primitive of primitives)
  for (const name of primitive.listSemantics())
    if (name !== 'POSITION') primitive.setAttribute(name, null);
await document.transform(weld());
for (const primitive of primitives) {
  const accessor = primitive.getIndices();
  const positions = Float32Array.from(primitive.getAttribute('POSITION').getArray());
  const indices = Uint32Array.from(accessor.getArray());
  const count = 3 * Math.floor((indices.length / 3) * (parseFloat(kept) / 100));
  const settings = method === 'simplifySloppy' ? [null, count, ANY_ERROR] : [count, ANY_ERROR];
  const [simplified] = MeshoptSimplifier[method](indices, positions, 3, ...settings);
  primitive.setIndices(accessor.clone().setArray(simplified));
}
await document.transform(prune());
await io.write(target, document);
