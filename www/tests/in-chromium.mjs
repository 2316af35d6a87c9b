// three.js in Chromium opens models as a shop's page does, with the decoders that it brings; and exports what it shows.
import { launch } from "./browser.mjs";

const ORIGIN = "http://shop.test";
const SHOP = `<!doctype html><title>shop</title>
<script type="importmap">{ "imports": { "three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/" } }</script>
<canvas width="320" height="240"></canvas>
<script type="module">
import { AmbientLight, Box3, Color, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { DRACOLoader } from "three/addons/loaders/DRACOLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

const canvas = document.querySelector("canvas");
const renderer = new WebGLRenderer({ canvas, preserveDrawingBuffer: true });
const draco = new DRACOLoader().setDecoderPath("/three/examples/jsm/libs/draco/gltf/");
const loader = new GLTFLoader().setDRACOLoader(draco).setMeshoptDecoder(MeshoptDecoder);

function draw(model) {
  const box = new Box3().setFromObject(model);
  const [middle, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3()).length()];
  const scene = new Scene().add(model, new AmbientLight(0xffffff, 1), new DirectionalLight(0xffffff, 3));
  scene.background = new Color(0xff00ff);
  const camera = new PerspectiveCamera(40, 4 / 3, size / 100, 10 * size);
  camera.position.copy(middle).addScaledVector(new Vector3(0.5, 0.4, 1).normalize(), 1.5 * size);
  camera.lookAt(middle);
  renderer.render(scene, camera);
  const pixels = new Uint8Array(4 * 320 * 240);
  const { RGBA, UNSIGNED_BYTE } = renderer.getContext();
  renderer.getContext().readPixels(0, 0, 320, 240, RGBA, UNSIGNED_BYTE, pixels);
  let seen = 0;
  for (let i = 0; i < pixels.length; i += 4) seen += pixels[i + 1] > 0 || pixels[i] < 255;
  return { seen: seen / (320 * 240), size };
}

globalThis.show = async () => {
  const { scene } = await loader.loadAsync("/model/model.glb");
  let triangles = 0;
  scene.traverse(({ isMesh, geometry }) => { if (isMesh) triangles += (geometry.index ?? geometry.attributes.position).count / 3; });
  const drawn = draw(scene);
  const bytes = new Uint8Array(await new GLTFExporter().parseAsync(scene, { binary: true }));
  return { ...drawn, triangles, picture: canvas.toDataURL(), exported: bytes.toBase64?.() ?? btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")) };
};
</script>`;

/** A page that opens models, one after the other. */
export async function openShop() {
  const browser = await launch();
  const page = await browser.newPage();
  let files = {};
  const errors = [];
  page.on("pageerror", ({ message }) => errors.push(message));
  await page.route("**/*", (route) => {
    const { pathname } = new URL(route.request().url());
    const name = decodeURIComponent(pathname);
    if (name.startsWith("/three/")) {
      return route.fulfill({ path: new URL(`../node_modules${name}`, import.meta.url).pathname });
    }
    if (name.startsWith("/model/")) {
      const bytes = files[name.slice("/model/".length)];
      return bytes ? route.fulfill({ body: Buffer.from(bytes) }) : route.fulfill({ status: 404 });
    }
    return route.fulfill({ contentType: "text/html", body: SHOP });
  });
  await page.goto(ORIGIN);
  await page.waitForFunction(() => "show" in globalThis);
  return {
    /** What three.js shows of a model: `{ triangles, size, seen, picture, exported }`; `seen` is the part of the picture that it covers. */
    async show({ model, files: beside = {} }) {
      files = { ...beside, "model.glb": model };
      const { picture, exported, ...shown } = await page.evaluate(() => globalThis.show());
      return { ...shown, picture: Buffer.from(picture.split(",")[1], "base64"), exported: new Uint8Array(Buffer.from(exported, "base64")), errors };
    },
    close: () => browser.close(),
  };
}
