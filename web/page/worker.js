// The page's worker: the same wasm, for jobs that would freeze the tab. See `createWorker` in boot.js.

// The first message says what to load; a promise for the module's `run_job` from then on.
let loaded;

// The wasm's panic hook leaves its message here just before the trap that ends the job.
let panic = '';
self.pinposePage = { crashed: (message) => { panic = message; } };

async function load({ bindgenUrl, module }) {
  const pinpose = await import(bindgenUrl);
  await pinpose.default({ module_or_path: module });
  return pinpose.run_job;
}

self.onmessage = async ({ data }) => {
  if (!loaded) {
    loaded = load(data);
    // Every job reports a failed load; there is nobody to tell before the first.
    loaded.catch(() => {});
    return;
  }
  try {
    const runJob = await loaded;
    const reply = runJob(data.request);
    self.postMessage({ id: data.id, reply }, [reply.buffer]);
  } catch (error) {
    // The module's memory is in an unknown state now: whoever reads this starts a fresh worker.
    self.postMessage({ id: data.id, crash: panic || String(error) });
  }
};
