// SPDX-License-Identifier: MIT
// The worker of meshlode/three and meshlode/webgpu: reads the head, selects what to draw of the resident pages, reads and unpacks pages, and drops them. A page is resident
// once its message is sent: messages arrive in order, so a selection never comes before its pages or after they are dropped.
import { INFINITE_ERROR, NONE, loadRuntime } from '../index.js';
import { LodeError, RangeSource } from './source.js';

const FIRST_BYTES = 65536; // holds small assets' heads; of a larger head the rest is a second request
const FLIGHTS = 4; // requests at once: browsers allow 6 per host over HTTP/1.1, and images need one
const RUN_BYTES = 524288; // of neighbouring pages in one request: 4 to 6 pages; 40 ms at 100 Mbit/s, longer than a round trip
const GAP_BYTES = 16; // pages start at multiples of this
const TYPES = ['image/png', 'image/jpeg', 'image/webp', 'image/avif'];

class Streamer {
  #source;
  #runtime;
  #asset = null;
  #selector;
  #promise;
  #isRaw; // pages are sent as they are decoded on a GPU, and not as floats
  #poolBytes;
  #slotBytes; // of a cluster; of a page, where those are raw
  #query = null;
  #resident;
  #cost; // per page, resident or being read
  #used = 0;
  #flying = new Set();
  #flights = 0;
  #failed = new Set();
  #images = [];
  #isReadingImage = false;
  #isDue = false;
  #drawn = { instances: [], clusters: [] };
  #unpackMs = 0;

  async open({ file, options }) {
    this.#source = new RangeSource(file, options);
    this.#poolBytes = options.poolBytes;
    this.#isRaw = options.isRaw === true;
    const runtime = (this.#runtime = await loadRuntime(options.module));
    const first = await this.#source.read(0, FIRST_BYTES, true);
    // Where another origin hides the size of its file, the header has it.
    this.#source.fileBytes ??= first.length < FIRST_BYTES ? first.length : Number(new DataView(first.buffer).getBigUint64(16, true));
    const { fileBytes } = this.#source;
    let need = inPlace('head', () => runtime.headBytes(first, fileBytes));
    let head = await this.#source.read(0, need.bytes);
    // A section table beyond the first bytes, which no writer makes.
    if (!need.isKnown) head = await this.#source.read(0, (need = inPlace('head', () => runtime.headBytes(head, fileBytes))).bytes);
    const asset = inPlace('head', () => runtime.openHead(head, fileBytes));
    const promise = options.promise || undefined;
    inPlace('promise', () => asset.checkPromise(promise));
    this.#promise = promise;
    this.#asset = asset;
    this.#selector = asset.createSelector();
    this.#resident = new Uint32Array(Math.ceil(asset.pages.length / 32));
    this.#cost = new Float64Array(asset.pages.length);
    const slot = asset.largestCluster();
    const floats = asset.meshes.map((mesh) => 3 + 3 * (mesh.normalMode === 1) + 2 * mesh.uvSetCount + 4 * mesh.hasColor);
    this.#slotBytes = 4 * slot.vertices * floats.reduce((a, b) => Math.max(a, b), 0) + 12 * slot.triangles;
    const { meshes, materials, instances, pages } = asset;
    if (this.#isRaw) {
      this.#slotBytes = pages.reduce((most, { bytes }) => Math.max(most, bytes), 0);
      const tables = { groups: asset.tableWords('groups', promise), clusters: asset.tableWords('clusters') };
      const reaches = meshes.map((_, mesh) => asset.reachOf(mesh));
      postMessage({ type: 'opened', meshes, materials, instances, pages, ...tables, reaches, slot, slotBytes: this.#slotBytes });
      return this.#schedule();
    }
    const scene = inPlace('scene', () => asset.scene);
    postMessage({ type: 'opened', meshes, materials, instances, scene, slot, pageCount: pages.length });
    this.#schedule(); // a camera that came before
  }

  /** Selects for a camera; each is answered. */
  view(query) {
    this.#query = query;
    this.#schedule();
  }
  images({ images }) {
    this.#images = images;
  }
  retry() {
    this.#failed.clear();
    this.#schedule();
  }

  #schedule() {
    if (this.#isDue || !this.#asset) return;
    this.#isDue = true;
    // Behind the messages in the queue: the newest camera counts.
    setTimeout(() => guard(() => {
      this.#isDue = false;
      if (this.#query) this.#choose();
      this.#readImage();
    }));
  }

  #choose() {
    const { view, frustum, pixelError, id } = this.#query;
    const select = () => this.#selector.select({ ...view, promise: this.#promise }, pixelError, this.#resident, frustum);
    const start = performance.now();
    let drawn = this.#drawn;
    try {
      drawn = select();
    } catch (error) {
      if (error.status !== 'usage') throw error;
      this.#query = null; // not a camera: the last selection stays
      fail(new LodeError('camera', error.message));
      return postMessage({ type: 'answer', id });
    }
    const selectMs = performance.now() - start;
    const { pages, priorities } = this.#selector.requests;
    const { dropped, isFull, isRedrawn } = this.#load(pages, priorities, this.#selector.pagePriorities);
    if (isRedrawn) drawn = select();
    const isSame = isEqual(drawn.instances, this.#drawn.instances) && isEqual(drawn.clusters, this.#drawn.clusters);
    this.#drawn = drawn;
    const { bytesRead, requests, fileBytes } = this.#source;
    const missing = pages.filter((page) => !this.#failed.has(page)).length;
    const statistics = { selectMs, unpackMs: this.#unpackMs, moduleBytes: this.#runtime.memoryBytes, bytesRead, fileBytes, requests,
      poolUsed: this.#used, missing, failed: this.#failed.size, isFull, isLoading: this.#flights > 0 || this.#isReadingImage || this.#images.length > 0 };
    postMessage({ type: 'selection', id, dropped, drawn: isSame ? null : drawn, query: { view, frustum, pixelError },
      resident: this.#resident.slice(), statistics });
  }

  /** Reads the pages of the highest priority, and drops those of a lower one for them. */
  #load(pages, priorities, all) {
    const isLost = (page) => {
      if (this.#asset.pageDependencies(page).some((one) => this.#failed.has(one))) this.#failed.add(page);
      return this.#failed.has(page);
    };
    const wanted = new Map(Array.from(pages, (page, i) => [page, priorities[i]]).filter(([page]) => !isLost(page)));
    // The coarsest geometry comes first and alone: the whole picture before its details.
    const isFirst = [...wanted.values()][0] === INFINITE_ERROR;
    const dropped = [];
    let isRedrawn = false;
    let spare = null; // resident pages by falling priority
    const take = (page) => {
      const priority = wanted.get(page);
      if (priority === undefined || this.#flying.has(page) || (isFirst && priority !== INFINITE_ERROR)) return false;
      const cost = (this.#isRaw ? 1 : this.#asset.pages[page].clusterCount) * this.#slotBytes;
      const isSpare = (one) => (this.#resident[one >> 5] >>> (one & 31)) & 1 && all[one] !== INFINITE_ERROR;
      spare ??= [...this.#asset.pages.keys()].filter(isSpare).sort((a, b) => all[b] - all[a]);
      while (priority !== INFINITE_ERROR && this.#used + cost > this.#poolBytes) {
        const last = spare.at(-1);
        if (last === undefined || all[last] >= priority) return false;
        spare.pop();
        dropped.push(last);
        isRedrawn ||= all[last] > 0;
        this.#resident[last >> 5] &= ~(1 << (last & 31));
        this.#used -= this.#cost[last];
      }
      this.#cost[page] = cost;
      this.#used += cost;
      this.#flying.add(page);
      return true;
    };
    let isFull = false;
    for (const [page, priority] of wanted) {
      if (this.#flights >= FLIGHTS || (isFirst && priority !== INFINITE_ERROR)) break;
      if (this.#flying.has(page)) continue;
      isFull = !take(page);
      if (isFull) break;
      this.#read(this.#runAround(page, take));
    }
    return { dropped, isFull, isRedrawn };
  }

  /** A page and its neighbours that are wanted too, for one request. */
  #runAround(page, take) {
    const { pages } = this.#asset;
    const end = (p) => pages[p].offset + pages[p].storedBytes;
    let [first, last] = [page, page];
    const fits = (low, high) => pages[high] && pages[low] && end(high) - pages[low].offset <= RUN_BYTES;
    while (fits(first, last + 1) && pages[last + 1].offset - end(last) < GAP_BYTES && take(last + 1)) ++last;
    while (fits(first - 1, last) && pages[first].offset - end(first - 1) < GAP_BYTES && take(first - 1)) --first;
    return { first, last, offset: pages[first].offset, bytes: end(last) - pages[first].offset };
  }

  async #read({ first, last, offset, bytes }) {
    ++this.#flights;
    let failure;
    const stored = await this.#source.read(offset, bytes).catch((error) => void (failure = error));
    --this.#flights;
    guard(() => {
      for (let page = first; page <= last; ++page) {
        this.#flying.delete(page);
        const at = this.#asset.pages[page].offset - offset;
        if (stored) failure = this.#unpack(page, stored.subarray(at, at + this.#asset.pages[page].storedBytes));
        if (!failure) continue;
        this.#failed.add(page);
        this.#used -= this.#cost[page];
        fail(new LodeError(`page ${page}`, failure.message), { page });
      }
    });
    this.#schedule();
  }

  /** Sends the clusters of a page. Returns the error of a broken page; others end the worker. */
  #unpack(page, stored) {
    const start = performance.now();
    const asset = this.#asset;
    try {
      asset.unpackPage(page, stored);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw error;
      return error;
    }
    this.#resident[page >> 5] |= 1 << (page & 31);
    if (this.#isRaw) {
      const bytes = asset.pageBytes(page);
      asset.dropPage(page);
      this.#unpackMs += performance.now() - start;
      postMessage({ type: 'page', page, bytes }, [bytes.buffer]);
      return null;
    }
    const buffers = new Set();
    const clusters = [];
    const { firstCluster, clusterCount } = asset.pages[page];
    for (let cluster = firstCluster; cluster < firstCluster + clusterCount; ++cluster) {
      const { positions, normals, uvs, colors, triangles, triangleMaterials } = asset.decodeFloats(cluster);
      const pieces = splitByMaterial(triangles, triangleMaterials);
      clusters.push({ cluster, mesh: asset.meshOf(cluster), positions, normals, uvs, colors, pieces });
      for (const array of [positions, normals, ...uvs, colors, ...pieces.map((one) => one.triangles)]) if (array) buffers.add(array.buffer);
    }
    asset.dropPage(page);
    this.#unpackMs += performance.now() - start;
    postMessage({ type: 'page', page, clusters }, [...buffers]);
    return null;
  }

  /** One image at a time, after the coarsest geometry. */
  async #readImage() {
    if (this.#isReadingImage || this.#images.length === 0 || !this.#query) return;
    if (this.#drawn.clusters.length === 0 && this.#flights > 0) return;
    this.#isReadingImage = true;
    const image = this.#images.shift();
    try {
      const blob = this.#asset.blobOfImage(image);
      if (blob === NONE) throw new Error('is not in the asset');
      const { offset, bytes: size, mimeType } = this.#asset.blobs[blob];
      const bytes = (await this.#source.read(offset, size)).slice();
      this.#asset.checkBlob(blob, bytes);
      if (TYPES.includes(mimeType)) {
        const options = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };
        const bitmap = await createImageBitmap(new Blob([bytes], { type: mimeType }), options);
        postMessage({ type: 'image', image, bitmap }, [bitmap]);
      } else {
        postMessage({ type: 'image', image, bytes, mimeType }, [bytes.buffer]);
      }
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) guard(() => Promise.reject(error));
      else fail(new LodeError(`image ${image}`, error.message), { image });
    }
    this.#isReadingImage = false;
    this.#schedule();
  }
}

const isEqual = (a, b) => a.length === b.length && a.every((value, i) => value === b[i]);
/** [{material, triangles}]: one for nearly all clusters. */
const splitByMaterial = (triangles, materials) =>
  Array.from(new Set(materials), (material) => ({ material, triangles: triangles.filter((_, i) => materials[Math.floor(i / 3)] === material) }));

function inPlace(place, call) {
  try {
    return call();
  } catch (error) {
    throw error instanceof WebAssembly.RuntimeError ? error : new LodeError(place, error.message);
  }
}
const fail = (error, detail = {}) =>
  postMessage({ type: 'error', place: error.place ?? 'worker', reason: error.reason ?? error.message, ...detail });
/** An unexpected error (out of memory) is reported and ends the streaming: the module must not be used again. */
let isOver = false;
async function guard(call) {
  if (isOver) return;
  try {
    await call();
  } catch (error) {
    isOver = true;
    fail(error, { isFatal: true });
  }
}

const streamer = new Streamer();
onmessage = ({ data }) => guard(() => streamer[data.type](data));
