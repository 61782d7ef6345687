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
  const bytes = source ?? (await readBeside('meshlode.wasm'));
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

async function readBeside(name) {
  const place = new URL(name, import.meta.url);
  if (place.protocol !== 'file:') return new Uint8Array(await (await fetch(place)).arrayBuffer());
  const { readFile } = await import('node:fs/promises');
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

  /** Opens an asset whose bytes are copied into the module. */
  open(bytes) {
    const start = this.allocate(bytes.byteLength);
    this.bytes(start, bytes.byteLength).set(bytes);
    const frame = new Frame(this, 4 + ERROR_BYTES);
    try {
      const status = this.#wasm.meshlode_open_buffer(start, bytes.byteLength, frame.at, frame.at + 4);
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
  #promise = PROMISES[0];
  #cluster = 0; // memory for one decoded cluster, made when it is first wanted

  constructor(runtime, wasm, at, bytes) {
    this.#runtime = runtime;
    this.#wasm = wasm;
    this.#at = at;
    this.#bytes = bytes;
    this.#readPromised();
    this.materials = this.#records('materials', 48, (v, p) => this.#material(v, p));
    this.instances = this.#records('instances', 128, (v, p) => this.#instance(v, p));
    this.pages = this.#records('pages', 64, readPage);
    this.clusters = this.#records('clusters', 24, readCluster);
  }

  /** Frees the asset; nothing of it may be used afterwards. */
  close() {
    if (this.#at === 0) return;
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

  /** The one of PROMISES by whose errors cuts are made: `position` until another one is chosen. */
  get promise() {
    return this.#promise;
  }

  /**
   * Makes cuts by the errors of one of PROMISES. `meshes` (level0Deviation) and `groups` (error) are then read anew; what was taken
   * of them before keeps what it said. Refused, and nothing changed, where the asset was not built with it.
   */
  choosePromise(promise) {
    const frame = new Frame(this.#runtime, ERROR_BYTES);
    try {
      // What is none of the words has no number, and is refused as that.
      const number = PROMISES.indexOf(promise) >>> 0;
      this.#check(this.#wasm.meshlode_choose_promise(this.#at, number, frame.at), frame.at);
      this.#promise = promise;
      this.#readPromised();
    } finally {
      frame.end();
    }
  }

  /** Clusters of a mesh's cut, ascending: {clusters, storedError}. `maxError` in units of the mesh; Infinity: the coarsest. */
  selectUniform(mesh, maxError) {
    const capacity = this.meshes[mesh]?.clusterCount ?? 0;
    const frame = new Frame(this.#runtime, 16 + ERROR_BYTES + 4 * capacity);
    try {
      const items = frame.at + 16 + ERROR_BYTES;
      this.#check(
        this.#wasm.meshlode_select_uniform(this.#at, mesh, maxError, items, capacity, frame.at, frame.at + 8, frame.at + 16),
        frame.at + 16,
      );
      const view = this.#runtime.view();
      const count = view.getUint32(frame.at, true);
      return { clusters: this.#uints(items, count), storedError: view.getFloat64(frame.at + 8, true) };
    } finally {
      frame.end();
    }
  }

  /** What a camera needs, ascending by instance and cluster: {instances, clusters}, of equal length. */
  selectView(view, pixelError) {
    const head = 64 + 8 + ERROR_BYTES;
    let capacity = this.clusters.length + this.instances.length;
    for (;;) {
      const frame = new Frame(this.#runtime, head + 8 * capacity);
      try {
        this.#putView(frame.at, view);
        const error = frame.at + 72;
        const status = this.#wasm.meshlode_select_view(
          this.#at, frame.at, pixelError, frame.at + head, capacity, frame.at + 64, error,
        );
        const count = this.#runtime.view().getUint32(frame.at + 64, true);
        if (STATUS[status] === 'too_small') {
          capacity = count; // more instances than there are clusters
          continue;
        }
        this.#check(status, error);
        const pairs = this.#uints(frame.at + head, 2 * count);
        const instances = new Uint32Array(count);
        const clusters = new Uint32Array(count);
        for (let i = 0; i < count; ++i) {
          instances[i] = pairs[2 * i];
          clusters[i] = pairs[2 * i + 1];
        }
        return { instances, clusters };
      } finally {
        frame.end();
      }
    }
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

  /** All pages, the most important first, each after those it depends on. */
  streamingOrder() {
    const frame = new Frame(this.#runtime, ERROR_BYTES + 4 * this.pages.length);
    try {
      const order = frame.at + ERROR_BYTES;
      this.#check(this.#wasm.meshlode_streaming_order(this.#at, order, frame.at), frame.at);
      return this.#uints(order, this.pages.length);
    } finally {
      frame.end();
    }
  }

  /** Unpacks and checks a page, and keeps it in the module until dropPage(). */
  loadPage(page) {
    if (this.#pages.has(page)) return;
    const frame = new Frame(this.#runtime, ERROR_BYTES);
    const size = this.pages[page]?.bytes ?? 0;
    const at = this.#runtime.allocate(size);
    try {
      this.#check(this.#wasm.meshlode_load_page(this.#at, page, at, size, frame.at), frame.at);
      this.#pages.set(page, at);
    } catch (error) {
      this.#runtime.release(at);
      throw error;
    } finally {
      frame.end();
    }
  }
  dropPage(page) {
    const at = this.#pages.get(page);
    if (at === undefined) return;
    this.#pages.delete(page);
    this.#runtime.release(at);
  }

  /** Copies of a cluster's floats: positions (relative to the mesh's origin), normals, uvs, colors, triangles, materials. */
  decodeFloats(cluster) {
    const page = this.pageOf(cluster);
    const mesh = this.meshes[this.groups[this.clusters[cluster]?.coarserGroup]?.mesh];
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

  #readPromised() {
    this.meshes = this.#records('meshes', 200, (v, p) => this.#mesh(v, p));
    this.groups = this.#records('groups', 56, readGroup);
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

  #records(name, size, read) {
    const frame = new Frame(this.#runtime, 4);
    try {
      const at = this.#wasm[`meshlode_${name}`](this.#at, frame.at) >>> 0;
      const count = this.#runtime.view().getUint32(frame.at, true);
      const out = new Array(count);
      // A reader may ask the module for texts, and its memory may then move: the view is asked for each time.
      for (let i = 0; i < count; ++i) out[i] = read(this.#runtime.view(), at + size * i);
      return out;
    } finally {
      frame.end();
    }
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

  #putView(at, view) {
    const to = this.#runtime.view();
    (view.eye ?? [0, 0, 0]).forEach((value, i) => to.setFloat64(at + 8 * i, value, true));
    to.setInt32(at + 24, view.isOrthographic ? 1 : 0, true);
    to.setFloat64(at + 32, view.fovyRadians ?? 0, true);
    to.setFloat64(at + 40, view.orthoHeight ?? 0, true);
    to.setFloat64(at + 48, view.nearDistance, true);
    to.setUint32(at + 56, view.heightPx, true);
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
