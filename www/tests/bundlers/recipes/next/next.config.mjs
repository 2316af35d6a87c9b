import { fileURLToPath } from "node:url";

export default {
  output: "export", // static files, as the other pages are
  turbopack: { root: fileURLToPath(new URL("../..", import.meta.url)) }, // these pages share a folder of packages
};
