// SPDX-License-Identifier: MIT
// The worker of meshlode/three behind a link of chosen bandwidth and latency: slow_worker.js?ADDRESS_OF_THREE_WORKER. A message
// {type: 'link', bytesPerSecond, latencyMs} sets the link; all others go to the worker proper.
const link = { bytesPerSecond: Infinity, latencyMs: 0 };
const CHUNK_BYTES = 16384; // what comes at once; at 1 Mbit/s every 130 ms
const plainFetch = self.fetch;
let freeAt = 0; // when the link has sent all that was asked of it: requests share it

const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

async function* slowed(body) {
  freeAt = Math.max(freeAt, performance.now()); // not for each chunk: what a timer is late for, the next chunks make up
  for await (const part of body) {
    for (let at = 0; at < part.length; at += CHUNK_BYTES) {
      const chunk = part.subarray(at, at + CHUNK_BYTES);
      freeAt += (1000 * chunk.length) / link.bytesPerSecond;
      const wait = freeAt - performance.now();
      if (wait > 4) await sleep(wait); // timers are no finer
      yield chunk;
    }
  }
}

self.fetch = async (...args) => {
  const { signal, headers } = args[1] ?? {};
  if (!headers?.Range) return plainFetch(...args); // the module, which a page has in its cache
  if (link.latencyMs > 0) await sleep(link.latencyMs);
  const response = await plainFetch(...args);
  if (!response.body || link.bytesPerSecond === Infinity) return response;
  const chunks = slowed(readAll(response.body));
  const stream = new ReadableStream({
    async pull(controller) {
      if (signal?.aborted) return controller.error(signal.reason);
      try {
        const { value, done } = await chunks.next();
        if (done) controller.close();
        else controller.enqueue(value);
      } catch (error) {
        controller.error(error);
      }
    },
    cancel: () => chunks.return(),
  }, { highWaterMark: 0 });
  return new Response(stream, { status: response.status, headers: response.headers });
};
/** Not every browser iterates over a body. */
async function* readAll(body) {
  const reader = body.getReader();
  try {
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      yield value;
    }
  } finally {
    await reader.cancel().catch(() => {});
  }
}

// Messages that come while the worker proper is loaded wait for it.
let waiting = [];
addEventListener('message', (event) => {
  const isLink = event.data.type === 'link';
  if (isLink) Object.assign(link, event.data);
  else waiting?.push(event);
  if (isLink || waiting) event.stopImmediatePropagation();
});
import(decodeURIComponent(location.search.slice(1))).then(
  () => {
    const events = waiting;
    waiting = null;
    for (const event of events) self.onmessage(event);
  },
  (error) => postMessage({ type: 'error', place: 'worker', reason: error.message, isFatal: true }),
);
