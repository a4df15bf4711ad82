// Starts PinPose: checks the browser, loads the wasm with a progress bar, and takes over the screen when it crashes.

const build = JSON.parse(document.getElementById('build').textContent);
const parameters = new URLSearchParams(location.search);
const canvas = document.getElementById('pinpose');
const card = document.getElementById('card');
const screen = document.getElementById('screen');
const progress = document.getElementById('progress');
const status = document.getElementById('status');

const bindgenUrl = new URL(build.script, document.baseURI).href;
const workerUrl = new URL(build.worker, document.baseURI).href;
const UPDATE_BROWSER =
  'Update this browser, or open this page in a current Chrome, Edge, Firefox or Safari.';

let module; // The compiled WebAssembly.Module, shared with the workers.
let registration; // The service worker's.
let hasCrashed = false;

// What the page offers to the wasm.
window.pinposePage = {
  buildVersion: build.version,
  wasmBytes: build.wasmBytes,
  startedAt: 0, // The navigation, on the clock of performance.now().
  workerUrl,
  updateReady: false,
  createWorker,
  applyUpdate,
  claim,
  canPickFolder: 'showDirectoryPicker' in window,
  pickExportFolder,
  writeToFolder,
  crashed: showCrash,
};

window.addEventListener('error', ({ error }) => {
  if (error instanceof WebAssembly.RuntimeError) showCrash(error.stack || error.message);
});
window.addEventListener('unhandledrejection', ({ reason }) => {
  if (reason instanceof WebAssembly.RuntimeError) showCrash(reason.stack || reason.message);
});

// WebGPU reports a lost device to the wasm; of a lost WebGL context only the canvas is told.
canvas.addEventListener('webglcontextlost', () => {
  showCrash('The connection to the graphics card was lost (WebGL context lost).');
});

// Combinations that browsers have commands of their own for would leave the page, or open a bar over it. What people need of
// the browser itself stays: copy, paste and cut, reload, tabs and windows, and its tools.
const LEFT_TO_THE_BROWSER = ['KeyC', 'KeyV', 'KeyX', 'KeyR', 'KeyT', 'KeyW', 'KeyN', 'KeyQ', 'Tab'];
window.addEventListener('keydown', (event) => {
  const { code, altKey, ctrlKey, metaKey, shiftKey } = event;
  const tools = shiftKey && ['KeyI', 'KeyJ', 'KeyC'].includes(code);
  const command = (ctrlKey || metaKey) && /^Key[A-Z]$/.test(code) && !tools;
  const alternate = altKey && (code.startsWith('Arrow') || /^Key[A-Z]$/.test(code) || code.startsWith('Bracket'));
  if (alternate || (command && !LEFT_TO_THE_BROWSER.includes(code))) event.preventDefault();
});

card.classList.add('loading');
boot();

async function boot() {
  const options = await chooseRenderer();
  if (!options) return;
  let pinpose;
  try {
    [pinpose, module] = await Promise.all([import(bindgenUrl), loadModule()]);
  } catch (error) {
    showLoadFailure(error);
    return;
  }
  status.textContent = 'Starting…';
  try {
    await pinpose.default({ module_or_path: module });
    await pinpose.start(canvas, options);
  } catch (error) {
    showCrash(error?.message || String(error));
    return;
  }
  if (hasCrashed) return;
  card.hidden = true;
  registerServiceWorker();
}

// The options for the wasm's `start`, or nothing after showing what is missing.
async function chooseRenderer() {
  if (!window.WebAssembly?.compileStreaming) {
    showMissing('This browser cannot run WebAssembly, which PinPose is made of.', UPDATE_BROWSER);
    return null;
  }
  const wanted = parameters.get('renderer');
  const bare = parameters.has('bare');
  const isForced = wanted === 'webgpu' || wanted === 'webgl';
  if (wanted !== 'webgl' && (await hasWebGpu())) return { renderer: isForced ? 'webgpu' : 'auto', bare };
  if (wanted === 'webgpu') {
    showMissing(
      'The address asks for WebGPU, which this browser does not offer on this computer.',
      'PinPose can draw with WebGL instead.',
      link('Open without ?renderer=webgpu', addressWithout('renderer')),
    );
    return null;
  }
  if (hasWebGl2()) return { renderer: 'webgl', bare };
  showMissing(
    'PinPose draws with the graphics card, through WebGPU or WebGL 2, and this browser offers neither.',
    'Turn on hardware acceleration in the browser’s settings. ' + UPDATE_BROWSER,
    button('Try again', () => location.reload()),
  );
  return null;
}

async function hasWebGpu() {
  try {
    return Boolean(await navigator.gpu?.requestAdapter());
  } catch {
    return false;
  }
}

function hasWebGl2() {
  const context = document.createElement('canvas').getContext('webgl2');
  // Browsers allow few contexts at a time; this one is not needed any more.
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return Boolean(context);
}

async function loadModule() {
  const response = await fetch(build.wasm);
  if (!response.ok) throw new TypeError(`The server answered ${response.status} for ${build.wasm}`);
  const megabytes = (bytes) => (bytes / 1e6).toFixed(1);
  let received = 0;
  const counter = new TransformStream({
    transform(chunk, controller) {
      // Content-Length would be the compressed size; these are the bytes as they are unpacked.
      received += chunk.byteLength;
      progress.value = received / build.wasmBytes;
      status.textContent = `Loading… ${megabytes(received)} of ${megabytes(build.wasmBytes)} MB`;
      controller.enqueue(chunk);
    },
  });
  // The header is set here because not every web server knows the type.
  const counted = new Response(response.body.pipeThrough(counter), {
    headers: { 'Content-Type': 'application/wasm' },
  });
  return WebAssembly.compileStreaming(counted);
}

// Makes this page the only one that has `name`, until it claims another name or goes; false if another page keeps it. A page
// that is just going, as on a reload, is waited for.
const CLAIM_PATIENCE_MS = 1500;
let claimed = { name: null, release() {} };
let claims = 0;
function claim(name) {
  if (!navigator.locks || claimed.name === name) return Promise.resolve(true);
  claimed.release();
  claimed = { name: null, release() {} };
  const number = ++claims;
  return new Promise((resolve) => {
    // What comes when something else was claimed meanwhile is given back at once.
    const hold = () =>
      new Promise((release) => {
        if (number !== claims) return release(resolve(false));
        claimed = { name, release };
        resolve(true);
      });
    navigator.locks.request(name, { signal: AbortSignal.timeout(CLAIM_PATIENCE_MS) }, hold).catch(() => resolve(false));
  });
}

// A folder to write into, or null where the user picks none.
async function pickExportFolder() {
  try {
    return await window.showDirectoryPicker({ mode: 'readwrite' });
  } catch (error) {
    if (error.name === 'AbortError') return null;
    throw error;
  }
}

async function writeToFolder(folder, path, bytes) {
  const names = path.split('/');
  const fileName = names.pop();
  for (const name of names) folder = await folder.getDirectoryHandle(name, { create: true });
  const file = await folder.getFileHandle(fileName, { create: true });
  const stream = await file.createWritable();
  await stream.write(bytes);
  await stream.close();
}

// A worker that is loading the module already; it takes `{id, request}` at once, and answers when it is ready.
function createWorker() {
  const worker = new Worker(workerUrl, { type: 'module' });
  worker.postMessage({ bindgenUrl, module });
  return worker;
}

function showLoadFailure(error) {
  console.error(error);
  if (error instanceof WebAssembly.CompileError) {
    showMissing('This browser’s WebAssembly is too old for PinPose.', UPDATE_BROWSER);
    return;
  }
  showScreen('The page could not be loaded', [
    paragraph('The connection broke off, or the server did not answer. Nothing is lost.'),
    actions(button('Retry', () => location.reload())),
  ]);
}

function showMissing(what, advice, action) {
  const parts = [paragraph(what), paragraph(advice)];
  if (action) parts.push(actions(action));
  showScreen('This browser cannot run it yet', parts);
}

// The first crash is the cause; what follows it are consequences.
function showCrash(message) {
  console.error(message);
  if (hasCrashed) return;
  hasCrashed = true;
  const details = element('pre', message);
  details.tabIndex = 0;
  const save = button('Save the poses as a file', () => {});
  save.disabled = true;
  const note = paragraph('Looking for saved poses…');
  showScreen('Stopped because of an error in the program', [
    details,
    actions(
      button('Reload (your work is saved)', () => location.reload()),
      save,
      link('Start with an empty scene', '?empty'),
    ),
    note,
  ]);
  offerSavedPoses(save, note);
}

async function offerSavedPoses(save, note) {
  let json;
  try {
    json = await readSavedPoses();
  } catch (error) {
    note.textContent = `The saved poses could not be read: ${error?.message ?? error}`;
    return;
  }
  if (!json) {
    note.textContent = 'There are no saved poses in this browser.';
    return;
  }
  note.remove();
  save.disabled = false;
  save.onclick = () => {
    const file = link('', URL.createObjectURL(new Blob([json], { type: 'application/json' })));
    file.download = 'pinpose-recovered.json';
    file.click();
  };
}

// The last open scene's document as JSON, read without the wasm, which is not to be trusted any more. The stores are
// described in src/platform/web/indexed_db.rs.
async function readSavedPoses() {
  const database = await openDatabase();
  if (!database?.objectStoreNames.contains('documents')) return null;
  const read = (store, key) => {
    if (!database.objectStoreNames.contains(store)) return undefined;
    return answered(database.transaction(store).objectStore(store).get(key));
  };
  const candidates = parameters.has('example')
    ? ['example']
    : [ofThisTab('pinpose last_open'), await read('state', 'last_open'), 'current'];
  for (const id of candidates.filter(Boolean)) {
    const document = await read('documents', id);
    if (!document) continue;
    const scene = await read('scenes', id);
    return newerJournal(id, scene?.changedAtMs ?? 0) ?? document.json;
  }
  return null;
}

function openDatabase() {
  return new Promise((resolve, reject) => {
    const opening = indexedDB.open('pinpose');
    // There was no database. Leave it so: the app makes it with the stores that it needs.
    opening.onupgradeneeded = () => {
      opening.transaction.abort();
      resolve(null);
    };
    opening.onerror = () => reject(opening.error);
    opening.onsuccess = () => resolve(opening.result);
  });
}

function answered(request) {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

function ofThisTab(key) {
  try {
    return sessionStorage.getItem(key);
  } catch {
    // The user has turned this storage off.
    return null;
  }
}

// What was put aside when the page was hidden, if it is newer than what is stored: its time, a line break, the document.
function newerJournal(id, changedAtMs) {
  try {
    const [, time, json] = localStorage.getItem(`pinpose journal ${id}`)?.match(/^([^\n]*)\n([^]*)$/) ?? [];
    return Number(time) > changedAtMs ? json : undefined;
  } catch {
    return undefined;
  }
}

// Only once the page runs: keeping it for offline use must not compete with loading it.
async function registerServiceWorker() {
  if (!window.isSecureContext || !navigator.serviceWorker) return;
  try {
    registration = await navigator.serviceWorker.register('sw.js', { updateViaCache: 'none' });
  } catch (error) {
    // A private window, or storage that is full: PinPose works as well, only not offline.
    console.warn('PinPose is not kept for offline use:', error);
    return;
  }
  if (registration.waiting) announceUpdate();
  registration.addEventListener('updatefound', () => {
    const incoming = registration.installing;
    incoming.addEventListener('statechange', () => {
      if (incoming.state === 'installed') announceUpdate();
    });
  });
}

function announceUpdate() {
  // Without a controller this is the first visit, and what was installed is what runs.
  if (!navigator.serviceWorker.controller) return;
  window.pinposePage.updateReady = true;
  window.dispatchEvent(new Event('pinpose-update'));
}

function applyUpdate() {
  navigator.serviceWorker.addEventListener('controllerchange', () => location.reload(), { once: true });
  registration.waiting?.postMessage('skip-waiting');
}

function showScreen(title, parts) {
  canvas.hidden = true;
  card.hidden = false;
  card.classList.remove('loading');
  screen.replaceChildren(element('h2', title), ...parts);
  screen.setAttribute('role', 'alert');
}

function addressWithout(parameter) {
  const rest = new URLSearchParams(parameters);
  rest.delete(parameter);
  return `${location.pathname}?${rest}`;
}

function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function paragraph(text) {
  return element('p', text);
}

function button(text, onclick) {
  return Object.assign(element('button', text), { onclick });
}

function link(text, href) {
  return Object.assign(element('a', text), { href });
}

function actions(...items) {
  const row = element('div', '');
  row.className = 'actions';
  row.append(...items);
  return row;
}
