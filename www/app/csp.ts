/** The page's Content-Security-Policy, sent as a header and written into the page. It is what makes "nothing leaves this tab" checkable. */
export const CONTENT_SECURITY_POLICY = [
  "default-src 'self'", // nothing from, and nothing to, any other origin
  "connect-src 'self' blob:", // three.js fetches a model's buffers and textures from blob: URLs
  "script-src 'self' 'wasm-unsafe-eval'", // WebAssembly may be compiled, JavaScript text may not
  "img-src 'self' blob: data:", // three.js decodes textures from blob: URLs, or data: URIs where it has no ImageBitmap
  "worker-src 'self'", // the package's worker and the service worker are files
  "style-src 'self'", // no inline styles
  "base-uri 'none'", // not covered by default-src: a <base> would redirect relative URLs
  "form-action 'none'", // not covered by default-src: a form must not post anywhere
].join("; ");
