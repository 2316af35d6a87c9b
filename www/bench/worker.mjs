// Runs in a worker of the browser: calls the package as its own worker does, and times the stages on the spot, so that
// no message's way to the page is in them.
import * as meshmark from "../meshmark/dist/index.js";
import load from "../meshmark/wasm/meshmark.js";
import loadFull from "../meshmark/wasm-full/full.js";
import loadStudy, * as study from "../app/research-wasm/research.js";

const commands = {
  key({ owner, passphrase }, clock) {
    clock.start("key");
    meshmark.deriveKey(owner, passphrase);
    return {};
  },
  embed({ model, tag, key }, clock) {
    const { report } = meshmark.embed(model, tag, key, { onProgress: clock.start });
    return { sha256: report.markedSha256 };
  },
  extract({ model, key }, clock) {
    return { tag: meshmark.detect(model, key, { onProgress: clock.start }).tag };
  },
  async compare({ suspect, original, key }, clock) {
    await meshmark.initFull();
    return { tag: meshmark.compare(suspect, original, key, { overlay: true, onProgress: clock.start }).tag };
  },
  async rank({ mesh, rankings }, clock) {
    await loadStudy();
    const ranked = rankings.map((ranking) => {
      clock.start(ranking);
      return study.rank(mesh, ranking).length;
    });
    return { ranked };
  },
};

self.addEventListener("message", async ({ data: { command, ...request } }) => {
  try {
    await meshmark.init();
    const clock = new Clock();
    const done = await commands[command](request, clock);
    clock.stop();
    const { memory } = await (command === "compare" ? loadFull : load)(); // loads nothing any more: gives the module's exports
    self.postMessage({ result: { ...done, ms: clock.ms, memoryBytes: memory.buffer.byteLength } });
  } catch (error) {
    self.postMessage({ error });
  }
});

/** The command line's clock: a stage lasts from its first report to the next stage's; one that runs twice counts both times. */
class Clock {
  ms = {};
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
      this.ms[this.#stage] = (this.ms[this.#stage] ?? 0) + performance.now() - this.#since;
      this.#stage = undefined;
    }
  }
}
