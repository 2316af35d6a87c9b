import { fileURLToPath } from "node:url";

const path = (name) => fileURLToPath(new URL(name, import.meta.url));

export default {
  mode: "production",
  entry: path("main.js"),
  output: { path: path("dist") },
};
