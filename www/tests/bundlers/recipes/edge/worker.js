// At download: `prepare` gave the plan once, this stamps a copy of it. Both stay secret.
import { initFull, stamp } from "meshmark";
import full from "meshmark/full.wasm";
import plan from "./model.plan";

export default {
  async fetch(request) {
    await initFull(full);
    // Write the number and its buyer into your ledger before you give the copy away.
    const number = Number(new URL(request.url).searchParams.get("number"));
    const { model } = stamp(new Uint8Array(plan), number);
    return new Response(model, { headers: { "Content-Type": "model/gltf-binary" } });
  },
};
