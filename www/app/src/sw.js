// The service worker: after the first visit the page works without a network. The build fills in the two constants.
const CACHE = "meshmark-__VERSION__";
const FILES = ["__FILES__"];

self.addEventListener("install", (event) => {
  const requests = FILES.map((file) => new Request(file, { cache: "reload" }));
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(requests)));
});

self.addEventListener("activate", (event) => {
  event.waitUntil(dropOtherVersions().then(() => self.clients.claim()));
});

self.addEventListener("fetch", (event) => {
  if (event.request.method === "GET" && new URL(event.request.url).origin === self.location.origin) {
    event.respondWith(fromCacheFirst(event.request));
  }
});

async function dropOtherVersions() {
  const names = await caches.keys();
  await Promise.all(names.filter((name) => name.startsWith("meshmark-") && name !== CACHE).map((name) => caches.delete(name)));
}

async function fromCacheFirst(request) {
  // A server's "Vary: Origin" would tell a script's request from the one that filled the cache; the files are the same.
  const page = request.url.replace(/\/index\.html(?=[?#]|$)/, "/"); // the page's other name
  return (await caches.match(page, { ignoreSearch: true, ignoreVary: true })) ?? fetch(request);
}
