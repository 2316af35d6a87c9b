import vue from "@vitejs/plugin-vue";

const isCustomElement = (tag) => tag.startsWith("meshmark-");

export default { plugins: [vue({ template: { compilerOptions: { isCustomElement } } })] };
