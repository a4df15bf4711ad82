// Folders that are dropped or picked: listed by name and size; a file is read when the program asks for it.
//
// `tell(kind, value)` hears of 'listing' with the number of files so far, 'listed' with the folder, and 'failed' with a
// message; what it returns says whether to go on.

const MOST_FILES = 1_000_001;
// The browser is asked for each file's size by itself; of a larger folder sizes are not known.
const MOST_SIZED = 30_000;
const AT_ONCE = 128;

export function watchDroppedFolders(tell) {
  const take = (event) => {
    const items = [...(event.dataTransfer?.items ?? [])].filter((item) => item.kind === 'file');
    const entries = items.map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
    if (!entries.some((entry) => entry.isDirectory)) return;
    // The canvas would take a folder for a file; and it waits for what is held over it to be dropped or to go.
    event.preventDefault();
    event.stopPropagation();
    event.target.dispatchEvent(new DragEvent('dragleave', { bubbles: true, cancelable: true }));
    list(entries, tell).catch((error) => tell('failed', error?.message || String(error)));
  };
  window.addEventListener('drop', take, { capture: true });
}

export function pickFolder(tell) {
  const input = document.createElement('input');
  Object.assign(input, { type: 'file', webkitdirectory: true, multiple: true });
  input.onchange = () => {
    const files = [...input.files];
    const [name] = files[0]?.webkitRelativePath.split('/') ?? [''];
    const paths = files.map((file) => file.webkitRelativePath.slice(name.length + 1));
    tell('listed', { name, paths, items: files, sizes: files.map((file) => file.size) });
  };
  input.click();
}

export async function readFile(item) {
  const file = item instanceof File ? item : await fileOf(item);
  return file.arrayBuffer();
}

async function list(entries, tell) {
  const found = [];
  // Paths begin inside of a folder that was dropped alone.
  const isAlone = entries.length === 1;
  const waiting = entries.map((entry) => [entry, isAlone ? '' : entry.name]).reverse();
  while (waiting.length && found.length < MOST_FILES) {
    const [entry, path] = waiting.pop();
    if (!entry.isDirectory) {
      found.push([path, entry]);
      continue;
    }
    for (const child of await childrenOf(entry)) {
      waiting.push([child, path ? `${path}/${child.name}` : child.name]);
    }
    if (!tell('listing', found.length + waiting.length)) return;
  }
  const sizes = found.length <= MOST_SIZED ? await sizesOf(found) : found.map(() => 0);
  const [paths, items] = [0, 1].map((part) => found.map((file) => file[part]));
  tell('listed', { name: entries.find((entry) => entry.isDirectory).name, paths, items, sizes });
}

// A folder gives its entries in portions, until one is empty.
async function childrenOf(folder) {
  const reader = folder.createReader();
  const children = [];
  for (;;) {
    const portion = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!portion.length) return children;
    children.push(...portion);
  }
}

async function sizesOf(found) {
  const sizes = [];
  for (let first = 0; first < found.length; first += AT_ONCE) {
    const portion = found.slice(first, first + AT_ONCE);
    // Of what cannot be read, that is said when it is needed.
    const sizeOf = ([, entry]) => fileOf(entry).then((file) => file.size, () => 0);
    sizes.push(...(await Promise.all(portion.map(sizeOf))));
  }
  return sizes;
}

function fileOf(entry) {
  return new Promise((resolve, reject) => entry.file(resolve, reject));
}
