using Workerd = import "/workerd/workerd.capnp";

const config :Workerd.Config = (
  services = [(name = "stamp", worker = .stamp)],
  sockets = [(name = "http", address = "127.0.0.1:0", http = (), service = "stamp")],
);

const stamp :Workerd.Worker = (
  modules = [
    (name = "worker.js", esModule = embed "dist/worker.js"),
    (name = "meshmark/full.wasm", wasm = embed "dist/full.wasm"),
    (name = "model.plan", data = embed "dist/model.plan"),
  ],
  compatibilityDate = "2026-11-01",
);
