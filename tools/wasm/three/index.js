// SPDX-License-Identifier: MIT
// meshlode/three: a .lode asset as an object of three that streams. The worker decides; this side owns what three draws.
import * as THREE from 'three';
import { Batch } from './batch.js';
import { Materials } from './materials.js';
import { LodeError } from '../stream/source.js';
export { LodeError };

const DEFAULTS = {
  pixelError: 1, // pixels of the drawing buffer
  poolBytes: 256 * 2 ** 20, // of geometry: 6.5 million triangles in clusters like the dragon's
  margin: 0.1, // of the view volume on each side: a turn by 6 degrees, which two frames at 180 degrees per second are
  timeoutMs: 30000, // of a request
};

/** Opens an asset by its head. `file`: an address or a Blob. Rejects with a LodeError, which has the place; later errors are events. */
export async function loadLode(file, options = {}) {
  const all = { ...DEFAULTS };
  for (const [name, value] of Object.entries(options)) if (value !== undefined) all[name] = value;
  const wrong = Object.keys(DEFAULTS).find((name) => !(typeof all[name] === 'number' && all[name] >= 0));
  if (wrong) throw new LodeError('options', `${wrong} is no number of at least 0`);
  const lode = new Lode(file, all);
  try {
    await lode.opened;
    return lode;
  } catch (error) {
    lode.dispose();
    throw error instanceof LodeError ? error : new LodeError('worker', error.message);
  }
}

/** The largest singular value of the matrix of three columns: the largest eigenvalue of its square, by the closed form. */
function stretchOf(axes) {
  const mean = axes.reduce((sum, axis) => sum + axis.lengthSq() / 3, 0);
  const rest = axes.flatMap((a, i) => axes.map((b, k) => a.dot(b) - (i === k ? mean : 0)));
  const width = Math.sqrt(rest.reduce((sum, value) => sum + (value * value) / 6, 0));
  const cosine = width > 0 ? new THREE.Matrix3().fromArray(rest).determinant() / (2 * width ** 3) : 1;
  return Math.sqrt(mean + 2 * width * Math.cos(Math.acos(THREE.MathUtils.clamp(cosine, -1, 1)) / 3));
}

export class Lode extends THREE.Object3D {
  /** The last selection: instances and clusters, and the view and resident pages that they were selected by. */
  drawn = null;
  statistics = null;
  boundingBox = new THREE.Box3();
  #options;
  #worker = null;
  #reject;
  #materials = null;
  #tables = null;
  #matrices = []; // of instances; mirrored ones in the space of their batch
  #isMirrored = [];
  #uses = []; // per mesh: whether plain and mirrored instances have it
  #batches = [];
  #clusters = new Map(); // cluster -> its pieces in batches
  #pages = new Map(); // page -> its clusters
  #asked = null; // the last camera
  #next = null;
  #isAnswered = true;
  #ids = 0;

  constructor(file, options) {
    super();
    this.name = 'lode';
    this.#options = options;
    this.pixelError = options.pixelError;
    this.opened = new Promise((resolve, reject) => {
      this.#reject = reject;
      const { headers, credentials, timeoutMs, poolBytes, promise, module } = options;
      const source = file instanceof Blob ? file : new URL(file, globalThis.document?.baseURI).href;
      const worker = (this.#worker = options.createWorker?.() ?? new Worker(new URL('../stream/worker.js', import.meta.url), { type: 'module' }));
      worker.onmessage = ({ data }) => {
        if (this.#tables || !this.#worker) return this.#take(data);
        if (data.type === 'error') return reject(new LodeError(data.place, data.reason));
        try {
          resolve(this.#open(data));
        } catch (error) {
          reject(new LodeError('scene', error.message)); // opening an asset does not check its texts
        }
      };
      worker.onerror = ({ message: reason = 'cannot be started' }) =>
        worker.onmessage({ data: { type: 'error', place: 'worker', reason, isFatal: true } });
      worker.postMessage({ type: 'open', file: source, options: { headers, credentials, timeoutMs, poolBytes, promise, module } });
    });
  }

  /** Materials of the asset. Change one before it is first drawn: others may be cloned from it. */
  get materials() {
    return this.#materials.list;
  }
  /** Whether the selection for the last camera is drawn and nothing is being loaded. */
  get isSettled() {
    if (!this.#worker) return true; // nothing comes any more
    return this.#isAnswered && this.#next === null && this.statistics !== null && !this.statistics.isLoading;
  }
  /** To be called before each frame: sends the camera to the worker where it or this object has moved. */
  update(camera, renderer) {
    if (!this.#worker) return;
    const query = this.#queryOf(camera, renderer);
    const key = JSON.stringify(query);
    if (key === this.#asked) return;
    [this.#asked, this.#next] = [key, query];
    this.#ask();
  }
  /** Requests failed pages again. */
  retry() {
    this.#worker?.postMessage({ type: 'retry' });
  }
  /** Ends the worker and frees GPU memory; the object must not be used afterwards. */
  dispose() {
    this.#end();
    this.#reject(new LodeError('worker', 'is disposed of')); // nothing, once it is opened
    for (const { batch } of this.#batches) batch.dispose();
    this.#batches = [];
    for (const map of [this.#clusters, this.#pages]) map.clear();
    this.#materials?.dispose();
    this.removeFromParent();
  }
  #end() {
    this.#worker?.terminate();
    this.#worker = null;
  }
  clone() {
    throw new LodeError('clone', 'two objects cannot have one worker: call loadLode again');
  }

  #ask() {
    if (!this.#next || !this.#isAnswered) return;
    this.#isAnswered = false;
    this.#worker.postMessage({ type: 'view', ...this.#next, id: ++this.#ids });
    this.#next = null;
  }

  /** The camera in the space of this object. Where lengths are scaled unequally the pixel error is divided by the ratio. */
  #queryOf(camera, renderer) {
    camera.updateWorldMatrix(true, false);
    this.updateWorldMatrix(true, false);
    const toLocal = this.matrixWorld.clone().invert();
    const axes = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(this.matrixWorld, k));
    const most = stretchOf(axes);
    const faces = [1, 2, 0].map((k, i) => axes[k].clone().cross(axes[3 - i - k])); // whose largest stretch is most * middle
    const least = Math.abs(this.matrixWorld.determinant()) / stretchOf(faces);
    const eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld).applyMatrix4(toLocal).toArray();
    const projection = camera.projectionMatrix.elements;
    const isOrthographic = projection[15] === 1;
    const target = renderer.getRenderTarget?.();
    const heightPx = Math.max(1, Math.round(target ? target.height : renderer.getDrawingBufferSize(new THREE.Vector2()).y));
    const view = { eye, isOrthographic, heightPx, nearDistance: Math.max(camera.near, 1e-6) / most };
    if (isOrthographic) view.orthoHeight = 2 / projection[5] / most;
    else view.fovyRadians = 2 * Math.atan(1 / projection[5]);
    const margin = 1 / (1 + this.#options.margin);
    const wide = new THREE.Matrix4().makeScale(margin, margin, 1).multiply(camera.projectionMatrix);
    const { elements: m } = wide.multiply(camera.matrixWorld.clone().invert()).multiply(this.matrixWorld);
    const row = (k, sign) => [0, 4, 8, 12].map((at) => m[at + 3] + sign * (k < 3 ? m[at + k] : 0));
    // Four sides and the plane through the eye: near and far planes differ between WebGL and WebGPU.
    const planes = [row(0, 1), row(0, -1), row(1, 1), row(1, -1), row(3, 0), [0, 0, 0, 0]];
    return { view, frustum: this.#options.isCulled === false ? null : planes.flat(), pixelError: (this.pixelError * least) / most };
  }

  #open({ meshes, materials, instances, scene, slot, pageCount }) {
    this.#materials = new Materials(materials, scene, this.#options.ktx2Loader !== undefined);
    this.#uses = meshes.map(() => [false, false]);
    for (const { transform: t, mesh, flags } of instances) {
      const { origin, boundsMin, boundsMax } = meshes[mesh];
      const isMirrored = (flags & 1) !== 0;
      const matrix = new THREE.Matrix4();
      // In doubles, before three's matrices of floats: the origin may be far away.
      for (let k = 0; k < 3; ++k) {
        const [x, y, z, w] = t.subarray(4 * k, 4 * k + 4);
        const at = x * origin[0] + y * origin[1] + z * origin[2] + w;
        const sign = isMirrored && k === 0 ? -1 : 1; // see Batch
        [x, y, z, at].forEach((value, column) => (matrix.elements[4 * column + k] = sign * value));
      }
      this.#matrices.push(matrix);
      this.#isMirrored.push(isMirrored);
      if ((flags & 2) !== 0) continue;
      this.#uses[mesh][Number(isMirrored)] = true;
      const box = new THREE.Box3(new THREE.Vector3(...boundsMin), new THREE.Vector3(...boundsMax)).applyMatrix4(matrix);
      if (isMirrored) box.applyMatrix4(new THREE.Matrix4().makeScale(-1, 1, 1));
      this.boundingBox.union(box);
    }
    this.#tables = { meshes, slot, pageCount };
    this.#worker.postMessage({ type: 'images', images: this.#materials.images });
  }

  #take(data) {
    if (!this.#worker) return data.bitmap?.close(); // disposed of
    if (data.type === 'page') this.#addPage(data);
    if (data.type === 'selection') this.#draw(data);
    if (data.type === 'image') this.#setImage(data);
    if (data.type === 'answer') this.#answer(data.id);
    if (data.type === 'error') this.#fail(data);
  }
  #fail({ place, reason, isFatal = false, ...detail }) {
    if (isFatal) this.#end();
    const message = `${place}: ${reason}`;
    if (this._listeners?.error?.length > 0) this.dispatchEvent({ ...detail, type: 'error', place, message, isFatal });
    else console.error(`meshlode: ${message}`); // without a listener
  }

  #addPage({ page, clusters }) {
    this.#pages.set(page, clusters.map(({ cluster }) => cluster));
    for (const { cluster, mesh, pieces, ...arrays } of clusters) {
      const put = (batch, triangles) => ({ batch, slot: batch.put(arrays, triangles) });
      const putAll = (mirrored) => pieces.map(({ material, triangles }) => put(this.#batchFor(mesh, material, mirrored), triangles));
      this.#clusters.set(cluster, [0, 1].map((mirrored) => (this.#uses[mesh][mirrored] ? putAll(mirrored) : [])));
    }
  }
  #dropPage(page) {
    for (const cluster of this.#pages.get(page) ?? []) {
      for (const pieces of this.#clusters.get(cluster)) pieces.forEach(({ batch, slot }) => batch.drop(slot));
      this.#clusters.delete(cluster);
    }
    this.#pages.delete(page);
    this.#batches = this.#batches.filter(({ batch }) => !batch.isEmpty || batch.dispose());
  }
  #batchFor(mesh, material, mirrored) {
    const { normalMode, uvSetSource, hasColor } = this.#tables.meshes[mesh];
    const key = [material, normalMode === 1, uvSetSource, hasColor, mirrored].join(' ');
    const found = this.#batches.find((one) => one.key === key && !one.batch.isFull);
    if (found) return found.batch;
    const shown = this.#materials.variant(material, normalMode !== 1, hasColor);
    const batch = new Batch(shown, uvSetSource, this.#tables.slot, mirrored === 1);
    Object.assign(batch.object, { castShadow: this.castShadow, receiveShadow: this.receiveShadow });
    this.#batches.push({ key, batch });
    this.add(batch.object);
    return batch;
  }

  #draw({ id, dropped, drawn, query, resident, statistics }) {
    if (drawn) {
      for (const { batch } of this.#batches) batch.begin();
      drawn.clusters.forEach((cluster, i) => {
        const instance = drawn.instances[i];
        const pieces = this.#clusters.get(cluster)[Number(this.#isMirrored[instance])];
        for (const { batch, slot } of pieces) batch.show(slot, cluster, instance, this.#matrices[instance]);
      });
      for (const { batch } of this.#batches) batch.end();
      this.drawn = { ...drawn, ...query, resident };
    } else if (this.drawn) {
      Object.assign(this.drawn, query, { resident });
    }
    for (const page of dropped) this.#dropPage(page);
    const isMoved = this.statistics === null || statistics.bytesRead !== this.statistics.bytesRead || dropped.length > 0;
    this.statistics = { ...statistics, pages: this.#tables.pageCount, residentPages: this.#pages.size,
      drawnClusters: this.drawn?.clusters.length ?? 0 };
    this.#answer(id);
    if (drawn) this.dispatchEvent({ type: 'change' });
    this.dispatchEvent({ type: 'statistics', statistics: this.statistics });
    if (!isMoved && statistics.isLoading) return;
    const { bytesRead: loaded, fileBytes: total, missing, isFull } = statistics;
    this.dispatchEvent({ type: 'progress', loaded, total, missing, isFull, isComplete: missing === 0 && this.isSettled });
  }
  #answer(id) {
    if (id !== this.#ids) return;
    this.#isAnswered = true;
    this.#ask();
  }

  #setImage({ image, bitmap, bytes }) {
    const show = (texture) => {
      if (!this.#worker) return texture.dispose();
      this.#materials.setImage(image, texture);
      this.dispatchEvent({ type: 'change' });
    };
    const fail = (error) => this.#fail({ place: `image ${image}`, reason: error?.message ?? 'cannot be read', image });
    if (bitmap) show(new THREE.Texture(bitmap));
    else if (this.#options.ktx2Loader) this.#options.ktx2Loader.parse(bytes.buffer, show, fail);
    else fail(new Error('KTX2 needs the option ktx2Loader'));
  }
}
