// SPDX-License-Identifier: MIT
// The tables of an asset, for what this page says of it: meshlode/three keeps its own in a worker. Reads no page and no image.

const FIRST_BYTES = 65536; // as meshlode/three reads first, so that a cache may answer
const MOST_BYTES = 2 ** 30; // of tables: a tab has no memory for more
const LIMIT_MS = 30000; // within which so many bytes have to come: as meshlode/three's timeoutMs

/** At least the first `bytes` of a file, or all of it. */
async function readStart(url, bytes, abort) {
  let timer = 0;
  const arm = () => {
    clearTimeout(timer);
    timer = setTimeout(() => abort.abort(new Error(`too slow: less than ${FIRST_BYTES} bytes within ${LIMIT_MS} ms`)), LIMIT_MS);
  };
  arm();
  try {
    const response = await fetch(url, { headers: { Range: `bytes=0-${bytes - 1}` }, signal: abort.signal });
    if (!response.ok) throw new Error(`the server answers ${response.status}`);
    const parts = [];
    let [size, armed] = [0, 0];
    const reader = response.body.getReader();
    while (size < bytes) {
      const { value, done } = await reader.read();
      if (done) break;
      parts.push(value);
      size += value.length;
      if (size - armed < FIRST_BYTES) continue;
      armed = size;
      arm();
    }
    await reader.cancel(); // of a server without ranges
    return new Uint8Array(await new Blob(parts).arrayBuffer());
  } catch (error) {
    throw abort.signal.aborted ? abort.signal.reason : error;
  } finally {
    clearTimeout(timer);
  }
}

/** {asset, facts} of a file: its size is what its header says. `abort`: an AbortController, which the time limit uses too. */
export async function openHead(url, runtime, abort) {
  let head = await readStart(url, FIRST_BYTES, abort);
  if (head.length < 64) throw new Error('this is not a .lode file');
  const fileBytes = Number(new DataView(head.buffer).getBigUint64(16, true));
  const { bytes } = runtime.headBytes(head, fileBytes);
  if (bytes > MOST_BYTES) throw new Error(`its tables have ${bytes} bytes`);
  if (head.length < bytes) head = await readStart(url, bytes, abort);
  const asset = runtime.openHead(head.subarray(0, bytes), fileBytes);
  return { asset, facts: { file_bytes: fileBytes, sections: sectionsOf(head) } };
}

/** [name, bytes] of each entry of the section table, which openHead() has checked. */
function sectionsOf(head) {
  const view = new DataView(head.buffer);
  return Array.from({ length: view.getUint32(12, true) }, (_, i) => {
    const at = 64 + 64 * i;
    return [String.fromCharCode(...head.subarray(at, at + 4)), Number(view.getBigUint64(at + 24, true))];
  });
}
