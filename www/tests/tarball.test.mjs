// What `npm publish` would publish, installed in an empty project and used there.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { packageFolder } from "./support.mjs";

const project = mkdtempSync(join(tmpdir(), "meshmark-consumer-"));
let packed;

function run(command, args, cwd = project) {
  const { status, stdout, stderr } = spawnSync(command, args, { cwd, encoding: "utf8" });
  assert.equal(status, 0, `${command} ${args.join(" ")}\n${stdout}${stderr}`);
  return stdout;
}

before(() => {
  [packed] = JSON.parse(run("npm", ["pack", "--json", "--silent", "--pack-destination", project], fileURLToPath(packageFolder)).replace(/^[^[]*/, ""));
  writeFileSync(join(project, "package.json"), JSON.stringify({ name: "consumer", private: true, type: "module" }));
  run("npm", ["install", "--offline", "--no-audit", "--no-fund", "--silent", packed.filename]);
});

after(() => rmSync(project, { recursive: true }));

test("it holds the built files, the module, words and licences, and nothing else", () => {
  const files = packed.files.map(({ path }) => path);
  const expected = /^(package\.json|README\.md|LICENSE-(MIT|APACHE)|dist\/\w+\.(js|d\.ts)|wasm-full\/(full\.js|full\.d\.ts|full_bg\.wasm(\.d\.ts)?)|wasm\/(meshmark\.js|meshmark\.d\.ts|meshmark_bg\.wasm(\.d\.ts)?))$/;
  assert.deepEqual(files.filter((file) => !expected.test(file)), []);
  for (const needed of ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "dist/index.js", "dist/client.js", "dist/worker.js", "wasm/meshmark_bg.wasm", "wasm-full/full_bg.wasm", "dist/elements.js"]) {
    assert.ok(files.includes(needed), needed);
  }
});

test("it says where its sources, its page and its issues are", () => {
  const { repository, homepage, bugs } = JSON.parse(readFileSync(join(project, "node_modules/meshmark/package.json"), "utf8"));
  assert.deepEqual(repository, { type: "git", url: "git+https://github.com/meshmark/meshmark.git", directory: "www/meshmark" });
  assert.match(homepage, /^https:\/\/github\.com\/meshmark\/meshmark/);
  assert.match(bugs.url ?? bugs, /^https:\/\/github\.com\/meshmark\/meshmark\/issues$/);
});

test("every export resolves, types come first, and no workspace reference is left", () => {
  const manifest = JSON.parse(readFileSync(join(project, "node_modules/meshmark/package.json"), "utf8"));
  assert.doesNotMatch(JSON.stringify(manifest), /workspace:/);
  for (const [name, target] of Object.entries(manifest.exports)) {
    const branch = typeof target === "string" ? { default: target } : target;
    if (typeof target === "object") {
      assert.equal(Object.keys(target)[0], "types", name);
    }
    for (const file of Object.values(branch)) {
      assert.ok(packed.files.some(({ path }) => `./${path}` === file), `${name}: ${file}`);
    }
  }
});

test("the README's example marks a model and reads the mark", () => {
  const readme = readFileSync(join(project, "node_modules/meshmark/README.md"), "utf8");
  const [, example] = /```js\n(.*?)```/s.exec(readme);
  writeFileSync(join(project, "example.mjs"), example);
  assert.match(run(process.execPath, ["example.mjs"]), /^found JANE-1\n$/);
});

for (const [module, moduleResolution] of [["NodeNext", "NodeNext"], ["ESNext", "Bundler"]]) {
  test(`its types compile with moduleResolution ${moduleResolution}`, () => {
    writeFileSync(
      join(project, "consumer.ts"),
      `import { init, embed, type Embedding } from "meshmark";
       import { createClient } from "meshmark/client";
       import "meshmark/worker";
       await init();
       const marked: Embedding = embed(new Uint8Array(), "A", new Uint8Array(32));
       const client = await createClient();
       const reading = await client.extract(await client.measure(marked.model), new Uint8Array(32));
       reading.verdict === "found";`,
    );
    const compiler = fileURLToPath(new URL("../node_modules/typescript/bin/tsc", import.meta.url));
    const options = ["--strict", "--noEmit", "--skipLibCheck", "false", "--target", "ES2022", "--lib", "ES2022,DOM"];
    run(process.execPath, [compiler, ...options, "--module", module, "--moduleResolution", moduleResolution, "consumer.ts"]);
  });
}
