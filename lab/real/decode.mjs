// The same file without compressed geometry: decode.mjs SOURCE TARGET

import { io } from './gltf.mjs';

const [source, target] = process.argv.slice(2);
const document = await io.read(source);
for (const extension of document.getRoot().listExtensionsUsed())
  if (/draco|meshopt/.test(extension.extensionName)) extension.dispose();
await io.write(target, document);
