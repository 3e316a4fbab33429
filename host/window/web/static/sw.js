// The service worker: the page opens without a network, and old and new builds do not mix.
//
//   the page's HTML      network first, else the one of this build
//   files with a hash    from a cache of any build, else the network; their content never changes
//
// A build's files are in a cache of their own before the build is used. A new build waits until a page asks for it; the cache of
// an old one goes when no page that is open is of it, so that a job worker which is restarted finds its script.

// Written by .ci/page-assemble.
const VERSION = "";
const ASSETS = [];

const scope = self.registration.scope;
// Of this page, of all pages of one server.
const prefix = `slipline ${scope} `;
const index = scope;
// How long a page may take to say of which build it is. One that is silent keeps its files.
const PATIENCE_MS = 3000;

self.addEventListener("install", (event) => event.waitUntil(precache()));
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));

async function precache() {
  const cache = await caches.open(prefix + VERSION);
  const page = await fetch(index, { cache: "reload" });
  // While a build is being put on the server, its parts may be of two builds: the browser tries again later.
  if (!page.ok || !(await page.clone().text()).includes(`data-version="${VERSION}"`)) {
    throw new Error(`the page is not of the build ${VERSION}`);
  }
  await cache.addAll(ASSETS.map((name) => new URL(name, scope).href));
  await cache.put(index, page);
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  const address = request.url.split(/[?#]/)[0];
  if (request.method !== "GET" || !address.startsWith(scope)) {
    return;
  }
  if (request.mode === "navigate" && (address === index || address === `${index}index.html`)) {
    event.respondWith(newest(request));
  } else if (/\.[0-9a-f]{16}\.[a-z0-9]+$/.test(address)) {
    event.respondWith(kept(request));
  }
});

async function newest(request) {
  try {
    // Asked of the server itself: a browser may keep the page of a build that is gone.
    const page = await fetch(request.url, { cache: "no-cache", redirect: "manual" });
    if (page.status < 500) {
      return page;
    }
  } catch {
    // No network.
  }
  const cache = await caches.open(prefix + VERSION);
  return (await cache.match(index)) ?? Response.error();
}

async function kept(request) {
  for (const name of await caches.keys()) {
    if (name.startsWith(prefix)) {
      const cache = await caches.open(name);
      const found = await cache.match(request.url, { ignoreVary: true });
      if (found) {
        return found;
      }
    }
  }
  return fetch(request);
}

self.addEventListener("message", (event) => {
  const { data } = event;
  if (data === "version") {
    event.ports[0].postMessage(VERSION);
  } else if (data === "use") {
    event.waitUntil(self.skipWaiting());
  } else if (data === "opened") {
    event.waitUntil(tidy());
  }
});

// Removes the caches of builds of which no page is.
async function tidy() {
  const names = (await caches.keys()).filter((name) => name.startsWith(prefix));
  const open = await self.clients.matchAll({ type: "window", includeUncontrolled: true });
  const versions = await Promise.all(open.filter((client) => client.url.startsWith(scope)).map(versionOf));
  const { installing, waiting } = self.registration;
  // A silent page may be of any build. A newer worker's build has its cache, too, and no page yet.
  if (versions.includes(null) || installing || waiting) {
    return;
  }
  const used = [VERSION, ...versions].map((version) => prefix + version);
  await Promise.all(names.filter((name) => !used.includes(name)).map((name) => caches.delete(name)));
}

// The build of a page; null if it does not say.
function versionOf(client) {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = ({ data }) => resolve(data);
    setTimeout(() => resolve(null), PATIENCE_MS);
    client.postMessage("version", [port2]);
  });
}
