// SPDX-License-Identifier: MIT
// meshlode's runtime over its WebAssembly module: <meshlode/meshlode.h>, whose records lie in the module's memory as they lie
// everywhere. Nothing of the module is kept across calls but addresses: its memory moves whenever it grows.

/** "No such id". */
export const NONE = 0xffffffff;
/** An error that never passes. */
export const INFINITE_ERROR = 3.4028234663852886e38;
export const STUCK_REASONS = ['not_stuck', 'locked', 'flips', 'seams', 'components', 'too_small', 'topology', 'border'];
/** What a cut may be asked to be true of: positions; texture coordinates too; shading normals too. */
export const PROMISES = ['position', 'texels', 'appearance'];
export const CODECS = ['none', 'lz4', 'zstd', 'draco', 'strips'];
export const GROUP_TERMINAL = 1;
export const GROUP_STUCK = 2;

const MAX_CLUSTER = 256;
const MAX_UV_SETS = 4;
const ERROR_BYTES = 248;
const STATUS = ['ok', 'usage', 'io', 'invalid', 'out_of_memory', 'unsupported', '', 'too_small'];

/** What the runtime refuses: `status` is a word of meshlode_status, `message` names the place. */
export class MeshlodeError extends Error {
  constructor(status, message) {
    super(message || status);
    this.name = 'MeshlodeError';
    this.status = status;
  }
}

/**
 * Compiles and starts the module. `source`: its bytes, or a WebAssembly.Module; left out, meshlode.wasm beside this file.
 * A runtime that threw anything but a MeshlodeError (a trap: memory that could not be had) must not be used again.
 */
export async function loadRuntime(source) {
  const bytes = source ?? (await readModule());
  const module = bytes instanceof WebAssembly.Module ? bytes : await WebAssembly.compile(bytes);
  // libc may name functions of WASI that it never calls here; whoever calls one is told that there is no such thing.
  const imports = {};
  for (const { module: space, name } of WebAssembly.Module.imports(module)) {
    imports[space] ??= {};
    imports[space][name] = () => 52; // ENOSYS
  }
  const instance = await WebAssembly.instantiate(module, imports);
  instance.exports._initialize?.();
  return new Runtime(instance.exports);
}

/** Written out: bundlers find the file by these words. */
async function readModule() {
  const place = new URL('./meshlode.wasm', import.meta.url);
  if (place.protocol !== 'file:') return new Uint8Array(await (await fetch(place)).arrayBuffer());
  const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:fs/promises');
  return readFile(place);
}

class Runtime {
  #wasm;
  #view;

  constructor(wasm) {
    this.#wasm = wasm;
    this.#view = new DataView(wasm.memory.buffer);
  }

  /** The version of the file format that is read. */
  get formatVersion() {
    return this.#wasm.meshlode_format_version();
  }

  /** Of the module, which never shrinks. */
  get memoryBytes() {
    return this.#wasm.memory.buffer.byteLength;
  }

  /** Opens an asset whose bytes are copied into the module. */
  open(bytes) {
    return this.#open(bytes, (at, asset, error) => this.#wasm.meshlode_open_buffer(at, bytes.byteLength, asset, error));
  }

  /** How many of a file's first bytes openHead() needs: {bytes, isKnown}. Not known: `bytes` of them are needed to say it. */
  headBytes(first, fileBytes) {
    const frame = new Frame(this, 8 + ERROR_BYTES + first.byteLength);
    try {
      const at = frame.at + 8 + ERROR_BYTES;
      this.bytes(at, first.byteLength).set(first);
      const status = this.#wasm.meshlode_head_bytes(at, first.byteLength, BigInt(fileBytes), frame.at, frame.at + 8);
      if (status !== 0 && STATUS[status] !== 'too_small') throw this.errorAt(status, frame.at + 8);
      return { bytes: uint64(this.view(), frame.at), isKnown: status === 0 };
    } finally {
      frame.end();
    }
  }

  /** Opens an asset by the first bytes of its file, as many as headBytes() says or more. Pages and images are the caller's to read. */
  openHead(bytes, fileBytes) {
    const size = bytes.byteLength;
    return this.#open(bytes, (at, asset, error) =>
      this.#wasm.meshlode_open_head(at, size, BigInt(fileBytes), asset, error),
    );
  }

  #open(bytes, call) {
    const start = this.allocate(bytes.byteLength);
    this.bytes(start, bytes.byteLength).set(bytes);
    const frame = new Frame(this, 4 + ERROR_BYTES);
    try {
      const status = call(start, frame.at, frame.at + 4);
      if (status !== 0) {
        const error = this.errorAt(status, frame.at + 4);
        this.release(start);
        throw error;
      }
      return new Asset(this, this.#wasm, this.view().getUint32(frame.at, true), start);
    } finally {
      frame.end();
    }
  }

  /** Of the module's memory as it lies now. */
  view() {
    if (this.#view.buffer !== this.#wasm.memory.buffer) this.#view = new DataView(this.#wasm.memory.buffer);
    return this.#view;
  }
  bytes(at, count) {
    return new Uint8Array(this.#wasm.memory.buffer, at, count);
  }
  allocate(count) {
    // The module would take it modulo 2^32.
    if (!(count < 2 ** 32)) throw new MeshlodeError('out_of_memory', `${count} bytes`);
    const at = this.#wasm.meshlode_web_allocate(count) >>> 0;
    if (at === 0) throw new MeshlodeError('out_of_memory', `${count} bytes`);
    return at;
  }
  release(at) {
    this.#wasm.meshlode_web_release(at);
  }
  errorAt(status, at) {
    const text = this.bytes(at + 4, ERROR_BYTES - 4);
    return new MeshlodeError(STATUS[status] ?? 'invalid', decodeText(text.subarray(0, text.indexOf(0))));
  }
}

/** Memory for the outputs of a call. */
class Frame {
  constructor(runtime, bytes) {
    this.runtime = runtime;
    this.at = runtime.allocate(bytes);
    runtime.bytes(this.at, bytes).fill(0);
  }
  end() {
    this.runtime.release(this.at);
  }
}

function decodeText(bytes) {
  return new TextDecoder('utf-8', { ignoreBOM: true }).decode(bytes.slice());
}

/** Memory of a view (64 bytes) and, 64 behind it, of a frustum (192 bytes): what selections read. */
const VIEW_BYTES = 256;
function putView(runtime, at, view, frustum) {
  const to = runtime.view();
  (view.eye ?? [0, 0, 0]).forEach((value, i) => to.setFloat64(at + 8 * i, value, true));
  to.setInt32(at + 24, view.isOrthographic ? 1 : 0, true);
  to.setFloat64(at + 32, view.fovyRadians ?? 0, true);
  to.setFloat64(at + 40, view.orthoHeight ?? 0, true);
  to.setFloat64(at + 48, view.nearDistance, true);
  to.setUint32(at + 56, view.heightPx, true);
  to.setUint32(at + 60, promiseNumber(view.promise), true);
  for (let i = 0; frustum && i < 24; ++i) to.setFloat64(at + 64 + 8 * i, frustum[i], true);
}

/** What is none of the words has no number, and is refused as that. */
function promiseNumber(promise = PROMISES[0]) {
  return PROMISES.indexOf(promise) >>> 0;
}

/** Pairs of 32 bits as two arrays of their own; `Second`: type of the second ones. */
function readPairs(runtime, at, count, Second = Uint32Array) {
  const words = new Uint32Array(runtime.bytes(at, 8 * count).slice().buffer);
  const seconds = new Second(words.buffer);
  const out = [new Uint32Array(count), new Second(count)];
  for (let i = 0; i < count; ++i) {
    out[0][i] = words[2 * i];
    out[1][i] = seconds[2 * i + 1];
  }
  return out;
}

/** A number of 64 bits; counts and offsets of a file are far below 2^53. */
function uint64(view, at) {
  return view.getUint32(at, true) + view.getUint32(at + 4, true) * 2 ** 32;
}

class Asset {
  #runtime;
  #wasm;
  #at;
  #bytes;
  #pages = new Map(); // page -> address of its decoded bytes
  #selectors = new Set(); // open ones
  #cluster = 0; // memory for one decoded cluster, made when it is first wanted
  #tables = {}; // made when they are first wanted: an asset may have millions of clusters

  constructor(runtime, wasm, at, bytes) {
    this.#runtime = runtime;
    this.#wasm = wasm;
    this.#at = at;
    this.#bytes = bytes;
  }

  get meshes() {
    return (this.#tables.meshes ??= this.#records('meshes', 200, (v, p) => this.#mesh(v, p)));
  }
  get materials() {
    return (this.#tables.materials ??= this.#records('materials', 48, (v, p) => this.#material(v, p)));
  }
  get instances() {
    return (this.#tables.instances ??= this.#records('instances', 128, (v, p) => this.#instance(v, p)));
  }
  get groups() {
    return (this.#tables.groups ??= this.#records('groups', 56, readGroup));
  }
  get clusters() {
    return (this.#tables.clusters ??= this.#records('clusters', 24, readCluster));
  }
  get pages() {
    return (this.#tables.pages ??= this.#records('pages', 64, readPage));
  }
  /** Images and buffers of the source, as it had them. */
  get blobs() {
    return (this.#tables.blobs ??= this.#records('blobs', 48, (v, p) => this.#blob(v, p)));
  }
  /** A copy of a table of the file as it lies there, in words: 14 a group, 6 a cluster. Errors of groups are those of `promise`. */
  tableWords(name, promise) {
    const at = this.#tablesOf(promise)[name] ?? this.#table(name);
    return this.#uints(at, ({ groups: 14, clusters: 6 })[name] * this.#count(name));
  }
  /** {meshes, groups} with the errors of a promise (level0Deviation, error), where `meshes` and `groups` have those of positions. */
  tablesOf(promise) {
    const { meshes, groups } = this.#tablesOf(promise);
    return {
      meshes: this.#records('meshes', 200, (v, p) => this.#mesh(v, p), meshes),
      groups: this.#records('groups', 56, readGroup, groups),
    };
  }
  /** Throws where the asset was not built with that one of PROMISES, which selections then refuse. */
  checkPromise(promise) {
    this.#tablesOf(promise);
  }
  /** The farthest that anything of a mesh is from its origin, as selections take it. */
  reachOf(mesh) {
    const firstNode = this.#record('meshes', 200, mesh, (view, at) => view.getUint32(at + 192, true));
    const [x, y, z, radius] = this.#record('nodes', 28, firstNode, (view, at) => [0, 4, 8, 12].map((k) => view.getFloat32(at + k, true))) ?? [0, 0, 0, 0];
    return Math.sqrt(x * x + y * y + z * z) + radius;
  }
  /** The mesh that a cluster is of; NONE if there is no such cluster. */
  meshOf(cluster) {
    const one = this.#record('clusters', 24, cluster, readCluster);
    return one ? this.#record('groups', 56, one.coarserGroup, readGroup).mesh : NONE;
  }

  /** Frees the asset; nothing of it may be used afterwards. */
  close() {
    if (this.#at === 0) return;
    for (const selector of this.#selectors) selector.close();
    for (const page of [...this.#pages.keys()]) this.dropPage(page);
    if (this.#cluster !== 0) this.#runtime.release(this.#cluster);
    this.#wasm.meshlode_close(this.#at);
    this.#runtime.release(this.#bytes);
    this.#at = this.#bytes = this.#cluster = 0;
  }

  get meta() {
    return this.#json('meta_json');
  }
  get scene() {
    return this.#json('scene_json');
  }

  /**
   * Clusters of a mesh's cut by the errors of a promise, ascending: {clusters, storedError}. `maxError` in units of the mesh; Infinity:
   * the coarsest.
   */
  selectUniform(mesh, maxError, promise) {
    const capacity = this.meshes[mesh]?.clusterCount ?? 0;
    const frame = new Frame(this.#runtime, 16 + ERROR_BYTES + 4 * capacity);
    try {
      const items = frame.at + 16 + ERROR_BYTES;
      this.#check(
        this.#wasm.meshlode_select_uniform(
          this.#at, mesh, promiseNumber(promise), maxError, items, capacity, frame.at, frame.at + 8, frame.at + 16,
        ),
        frame.at + 16,
      );
      const view = this.#runtime.view();
      const count = view.getUint32(frame.at, true);
      return { clusters: this.#uints(items, count), storedError: view.getFloat64(frame.at + 8, true) };
    } finally {
      frame.end();
    }
  }

  /**
   * What a camera needs, ascending by instance and cluster: {instances, clusters}, of equal length. `frustum`: 24 numbers, six
   * planes as makeFrustum() returns them; left out, nothing is culled.
   */
  selectView(view, pixelError, frustum) {
    const head = VIEW_BYTES + 8 + ERROR_BYTES;
    let capacity = this.#count('clusters') + this.#count('instances');
    for (;;) {
      const frame = new Frame(this.#runtime, head + 8 * capacity);
      try {
        putView(this.#runtime, frame.at, view, frustum);
        const count = frame.at + VIEW_BYTES;
        const status = this.#wasm.meshlode_select_frustum(
          this.#at, frame.at, frustum ? frame.at + 64 : 0, pixelError, frame.at + head, capacity, count, count + 8,
        );
        const found = this.#runtime.view().getUint32(count, true);
        if (STATUS[status] === 'too_small') {
          capacity = found; // more instances than there are clusters
          continue;
        }
        this.#check(status, count + 8);
        const [instances, clusters] = readPairs(this.#runtime, frame.at + head, found);
        return { instances, clusters };
      } finally {
        frame.end();
      }
    }
  }

  /** The view volume of a view that looks at `target`; `aspect` is width over height. */
  makeFrustum(view, target, up, aspect) {
    const frame = new Frame(this.#runtime, VIEW_BYTES + 48 + ERROR_BYTES);
    try {
      putView(this.#runtime, frame.at, view);
      const at = frame.at + VIEW_BYTES;
      [...target, ...up].forEach((value, i) => this.#runtime.view().setFloat64(at + 8 * i, value, true));
      this.#check(this.#wasm.meshlode_make_frustum(frame.at, at, at + 24, aspect, frame.at + 64, at + 48), at + 48);
      return new Float64Array(this.#runtime.bytes(frame.at + 64, 192).slice().buffer);
    } finally {
      frame.end();
    }
  }

  /** What selects with only some pages resident. The asset closes it at its own end. */
  createSelector() {
    if (this.#at === 0) throw new MeshlodeError('usage', 'the asset is closed');
    return new Selector(this.#runtime, this.#wasm, this.#at, this.#count('pages'), this.#selectors);
  }

  /** The page that holds a cluster. */
  pageOf(cluster) {
    return this.#wasm.meshlode_page_of(this.#at, cluster) >>> 0;
  }

  /** Pages that must be there before this one is drawn. */
  pageDependencies(page) {
    const frame = new Frame(this.#runtime, 4);
    try {
      const at = this.#wasm.meshlode_page_dependencies(this.#at, page, frame.at) >>> 0;
      return this.#uints(at, this.#runtime.view().getUint32(frame.at, true));
    } finally {
      frame.end();
    }
  }

  /** All pages, those with the largest errors of a promise first, each after those it depends on. */
  streamingOrder(promise) {
    const frame = new Frame(this.#runtime, ERROR_BYTES + 4 * this.pages.length);
    try {
      const order = frame.at + ERROR_BYTES;
      this.#check(this.#wasm.meshlode_streaming_order(this.#at, promiseNumber(promise), order, frame.at), frame.at);
      return this.#uints(order, this.pages.length);
    } finally {
      frame.end();
    }
  }

  /**
   * Ranges {offset, bytes} to read before the first picture, ascending. Pages with at most `maxGap` bytes between them share one,
   * and neighbours always do. A fraction is rounded down.
   */
  firstRanges(maxGap = 0) {
    const gap = BigInt(Math.floor(Math.min(Math.max(maxGap || 0, 0), Number.MAX_SAFE_INTEGER)));
    const capacity = this.#count('pages'); // no more ranges than pages
    const frame = new Frame(this.#runtime, 8 + ERROR_BYTES + 16 * capacity);
    try {
      const [error, at] = [frame.at + 8, frame.at + 8 + ERROR_BYTES];
      this.#check(this.#wasm.meshlode_first_ranges(this.#at, gap, at, capacity, frame.at, error), error);
      const view = this.#runtime.view();
      const range = (_, i) => ({ offset: uint64(view, at + 16 * i), bytes: uint64(view, at + 16 * i + 8) });
      return Array.from({ length: view.getUint32(frame.at, true) }, range);
    } finally {
      frame.end();
    }
  }

  /** Unpacks and checks a page, and keeps it in the module until dropPage(). Of a head: unpackPage(). */
  loadPage(page) {
    this.#keepPage(page, new Uint8Array(0), (from, at, size, error) =>
      this.#wasm.meshlode_load_page(this.#at, page, at, size, error),
    );
  }
  /** The same from bytes that the caller read, those of the page's `offset` and `storedBytes`. */
  unpackPage(page, stored) {
    this.#keepPage(page, stored, (from, at, size, error) =>
      this.#wasm.meshlode_unpack_page(this.#at, page, from, stored.byteLength, at, size, error),
    );
  }
  #keepPage(page, stored, call) {
    if (this.#pages.has(page)) return;
    const size = this.pages[page]?.bytes ?? 0;
    const at = this.#runtime.allocate(size);
    try {
      this.#withBytes(stored, (from, error) => call(from, at, size, error));
      this.#pages.set(page, at);
    } catch (error) {
      this.#runtime.release(at);
      throw error;
    }
  }
  /** A copy of a loaded page as it lies in the module, for decode.wgsl; undefined where it is not loaded. */
  pageBytes(page) {
    const at = this.#pages.get(page);
    return at === undefined ? undefined : this.#runtime.bytes(at, this.pages[page].bytes).slice();
  }
  dropPage(page) {
    const at = this.#pages.get(page);
    if (at === undefined) return;
    this.#pages.delete(page);
    this.#runtime.release(at);
  }

  /** A copy of a blob's bytes; empty if there is no such blob, or of a head. */
  blobBytes(blob) {
    const frame = new Frame(this.#runtime, 4);
    try {
      const at = this.#wasm.meshlode_blob_bytes(this.#at, blob, frame.at) >>> 0;
      return this.#runtime.bytes(at, this.#runtime.view().getUint32(frame.at, true)).slice();
    } finally {
      frame.end();
    }
  }
  /** Throws where bytes that the caller read, those of the blob's `offset` and `bytes`, are not the blob's. */
  checkBlob(blob, bytes) {
    this.#withBytes(bytes, (from, error) =>
      this.#wasm.meshlode_check_blob(this.#at, blob, from, bytes.byteLength, error),
    );
  }
  /** The glTF image of a glTF texture, and the blob that is a glTF image; NONE where there is none. */
  imageOfTexture(texture) {
    return this.#wasm.meshlode_image_of_texture(this.#at, texture) >>> 0;
  }
  blobOfImage(image) {
    return this.#wasm.meshlode_blob_of_image(this.#at, image) >>> 0;
  }

  /** The most vertices and triangles of any cluster: what a pool of equal slots has to hold. */
  largestCluster() {
    const at = this.#table('clusters');
    const bytes = this.#runtime.bytes(at, 24 * this.#count('clusters'));
    let vertices = 0;
    let triangles = 0;
    for (let i = 20; i < bytes.length; i += 24) {
      vertices = Math.max(vertices, bytes[i] + 1);
      triangles = Math.max(triangles, bytes[i + 1] + 1);
    }
    return { vertices, triangles };
  }

  /** Copies of a cluster's floats: positions (relative to the mesh's origin), normals, uvs, colors, triangles, materials. */
  decodeFloats(cluster) {
    const page = this.pageOf(cluster);
    const mesh = this.meshes[this.meshOf(cluster)];
    const { at, arrays } = this.#prepare(cluster, page);
    const view = this.#runtime.view();
    view.setUint32(at, MAX_CLUSTER, true);
    view.setUint32(at + 4, MAX_CLUSTER, true);
    const fields = [arrays.positions, arrays.normals, ...arrays.uvs, arrays.colors, arrays.triangles, arrays.materials];
    fields.forEach((address, i) => view.setUint32(at + 8 + 4 * i, address, true));
    this.#check(this.#wasm.meshlode_decode_floats(this.#at, at + 64, cluster, at, at + 72), at + 72);
    const after = this.#runtime.view();
    const vertices = after.getUint32(at + 44, true);
    const triangles = after.getUint32(at + 48, true);
    return {
      vertexCount: vertices,
      triangleCount: triangles,
      positions: this.#floats(arrays.positions, 3 * vertices),
      normals: mesh.normalMode === 1 ? this.#floats(arrays.normals, 3 * vertices) : null,
      uvs: arrays.uvs.slice(0, mesh.uvSetCount).map((address) => this.#floats(address, 2 * vertices)),
      colors: mesh.hasColor ? this.#floats(arrays.colors, 4 * vertices) : null,
      triangles: this.#runtime.bytes(arrays.triangles, 3 * triangles).slice(),
      triangleMaterials: this.#uints(arrays.materials, triangles),
    };
  }

  /** Copies of a cluster's integers: values (vertex by vertex), channelCount, triangles, materials. */
  decodeIntegers(cluster) {
    const page = this.pageOf(cluster);
    const { at, arrays } = this.#prepare(cluster, page);
    const view = this.#runtime.view();
    const fields = [arrays.valueCapacity, MAX_CLUSTER, arrays.positions, arrays.triangles, arrays.materials];
    fields.forEach((value, i) => view.setUint32(at + 4 * i, value, true));
    this.#check(this.#wasm.meshlode_decode_integers(this.#at, at + 64, cluster, at, at + 72), at + 72);
    const after = this.#runtime.view();
    const vertexCount = after.getUint32(at + 20, true);
    const triangleCount = after.getUint32(at + 24, true);
    const channelCount = after.getUint32(at + 28, true);
    const values = this.#runtime.bytes(arrays.positions, 4 * vertexCount * channelCount).slice();
    return {
      vertexCount,
      triangleCount,
      channelCount,
      values: new Int32Array(values.buffer),
      triangles: this.#runtime.bytes(arrays.triangles, 3 * triangleCount).slice(),
      triangleMaterials: this.#uints(arrays.materials, triangleCount),
    };
  }

  /** Memory for the struct at `at`, the page's pair behind it, the error, and the arrays of one cluster. */
  #prepare(cluster, page) {
    if (page === NONE) throw new MeshlodeError('usage', 'cluster: does not exist');
    this.loadPage(page);
    const sizes = [3, 3, 2, 2, 2, 2, 4].map((floats) => 4 * floats * MAX_CLUSTER); // floats; integers lie over them
    const head = 72 + ERROR_BYTES;
    const total = head + sizes.reduce((sum, size) => sum + size, 0) + 3 * MAX_CLUSTER + 4 * MAX_CLUSTER;
    if (this.#cluster === 0) this.#cluster = this.#runtime.allocate(total);
    const at = this.#cluster;
    const starts = [];
    let next = at + head;
    for (const size of [...sizes, 4 * MAX_CLUSTER, 3 * MAX_CLUSTER]) {
      starts.push(next);
      next += size;
    }
    const view = this.#runtime.view();
    view.setUint32(at + 64, page, true);
    view.setUint32(at + 68, this.#pages.get(page), true);
    const arrays = {
      positions: starts[0],
      normals: starts[1],
      uvs: starts.slice(2, 2 + MAX_UV_SETS),
      colors: starts[6],
      materials: starts[7],
      triangles: starts[8],
      valueCapacity: (starts[7] - starts[0]) / 4,
    };
    return { at, arrays };
  }

  /** Calls with the address of a copy of the bytes and of an error, and throws that. */
  #withBytes(bytes, call) {
    const frame = new Frame(this.#runtime, ERROR_BYTES + bytes.byteLength);
    try {
      this.#runtime.bytes(frame.at + ERROR_BYTES, bytes.byteLength).set(bytes);
      this.#check(call(frame.at + ERROR_BYTES, frame.at), frame.at);
    } finally {
      frame.end();
    }
  }

  #check(status, errorAt) {
    if (status !== 0) throw this.#runtime.errorAt(status, errorAt);
  }
  #uints(at, count) {
    return new Uint32Array(this.#runtime.bytes(at, 4 * count).slice().buffer);
  }
  #floats(at, count) {
    return new Float32Array(this.#runtime.bytes(at, 4 * count).slice().buffer);
  }

  /** The address of a table, which stays; `count` is stored where that is wanted. */
  #table(name, store = () => {}) {
    const frame = new Frame(this.#runtime, 4);
    try {
      const at = this.#wasm[`meshlode_${name}`](this.#at, frame.at) >>> 0;
      store(this.#runtime.view().getUint32(frame.at, true));
      return at;
    } finally {
      frame.end();
    }
  }
  #count(name) {
    let count = 0;
    this.#table(name, (value) => (count = value));
    return count;
  }
  /** The addresses of the tables that hold errors, with those of a promise. */
  #tablesOf(promise) {
    const frame = new Frame(this.#runtime, 12 + ERROR_BYTES);
    try {
      const errorAt = frame.at + 12;
      this.#check(this.#wasm.meshlode_tables_of(this.#at, promiseNumber(promise), frame.at, errorAt), errorAt);
      const [meshes, groups] = this.#uints(frame.at, 2);
      return { meshes, groups };
    } finally {
      frame.end();
    }
  }
  #records(name, size, read, at = this.#table(name)) {
    const out = new Array(this.#count(name));
    // A reader may ask the module for texts, and its memory may then move: the view is asked for each time.
    for (let i = 0; i < out.length; ++i) out[i] = read(this.#runtime.view(), at + size * i);
    return out;
  }
  #record(name, size, index, read) {
    return index < this.#count(name) ? read(this.#runtime.view(), this.#table(name) + size * index) : undefined;
  }

  #text(view, at) {
    const offset = view.getUint32(at, true);
    const size = view.getUint32(at + 4, true);
    const frame = new Frame(this.#runtime, 12);
    try {
      this.#runtime.view().setUint32(frame.at, offset, true);
      this.#runtime.view().setUint32(frame.at + 4, size, true);
      const text = this.#wasm.meshlode_text(this.#at, frame.at, frame.at + 8) >>> 0;
      return decodeText(this.#runtime.bytes(text, this.#runtime.view().getUint32(frame.at + 8, true)));
    } finally {
      frame.end();
    }
  }

  #json(name) {
    const frame = new Frame(this.#runtime, 4);
    try {
      const at = this.#wasm[`meshlode_${name}`](this.#at, frame.at) >>> 0;
      const text = decodeText(this.#runtime.bytes(at, this.#runtime.view().getUint32(frame.at, true)));
      return JSON.parse(text);
    } catch (error) {
      // Nothing checks these texts on opening. Nor is this a trap, after which the module may not be used.
      if (!(error instanceof SyntaxError)) throw error;
      throw new MeshlodeError('invalid', `section ${name === 'meta_json' ? 'META' : 'SCNE'}: is no JSON`);
    } finally {
      frame.end();
    }
  }

  #mesh(view, at) {
    const u = (offset) => view.getUint32(at + offset, true);
    const i = (offset) => view.getInt32(at + offset, true);
    const d = (offset) => view.getFloat64(at + offset, true);
    const step = u(36) * 2 ** i(32);
    const origin = [d(8), d(16), d(24)];
    const mesh = {
      origin,
      gridStep: step,
      boundsMin: [0, 1, 2].map((axis) => i(40 + 4 * axis) * step),
      boundsMax: [0, 1, 2].map((axis) => i(52 + 4 * axis) * step),
      diagonal: d(64),
      level0Deviation: view.getFloat32(at + 72, true),
      errorTier: u(76),
      normalMode: u(80),
      normalScale: u(84),
      uvSetCount: u(88),
      hasColor: u(92) !== 0,
      uvLog2: [0, 1, 2, 3].map((set) => i(96 + 4 * set)).slice(0, u(88)),
      uvSetSource: [0, 1, 2, 3].map((set) => view.getUint8(at + 112 + set)).slice(0, u(88)),
      material: u(116),
      sphereLog2: i(120),
      levelCount: u(124),
      sourceTriangles: uint64(view, at + 128),
      sourceVertices: uint64(view, at + 136),
      firstGroup: u(176),
      groupCount: u(180),
      firstCluster: u(184),
      clusterCount: u(188),
    };
    return { name: this.#text(view, at), ...mesh };
  }

  #material(view, at) {
    const u = (offset) => view.getUint32(at + offset, true);
    const material = {
      sourceIndex: u(8),
      alphaMode: u(12),
      baseColor: [0, 1, 2, 3].map((c) => view.getFloat32(at + 16 + 4 * c, true)),
      alphaCutoff: view.getFloat32(at + 32, true),
      doubleSided: u(36) !== 0,
      baseColorTexture: u(40),
      baseColorUvSet: u(44),
    };
    return { name: this.#text(view, at), ...material };
  }

  #blob(view, at) {
    const blob = {
      mimeType: this.#text(view, at + 8),
      offset: uint64(this.#runtime.view(), at + 16),
      bytes: uint64(this.#runtime.view(), at + 24),
      kind: this.#runtime.view().getUint32(at + 32, true),
      sourceIndex: this.#runtime.view().getUint32(at + 36, true),
    };
    return { name: this.#text(this.#runtime.view(), at), ...blob };
  }

  #instance(view, at) {
    const transform = new Float64Array(12);
    for (let k = 0; k < 12; ++k) transform[k] = view.getFloat64(at + 8 * k, true);
    const instance = {
      transform,
      scale: view.getFloat64(at + 96, true),
      mesh: view.getUint32(at + 104, true),
      node: view.getUint32(at + 108, true),
      flags: view.getUint32(at + 112, true),
    };
    return { name: this.#text(view, at + 120), ...instance };
  }
}

/** Chooses what to draw of what is loaded, and says what to load. */
class Selector {
  #runtime;
  #wasm;
  #at;
  #fixed; // view, frustum, count, error, words of pages
  #words;
  #items;
  #capacity = 1024; // grows to what a view needs
  #open;

  /** `open`: the asset's open selectors. */
  constructor(runtime, wasm, asset, pageCount, open) {
    this.#runtime = runtime;
    this.#wasm = wasm;
    this.#words = Math.ceil(pageCount / 32);
    this.#fixed = runtime.allocate(VIEW_BYTES + 8 + ERROR_BYTES + 4 * this.#words);
    this.#items = runtime.allocate(8 * this.#capacity);
    const error = this.#fixed + 8;
    const status = wasm.meshlode_create_selector(asset, this.#fixed, error);
    if (status !== 0) throw runtime.errorAt(status, error);
    this.#at = runtime.view().getUint32(this.#fixed, true);
    this.#open = open.add(this);
  }

  #checkOpen() {
    if (this.#at === 0) throw new MeshlodeError('usage', 'the selector is closed');
  }

  /**
   * What to draw with the pages whose bits are set in `resident` (page p: bit p % 32 of word p / 32), ascending by instance and
   * cluster: {instances, clusters}.
   */
  select(view, pixelError, resident, frustum) {
    this.#checkOpen();
    const count = this.#fixed + VIEW_BYTES;
    const words = count + 8 + ERROR_BYTES;
    for (;;) {
      putView(this.#runtime, this.#fixed, view, frustum);
      const padded = new Uint32Array(this.#words);
      padded.set(resident.subarray(0, this.#words));
      this.#runtime.bytes(words, padded.byteLength).set(new Uint8Array(padded.buffer));
      const status = this.#wasm.meshlode_select_resident(
        this.#at, this.#fixed, frustum ? this.#fixed + 64 : 0, pixelError, words, this.#items, this.#capacity, count, count + 8,
      );
      const found = this.#runtime.view().getUint32(count, true);
      if (STATUS[status] === 'too_small') {
        this.#runtime.release(this.#items);
        this.#items = 0;
        this.#items = this.#runtime.allocate(8 * 2 * found);
        this.#capacity = 2 * found;
        continue;
      }
      if (status !== 0) throw this.#runtime.errorAt(status, count + 8);
      const [instances, clusters] = readPairs(this.#runtime, this.#items, found);
      return { instances, clusters };
    }
  }

  /** Of the last selection: pages that it lacks, by falling priority, each behind those that it is of no use without. */
  get requests() {
    this.#checkOpen();
    const at = this.#wasm.meshlode_page_requests(this.#at, this.#fixed) >>> 0;
    const count = this.#runtime.view().getUint32(this.#fixed, true);
    const [pages, priorities] = readPairs(this.#runtime, at, count, Float32Array);
    return { pages, priorities };
  }
  /** Of the last selection, of each page: what is lost without it, in pixels; 0: nothing; INFINITE_ERROR: keep it always. */
  get pagePriorities() {
    this.#checkOpen();
    const at = this.#wasm.meshlode_page_priorities(this.#at, this.#fixed) >>> 0;
    const count = this.#runtime.view().getUint32(this.#fixed, true);
    return new Float32Array(this.#runtime.bytes(at, 4 * count).slice().buffer);
  }

  close() {
    if (this.#at === 0) return;
    this.#open.delete(this);
    this.#wasm.meshlode_destroy_selector(this.#at);
    this.#runtime.release(this.#fixed);
    this.#runtime.release(this.#items);
    this.#at = this.#fixed = this.#items = 0;
  }
}

function readPage(view, at) {
  const u = (offset) => view.getUint32(at + offset, true);
  return {
    offset: uint64(view, at),
    storedBytes: u(8),
    bytes: u(12),
    codec: u(16),
    firstGroup: u(20),
    groupCount: u(24),
    firstCluster: u(28),
    clusterCount: u(32),
  };
}

function readGroup(view, at) {
  const f = (offset) => view.getFloat32(at + offset, true);
  const u = (offset) => view.getUint32(at + offset, true);
  const h = (offset) => view.getUint16(at + offset, true);
  return {
    center: [f(0), f(4), f(8)],
    radius: f(12),
    error: f(16),
    quadricError: f(20),
    deviation: f(24),
    normalDeviation: f(28),
    uvDeviation: f(32),
    firstCluster: u(36),
    mesh: u(40),
    page: u(44),
    clusterCount: h(48),
    level: h(50),
    flags: h(52),
    stuckReason: h(54),
  };
}

function readCluster(view, at) {
  return {
    center: [0, 2, 4].map((offset) => view.getInt16(at + offset, true)),
    radius: view.getUint16(at + 6, true),
    coneAxis: [8, 9, 10].map((offset) => view.getInt8(at + offset)),
    coneCutoff: view.getInt8(at + 11),
    ownGroup: view.getUint32(at + 12, true),
    coarserGroup: view.getUint32(at + 16, true),
    vertexCount: view.getUint8(at + 20) + 1,
    triangleCount: view.getUint8(at + 21) + 1,
    level: view.getUint16(at + 22, true),
  };
}
