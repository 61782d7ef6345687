// SPDX-License-Identifier: GPL-3.0-or-later
// The object for three and its requests in Node, without a browser: what the pool holds, options, ends, and answers of servers.
// object_checks.mjs FOLDER runs it alone; FOLDER/node_modules has three and meshlode.
import { createServer } from 'node:http';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const MESH = { origin: [0, 0, 0], boundsMin: [0, 0, 0], boundsMax: [1, 1, 1], normalMode: 0, uvSetSource: [], hasColor: false };
const INSTANCE = { transform: new Float64Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]), mesh: 0, flags: 0 };
const renderer = { getDrawingBufferSize: (size) => size.set(800, 600) };

/** A worker that the test speaks for. */
class FakeWorker {
  sent = [];
  ends = 0;
  postMessage(message) {
    this.sent.push(message);
  }
  terminate() {
    ++this.ends;
  }
}
const cluster = (id, material) => ({ cluster: id, mesh: 0, positions: new Float32Array(9), normals: null, uvs: [], colors: null,
  pieces: [{ material, triangles: new Uint8Array([0, 1, 2]) }] });
const selection = (dropped, id = 0) => ({ type: 'selection', id, dropped, drawn: null, query: {}, resident: new Uint32Array(1),
  statistics: { bytesRead: 0, missing: 0, isLoading: false } });

async function openFake({ loadLode }, materialCount, slot, options = {}) {
  const worker = new FakeWorker();
  const opened = loadLode('http://localhost/none', { ...options, createWorker: () => worker });
  const materials = Array.from({ length: materialCount }, (_, i) => ({ name: `${i}`, sourceIndex: i, alphaMode: 0, alphaCutoff: 0.5,
    doubleSided: false, baseColor: [1, 1, 1, 1] }));
  const say = (data) => worker.onmessage({ data });
  say({ type: 'opened', meshes: [MESH], materials, instances: [INSTANCE], scene: {}, slot, pageCount: 1000 });
  return { worker, say, lode: await opened };
}
const heldBytes = (lode) => lode.children.reduce((sum, { geometry }) =>
  sum + [...Object.values(geometry.attributes), geometry.index].reduce((all, one) => all + (one?.array.byteLength ?? 0), 0), 0);

async function checkPool(three, expect) {
  const slot = { vertices: 256, triangles: 128 };
  const slotBytes = 12 * slot.vertices + 6 * slot.triangles; // positions, and indices of 16 or 32 bits
  const many = await openFake(three, 500, slot);
  for (let i = 0; i < 500; ++i) many.say({ type: 'page', page: i, clusters: [cluster(i, i)] });
  const share = heldBytes(many.lode) / (500 * slotBytes);
  expect(share <= 1.5, `pool: 500 materials of a cluster each hold ${share.toFixed(2)} times their slots`);
  many.lode.dispose();
  const moving = await openFake(three, 20, slot);
  let most = 0;
  for (let m = 0; m < 20; ++m) {
    moving.say({ type: 'page', page: m, clusters: Array.from({ length: 100 }, (_, i) => cluster(100 * m + i, m)) });
    if (m > 0) moving.say(selection([m - 1]));
    most = Math.max(most, heldBytes(moving.lode) / (100 * slotBytes));
  }
  expect(moving.lode.children.length === 1 && most <= 3, `pool: of 20 materials one after another there is ${moving.lode.children.length} batch, ${
    most.toFixed(2)} times the slots`);
  moving.lode.dispose();
  // More than a batch has, page after page exchanged.
  const long = await openFake(three, 1, { vertices: 3, triangles: 1 });
  let id = 0;
  const add = (page) => long.say({ type: 'page', page, clusters: Array.from({ length: 1000 }, () => cluster(id++, 0)) });
  for (let page = 0; page < 34; ++page) add(page);
  const before = long.lode.children.length;
  for (let page = 34; page < 110; ++page) {
    long.say(selection([page - 34]));
    add(page);
  }
  expect(before === 2 && long.lode.children.length === 2, `pool: ${before} batches of 34,000 clusters are ${long.lode.children.length} after 76 pages more`);
  long.lode.dispose();
}

export async function checkObject({ folder, expect }) {
  const at = (path) => pathToFileURL(join(folder, 'node_modules', path)).href;
  const three = await import(at('meshlode/three/index.js'));
  await checkPool(three, expect);
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  let failures = 0;
  const expect = (holds, what) => {
    console.log(`${holds ? 'holds' : 'FAILED'}: ${what}`);
    failures += !holds;
  };
  await checkObject({ folder: resolve(process.argv[2]), expect });
  process.exit(failures === 0 ? 0 : 1);
}
