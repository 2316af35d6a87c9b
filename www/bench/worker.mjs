// Runs in a worker of the browser: calls the package as its own worker does, and times the stages on the spot, so that
// the way of a message to the page is not in them.
import * as meshmark from "../meshmark/dist/index.js";
import load from "../meshmark/wasm/meshmark.js";

self.addEventListener("message", async ({ data: { command, model, owner, passphrase, tag } }) => {
  await meshmark.init();
  const clock = new Clock();
  clock.start("key");
  const key = meshmark.deriveKey(owner, passphrase);
  clock.stop();
  const result = { embed: () => embed(model, tag, key, clock), extract: () => extract(model, key, clock) }[command]();
  const { memory } = await load(); // the module's exports: it is loaded already
  self.postMessage({ ...result, ms: clock.milliseconds, memoryBytes: memory.buffer.byteLength });
});

function embed(model, tag, key, clock) {
  const marked = meshmark.embed(model, undefined, tag, key, undefined, clock.start);
  clock.stop();
  return { sha256: marked.report.markedSha256, model: marked.model };
}

function extract(model, key, clock) {
  const evidence = meshmark.measure(model, undefined, clock.start);
  clock.start("test");
  const reading = meshmark.extract(evidence, key);
  clock.stop();
  return { tag: reading.tag };
}

/** The command line's clock: a stage lasts from its first report to the next stage's; one that runs twice counts both times. */
class Clock {
  milliseconds = {};
  #stage;
  #since;

  start = (stage) => {
    if (stage !== this.#stage) {
      this.stop();
      this.#stage = stage;
      this.#since = performance.now();
    }
  };

  stop() {
    if (this.#stage) {
      this.milliseconds[this.#stage] = (this.milliseconds[this.#stage] ?? 0) + performance.now() - this.#since;
      this.#stage = undefined;
    }
  }
}
