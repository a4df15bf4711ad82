// The service worker: after one visit the page opens without a network.
// `cargo web build` writes two lines above these: VERSION, and FILES, the paths that make up this version.

const CACHE_PREFIX = `pinpose ${self.registration.scope} `;
const CACHE = CACHE_PREFIX + VERSION;
const FILE_URLS = new Set(FILES.map((path) => absolute(path)));
const PAGE_URL = absolute('./');
const DEMO_URL = absolute('demo/');

self.addEventListener('install', (event) => event.waitUntil(keepThisVersion()));
self.addEventListener('activate', (event) => event.waitUntil(dropOtherVersions()));

self.addEventListener('message', (event) => {
  if (event.data === 'skip-waiting') self.skipWaiting();
});

self.addEventListener('fetch', (event) => {
  const url = new URL(event.request.url);
  if (event.request.method !== 'GET' || !url.href.startsWith(self.registration.scope)) return;
  const file = fileUrl(url);
  if (FILE_URLS.has(file)) event.respondWith(fromCacheFirst(file, event.request));
  else event.respondWith(fromNetworkFirst(event.request));
});

function absolute(path) {
  return new URL(path, self.registration.scope).href;
}

// What a request asks for, whatever its query: `?example` and `index.html` are the page too.
function fileUrl(url) {
  const address = url.origin + url.pathname;
  return address === absolute('index.html') ? PAGE_URL : address;
}

async function keepThisVersion() {
  const cache = await caches.open(CACHE);
  // Hashed names may come from the browser's own cache, which has just loaded them; the rest is asked for again.
  const isHashed = (path) => /-[0-9a-f]{10}[._]/.test(path);
  await cache.addAll(FILES.map((path) => new Request(path, { cache: isHashed(path) ? 'default' : 'no-cache' })));
  // While a site is being updated, this script and the page may come from different versions: try again later.
  const page = await (await cache.match(PAGE_URL)).text();
  if (!page.includes(VERSION)) {
    await caches.delete(CACHE);
    throw new Error(`The page is not of version ${VERSION}`);
  }
}

async function dropOtherVersions() {
  const names = await caches.keys();
  const others = names.filter((name) => name.startsWith(CACHE_PREFIX) && name !== CACHE);
  await Promise.all(others.map((name) => caches.delete(name)));
}

async function fromCacheFirst(url, request) {
  const cache = await caches.open(CACHE);
  return (await cache.match(url)) ?? fetch(request);
}

async function fromNetworkFirst(request) {
  const cache = await caches.open(CACHE);
  try {
    const response = await fetch(request);
    if (response.ok && request.url.startsWith(DEMO_URL)) await cache.put(request, response.clone());
    return response;
  } catch (error) {
    const kept = await cache.match(request);
    if (kept) return kept;
    throw error;
  }
}
