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

const slot = { vertices: 3, triangles: 1 };
const inTime = (promise) => Promise.race([promise, new Promise((done) => setTimeout(done, 300, 'a hang'))])
  .then((value) => (value === 'a hang' ? value : 'ok'), (error) => (error.name === 'LodeError' ? error.place : `${error}`));

async function checkOptions({ loadLode }, expect) {
  const bad = [{ poolBytes: NaN }, { poolBytes: -1 }, { poolBytes: '9' }, { pixelError: NaN }, { pixelError: null }, { margin: NaN }, { timeoutMs: -1 }];
  let made = 0;
  const createWorker = () => (++made, new FakeWorker());
  const ends = await Promise.all(bad.map((options) => inTime(loadLode('http://localhost/', { ...options, createWorker }))));
  expect(ends.every((place) => place === 'options') && made === 0, `options: no numbers are refused: ${ends.join(', ')}`);
  const { lode, worker } = await openFake({ loadLode }, 1, slot, { pixelError: undefined, poolBytes: undefined, timeoutMs: Infinity });
  const { poolBytes, timeoutMs } = worker.sent[0].options;
  expect(lode.pixelError === 1 && poolBytes === 2 ** 28 && timeoutMs === Infinity, 'options: undefined is the default');
}

async function checkEnds(three, THREE, expect) {
  const { Lode, loadLode } = three;
  const worker = new FakeWorker();
  const address = await inTime(loadLode('http://[', { createWorker: () => worker }));
  expect(address === 'worker' && worker.sent.length === 0 && worker.ends <= 1, `ends: an address that is none: ${address}`);
  const refusing = Object.assign(new FakeWorker(), { postMessage() {
    throw new Error('cannot be cloned');
  } });
  const clone = await inTime(loadLode('http://localhost/', { createWorker: () => refusing }));
  expect(clone === 'worker' && refusing.ends === 1, `ends: headers that cannot be sent: ${clone}, the worker is ended ${refusing.ends} times`);
  const none = await inTime(loadLode('http://localhost/', { createWorker() {
    throw new Error('none');
  } }));
  expect(none === 'worker', `ends: a worker that cannot be made: ${none}`);
  const early = new Lode('http://localhost/', { createWorker: () => new FakeWorker(), pixelError: 1, margin: 0 });
  early.dispose();
  const disposed = await inTime(early.opened);
  expect(disposed === 'worker', `ends: disposed of before it is opened: ${disposed}`);

  const one = await openFake(three, 1, slot);
  let reason = 'nothing';
  try {
    one.lode.clone();
  } catch (error) {
    reason = error.message;
  }
  expect(/^clone: /.test(reason), `ends: clone: ${reason}`);
  one.lode.addEventListener('error', () => {});
  one.lode.update(new THREE.PerspectiveCamera(), renderer);
  one.say({ type: 'error', place: 'worker', reason: 'out of memory', isFatal: true });
  expect(one.lode.isSettled && one.worker.ends === 1, 'ends: after a fatal error it is settled');
  one.lode.dispose();
  let closed = 0;
  one.say({ type: 'image', image: 0, bitmap: { close: () => ++closed } });
  expect(closed === 1, 'ends: an image that comes after dispose() is closed');
}

/** The error that is sent, where the object lies below a parent: that of the worst direction. */
async function checkStretch(three, THREE, expect) {
  const cases = [['turned and scaled', [3, 3, 3], [0.4, 1, 2], [1, 1, 1], 1, 3], ['scaled by 1, 1, 10', [1, 1, 10], [0, 0, 0], [1, 1, 1], 0.1, 10],
    ['sheared', [1, 10, 1], [0, 0, Math.PI / 4], [1, 1, 1], 0.1, 10], ['turned between scales', [2, 10, 5], [0, 0, Math.PI / 2], [5, 1, 2], 0.04, 50],
    ['a needle', [1, 1e-9, 1e-9], [0, 0, 0], [1, 1, 1], 1e-9, 1]];
  for (const [what, outer, turn, inner, ratio, most] of cases) {
    const { lode, worker } = await openFake(three, 1, slot);
    const parent = new THREE.Group();
    parent.scale.set(...outer);
    parent.add(lode);
    lode.rotation.set(...turn);
    lode.scale.set(...inner);
    const camera = new THREE.PerspectiveCamera();
    lode.update(camera, renderer);
    const { pixelError, view } = worker.sent.at(-1);
    const isNear = (value, due) => Math.abs(value - due) < 1e-6 * due;
    expect(isNear(pixelError, ratio) && isNear(view.nearDistance, camera.near / most), `stretch: ${what}: ${pixelError} of a pixel, near ${view.nearDistance}`);
  }
}

/** Answers that are not what was asked for; `type` of a response is basic where a page's own origin sends it. */
async function checkServers({ RangeSource }, expect) {
  const file = Buffer.from(Array.from({ length: 200000 }, (_, i) => i % 251));
  const plainFetch = globalThis.fetch;
  const ask = async (answer, use, options = { timeoutMs: 2000 }) => {
    const state = { requests: 0, closed: 0 };
    const server = createServer((request, response) => {
      const [, first, last] = /bytes=(\d+)-(\d+)/.exec(request.headers.range).map(Number);
      const part = file.subarray(first, last + 1);
      answer({ response, part, first, count: ++state.requests, range: `bytes ${first}-${first + part.length - 1}/${file.length}` });
    });
    await new Promise((done) => server.listen(0, '127.0.0.1', done));
    const source = new RangeSource(`http://127.0.0.1:${server.address().port}/`, options);
    let said;
    try {
      said = await use(source);
    } catch (error) {
      said = error.message;
    }
    server.closeAllConnections();
    server.close();
    return { said, source, ...state };
  };
  const first = (source) => source.read(0, 65536, true).then((bytes) => bytes.length);

  const long = await ask(({ response }) => response.writeHead(206, { 'Content-Range': 'bytes 0-99/100' }).end(Buffer.alloc(5000)), first);
  expect(/more bytes came/.test(long.said), `servers: 5000 bytes of a range of 100: ${long.said}`);
  const open = await ask(({ response, part, range }) => response.writeHead(206, { 'Content-Range': range }).write(part), first, { timeoutMs: 500 });
  expect(open.said === 65536 && open.requests === 1, `servers: a connection that stays open behind the range: ${open.said} bytes, ${open.requests} request`);
  const limits = [Infinity, 2 ** 40].map((timeoutMs) => ask(({ response, part, range }) =>
    setTimeout(() => response.writeHead(206, { 'Content-Range': range }).end(part), 50), first, { timeoutMs }));
  expect((await Promise.all(limits)).every(({ said, requests }) => said === 65536 && requests === 1), 'servers: no time limit');

  // 200 after 206: no more than the known size is read, and once for all requests.
  const wholeAfter = (body, headers = {}) => ({ response, part, range, count }) => {
    if (count === 1) return response.writeHead(206, { 'Content-Range': range }).end(part);
    response.writeHead(200, headers);
    for (let at = 0; at < body.length; at += 50000) setTimeout(() => response.write(body.subarray(at, at + 50000)), at / 5000);
    setTimeout(() => response.end(), body.length / 5000 + 20);
  };
  const four = async (source) => {
    await first(source);
    const ends = await Promise.allSettled([70000, 90000, 110000, 130000].map((at) => source.read(at, 1000)));
    return ends.map(({ value, reason }) => reason?.message ?? value.length).join('; ');
  };
  const endless = await ask(wholeAfter(Buffer.alloc(50e6)), four);
  expect(/more bytes came/.test(endless.said) && endless.source.bytesRead < 3e6, `servers: 50 MB for a file of 0.2 are not read: ${endless.source.bytesRead} bytes`);
  const shared = await ask(wholeAfter(file), four);
  expect(shared.said === '1000; 1000; 1000; 1000' && shared.source.bytesRead === 65536 + file.length, `servers: four answers of 200 are read once: ${
    shared.source.bytesRead} bytes`);
  globalThis.fetch = (...args) => plainFetch(...args).then((response) => Object.defineProperty(response, 'type', { value: 'basic' }));
  const early = await ask(wholeAfter(file, { 'Content-Length': 5e9 }), four);
  expect(/more bytes came/.test(early.said) && early.source.bytesRead === 65536, `servers: a Content-Length above the size is refused unread: ${early.said}`);
  globalThis.fetch = plainFetch;
  // Another origin shows Content-Length, which is of the encoded bytes, and hides Content-Encoding.
  globalThis.fetch = (...args) => plainFetch(...args).then(({ status, body }) => ({ status, body, type: 'cors', headers: new Headers({ 'Content-Length': '500' }) }));
  const hidden = await ask(({ response }) => response.writeHead(200).end(file), first);
  expect(hidden.said === 65536, `servers: encoded bytes of another origin: ${hidden.said}`);
  globalThis.fetch = plainFetch;
}

export async function checkObject({ folder, expect }) {
  const at = (path) => pathToFileURL(join(folder, 'node_modules', path)).href;
  const three = await import(at('meshlode/three/index.js'));
  const THREE = await import(at('three/build/three.module.js'));
  await checkPool(three, expect);
  await checkOptions(three, expect);
  await checkEnds(three, THREE, expect);
  await checkStretch(three, THREE, expect);
  await checkServers(await import(at('meshlode/stream/source.js')), expect);
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
