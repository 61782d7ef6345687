// SPDX-License-Identifier: MIT
// meshlode/webgpu: a .lode asset that streams, drawn on a WebGPU device of the caller's. The worker of meshlode/three reads and
// checks pages; each lies in a slot of one storage buffer as it lies in the file. Compute shaders select from what is resident,
// frame by frame, and one indirect draw decodes.
import { LodeError } from '../stream/source.js';
import { clipMatrix, frustumOf, metricView, worldRows } from './view.js';
export { LodeError };

const NONE = 0xffffffff;
const TERMINAL = 1;
const SINGULAR = 2;
const MESH_WORDS = 12;
const INSTANCE_WORDS = 48;
const MATERIAL_WORDS = 8;
const RUN_BYTES = 256; // of uniforms per level: the alignment of offsets that every device has
const LEAST_BYTES = 256; // of a buffer: an element of each table at least is bound
const MOST_LEVELS = 2 ** 24; // of all meshes: a small file may claim 65,536 levels for each
const ROW = 65535; // workgroups of a dispatch in one direction

const DEFAULTS = {
  pixelError: 1, // pixels of the target
  poolBytes: 64 * 2 ** 20, // of pages: 500 of 128 KiB, 17 million triangles of the dragon's finest level; half of what every device binds
  margin: 0.1, // of the view on each side, for what is requested: as in meshlode/three
  timeoutMs: 30000,
};
const CALLS = {
  onError: ({ message }) => console.error(`meshlode: ${message}`),
  onChange() {},
};
const SHADE = `fn shade(s: Surface, base: vec4f) -> vec4f {
  return vec4f(base.rgb * (0.3 + 0.7 * max(dot(s.normal, -normalize(s.from_eye)), 0.0)), base.a);
}`;

/** A device with as much room for a pool as the adapter has. Null where there is no WebGPU: draw with meshlode/three there. */
export async function requestDevice(options = {}) {
  const adapter = await globalThis.navigator?.gpu?.requestAdapter(options);
  if (!adapter) return null;
  const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
  return adapter.requestDevice({ requiredLimits: { maxStorageBufferBindingSize, maxBufferSize } });
}

/** Opens an asset by its head. `file`: an address or a Blob. Rejects with a LodeError, which has the place; later ones go to onError. */
export async function openLode(device, file, options = {}) {
  if (!device?.createBuffer) throw new LodeError('device', 'there is no WebGPU: draw with meshlode/three');
  const all = { ...DEFAULTS, ...CALLS };
  for (const [name, value] of Object.entries(options)) if (value !== undefined) all[name] = value;
  const wrong = Object.keys(DEFAULTS).find((name) => !(typeof all[name] === 'number' && all[name] >= 0));
  if (wrong) throw new LodeError('options', `${wrong} is no number of at least 0`);
  if (typeof all.format !== 'string') throw new LodeError('options', 'format, of the target, is missing');
  const lode = new Lode(device, all);
  try {
    await lode.open(file);
    return lode;
  } catch (error) {
    lode.dispose();
    throw error instanceof LodeError ? error : new LodeError('device', error.message);
  }
}

async function loadText(name) {
  // Written out: bundlers find the files by these words.
  const urls = {
    decode: new URL('./decode.wgsl', import.meta.url),
    tables: new URL('./tables.wgsl', import.meta.url),
    select: new URL('./select.wgsl', import.meta.url),
    draw: new URL('./draw.wgsl', import.meta.url),
  };
  const response = await fetch(urls[name]);
  if (!response.ok) throw new LodeError(`${name}.wgsl`, `the server answers ${response.status}`);
  return response.text();
}

export class Lode {
  /** Of the last answer of the worker: see index.d.ts. */
  statistics = null;
  #device;
  #options;
  #worker = null;
  #tables = null;
  #placed = []; // what is drawn: {id, instance, mesh, reach, firstState}
  #buffers = {};
  #pipelines;
  #groups;
  #levels = []; // per level, coarse to fine: workgroups
  #instanceData;
  #pageData; // per page: first cluster, first word of its slot
  #free = []; // slots
  #arrived = []; // messages that the next frame applies: what a frame selected is drawn by the same pages
  #asked = '';
  #next = null;
  #isAnswered = true;
  #ids = 0;

  constructor(device, options) {
    this.#device = device;
    this.#options = options;
    this.pixelError = options.pixelError;
  }

  async open(file) {
    const { headers, credentials, timeoutMs, promise, module } = this.#options;
    const poolBytes = Math.min(this.#options.poolBytes, 0.75 * this.#most); // root pages are in slots beside it
    const source = file instanceof Blob ? file : new URL(file, globalThis.document?.baseURI).href;
    const worker = (this.#worker = this.#options.createWorker?.() ?? new Worker(new URL('../stream/worker.js', import.meta.url), { type: 'module' }));
    const opened = new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => {
        if (this.#tables) return this.#take(data);
        if (data.type === 'error') return reject(new LodeError(data.place, data.reason));
        this.#tables = data;
        resolve();
      };
      worker.onerror = ({ message: reason = 'cannot be started' }) =>
        worker.onmessage({ data: { type: 'error', place: 'worker', reason, isFatal: true } });
    });
    worker.postMessage({ type: 'open', file: source, options: { headers, credentials, timeoutMs, poolBytes, promise, module, isRaw: true } });
    const names = ['tables', 'decode', 'select', 'draw'];
    const [texts] = await Promise.all([Promise.all(names.map(loadText)), opened]);
    this.#device.pushErrorScope('out-of-memory');
    let scope;
    try {
      this.#fill(poolBytes);
    } finally {
      scope = this.#device.popErrorScope();
      scope.catch(() => {}); // of a lost device, where #fill() has thrown
    }
    const missing = await scope;
    if (missing) throw new LodeError('device', missing.message);
    await this.#compile(Object.fromEntries(names.map((name, i) => [name, texts[i]])));
  }
  get #most() {
    const { maxStorageBufferBindingSize, maxBufferSize } = this.#device.limits;
    return Math.min(maxStorageBufferBindingSize, maxBufferSize);
  }

  /** A buffer, with its first words. */
  #buffer(name, bytes, usage, words) {
    if (bytes > this.#most) throw new LodeError('scene', `${name}: ${bytes} bytes, of which this device has room for ${this.#most}`);
    const size = Math.max(LEAST_BYTES, 4 * Math.ceil(bytes / 4));
    this.#buffers[name] = this.#device.createBuffer({ label: `meshlode ${name}`, size, usage: usage | GPUBufferUsage.COPY_DST });
    if (words) this.#device.queue.writeBuffer(this.#buffers[name], 0, words);
  }

  #fill(poolBytes) {
    const { meshes, materials, instances, pages, groups, clusters, reaches, slot, slotBytes } = this.#tables;
    const { STORAGE, UNIFORM, INDIRECT, COPY_SRC } = GPUBufferUsage;
    let [states, items] = [0, 0];
    for (const [id, instance] of instances.entries()) {
      const mesh = meshes[instance.mesh];
      if ((instance.flags & SINGULAR) !== 0 || mesh.groupCount === 0) continue;
      this.#placed.push({ id, instance, mesh, reach: reaches[instance.mesh], firstState: states });
      states += mesh.groupCount;
      items += mesh.clusterCount;
    }
    const counts = meshes.map(({ firstGroup, groupCount }) => [firstGroup, groupCount]);
    const levelOf = (group) => groups[14 * group + 12] >>> 16;
    const most = counts.reduce((level, [first, count]) => (count > 0 ? Math.max(level, levelOf(first)) : level), 0);
    const stride = most + 2;
    if (stride * meshes.length > MOST_LEVELS) throw new LodeError('scene', `${meshes.length} meshes of up to ${most + 1} levels`);
    const starts = new Uint32Array(stride * meshes.length); // [0] of a mesh: its end; [level + 1]: its first group of that level or below
    const widths = new Uint32Array(most + 1);
    counts.forEach(([first, count], m) => {
      starts.fill(first + count, m * stride, (m + 1) * stride);
      for (let group = first + count - 1; group >= first; --group) starts[m * stride + levelOf(group) + 1] = group;
      for (let level = 1; level <= most + 1; ++level) {
        const [below, own] = [m * stride + level - 1, m * stride + level];
        starts[own] = Math.min(starts[own], starts[below]);
        widths[level - 1] = Math.max(widths[level - 1], starts[below] - starts[own]);
      }
    });
    const widest = counts.reduce((width, [, count]) => Math.max(width, count), 0);
    const rows = [Math.min(this.#placed.length, ROW), Math.ceil(this.#placed.length / ROW)];
    for (let level = most + 1; level >= 1; --level) this.#levels.push({ level, grid: [Math.ceil(widths[level - 1] / 64), ...rows] });
    this.#levels.push({ level: 0, grid: [Math.ceil(widest / 64), ...rows] }); // of collect(), which has no level
    if (this.#levels.some(({ grid }) => grid[0] > ROW || grid[2] > ROW)) throw new LodeError('scene', `${widest} groups in a mesh`);
    const runs = new Uint32Array((RUN_BYTES / 4) * this.#levels.length);
    const isCulled = this.#options.isCulled === false ? 0 : 1;
    this.#levels.forEach(({ level }, i) => runs.set([level, stride, this.#placed.length, isCulled, 0], (RUN_BYTES / 4) * i));

    const isTerminal = (group) => (groups[14 * group + 13] & TERMINAL) !== 0;
    const roots = pages.filter(({ firstGroup, groupCount }) => Array.from({ length: groupCount }, (_, k) => firstGroup + k).some(isTerminal)).length;
    // Root pages are loaded whatever the pool has.
    const slots = Math.min(pages.length, Math.floor(poolBytes / Math.max(slotBytes, 4)) + roots);
    this.#free = Array.from({ length: slots }, (_, k) => ((slots - 1 - k) * slotBytes) / 4);
    this.#pageData = new Uint32Array(2 * pages.length);
    pages.forEach(({ firstCluster }, page) => this.#pageData.set([firstCluster, NONE], 2 * page));

    const meshData = new Uint32Array(MESH_WORDS * meshes.length);
    const meshFloats = new Float32Array(meshData.buffer);
    meshes.forEach((mesh, m) => {
      meshData.set([mesh.normalScale, mesh.uvSetCount, Number(mesh.hasColor), mesh.material, mesh.firstGroup, mesh.groupCount], MESH_WORDS * m);
      meshFloats.set([2 ** mesh.sphereLog2, mesh.gridStep, 2 ** (mesh.uvLog2[0] ?? 0)], MESH_WORDS * m + 6);
    });
    const materialData = new Float32Array(MATERIAL_WORDS * Math.max(1, materials.length));
    materials.forEach(({ baseColor }, m) => materialData.set(baseColor, MATERIAL_WORDS * m));
    const materialWords = new Uint32Array(materialData.buffer);
    materials.forEach(({ doubleSided }, m) => (materialWords[MATERIAL_WORDS * m + 4] = Number(doubleSided)));

    this.#buffer('pool', slots * slotBytes, STORAGE);
    this.#buffer('groups', groups.byteLength, STORAGE, groups);
    this.#buffer('clusters', clusters.byteLength, STORAGE, clusters);
    this.#buffer('meshes', meshData.byteLength, STORAGE, meshData);
    this.#buffer('levels', starts.byteLength, STORAGE, starts);
    this.#buffer('pages', this.#pageData.byteLength, STORAGE, this.#pageData);
    this.#buffer('materials', materialData.byteLength, STORAGE, materialData);
    this.#buffer('instances', 4 * INSTANCE_WORDS * this.#placed.length, STORAGE);
    this.#buffer('states', 4 * states, STORAGE);
    this.#buffer('list', 16 + 8 * Math.max(1, items), STORAGE | INDIRECT | COPY_SRC);
    this.#buffer('runs', runs.byteLength, UNIFORM, runs);
    this.#instanceData = new Float32Array(INSTANCE_WORDS * this.#placed.length);
    const head = new Uint32Array(this.#instanceData.buffer);
    this.#placed.forEach(({ id, instance, firstState }, i) =>
      head.set([firstState, instance.mesh, instance.flags & 1, id], INSTANCE_WORDS * i + 43));
    this.vertexCount = 3 * slot.triangles;
  }

  async #compile({ tables, decode, select, draw }) {
    const device = this.#device;
    const { format, depthFormat = 'depth24plus', depthCompare = 'less', sampleCount: count = 1, shade = SHADE, bindGroupLayouts = [] } = this.#options;
    const layoutOf = (visibility, kinds) => device.createBindGroupLayout({ entries: kinds.map((type, binding) =>
      ({ binding, visibility: visibility(binding), buffer: { type, hasDynamicOffset: type === 'uniform' } })) });
    const read = (n) => new Array(n).fill('read-only-storage');
    const selectLayout = layoutOf(() => GPUShaderStage.COMPUTE, ['uniform', ...read(6), 'storage', 'storage']);
    const drawLayout = layoutOf((binding) => (binding === 7 ? GPUShaderStage.FRAGMENT : GPUShaderStage.VERTEX), read(8));
    const compile = async (...parts) => {
      device.pushErrorScope('validation');
      const module = device.createShaderModule({ code: parts.join('\n') });
      await device.popErrorScope();
      const wrong = (await module.getCompilationInfo()).messages.find(({ type }) => type === 'error');
      if (wrong) throw new LodeError('shader', wrong.message); // of the caller's shade(), for the others are tested
      return module;
    };
    const choice = await compile(tables, 'const LODE_NONE = 0xFFFFFFFFu;', select);
    const picture = await compile(tables, decode, draw, shade);
    const layout = device.createPipelineLayout({ bindGroupLayouts: [selectLayout] });
    const compute = (entryPoint) => device.createComputePipelineAsync({ layout, compute: { module: choice, entryPoint } });
    const [reach, collect, paint] = await Promise.all([compute('reach'), compute('collect'), device.createRenderPipelineAsync({
      layout: device.createPipelineLayout({ bindGroupLayouts: [drawLayout, ...bindGroupLayouts] }),
      vertex: { module: picture, entryPoint: 'decode' },
      fragment: { module: picture, entryPoint: 'paint', targets: [{ format }] },
      depthStencil: { format: depthFormat, depthWriteEnabled: true, depthCompare },
      multisample: { count },
    })]);
    this.#pipelines = { reach, collect, paint };
    const b = this.#buffers;
    const group = (to, buffers) => device.createBindGroup({ layout: to, entries: buffers.map((buffer, binding) => ({ binding, resource: { buffer } })) });
    const bound = [b.groups, b.clusters, b.meshes, b.levels, b.instances, b.pages, b.states, b.list];
    const select0 = device.createBindGroup({ layout: selectLayout, entries: [{ binding: 0, resource: { buffer: b.runs, size: 32 } },
      ...bound.map((buffer, k) => ({ binding: k + 1, resource: { buffer } }))] });
    this.#groups = { select: select0, draw: group(drawLayout, [b.pool, b.groups, b.clusters, b.meshes, b.instances, b.pages, b.list, b.materials]) };
  }

  /** Whether the worker has answered for the last view and nothing is being loaded; what has come is shown by the next select(). */
  get isSettled() {
    if (!this.#worker) return true;
    return this.#isAnswered && this.#next === null && this.#arrived.length === 0 && this.statistics !== null && !this.statistics.isLoading;
  }

  /**
   * Encodes the selection of a frame: {view, viewProjection}, of the world. Pages that have come since the last one are taken, and the
   * worker gets the view. To be submitted before or with draw() of the same frame.
   */
  select(encoder, { view, viewProjection }) {
    if (!this.#groups) return;
    if (!view.eye) throw new LodeError('camera', 'eye is missing: surfaces are relative to it'); // of an orthographic view too
    for (const message of this.#arrived.splice(0)) this.#apply(message);
    this.#ask(view, viewProjection);
    this.#placed.forEach(({ instance, mesh, reach }, i) => {
      const at = INSTANCE_WORDS * i;
      this.#instanceData.set(clipMatrix(viewProjection, instance, mesh), at);
      this.#instanceData.set(worldRows(view.eye, instance, mesh), at + 16);
      this.#instanceData.set(metricView(view, this.pixelError, instance, mesh, reach), at + 28);
    });
    const { queue } = this.#device;
    queue.writeBuffer(this.#buffers.instances, 0, this.#instanceData);
    queue.writeBuffer(this.#buffers.pages, 0, this.#pageData);
    queue.writeBuffer(this.#buffers.list, 0, new Uint32Array([this.vertexCount, 0, 0, 0]));
    encoder.clearBuffer(this.#buffers.states);
    const pass = encoder.beginComputePass({ label: 'meshlode select' });
    this.#levels.forEach(({ level, grid }, i) => {
      if (grid.includes(0)) return;
      pass.setPipeline(level > 0 ? this.#pipelines.reach : this.#pipelines.collect);
      pass.setBindGroup(0, this.#groups.select, [RUN_BYTES * i]);
      pass.dispatchWorkgroups(...grid);
    });
    pass.end();
  }
  /** Encodes the draw of what the last select() chose. Sets pipeline and bind group 0. */
  draw(pass) {
    if (!this.#groups) return;
    pass.setPipeline(this.#pipelines.paint);
    pass.setBindGroup(0, this.#groups.draw);
    pass.drawIndirect(this.#buffers.list, 0);
  }
  /** What the last submitted selection chose, ascending: {instances, clusters}. Waits for the GPU. */
  async readDrawn() {
    const from = this.#buffers.list;
    const to = this.#device.createBuffer({ size: from.size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
    const encoder = this.#device.createCommandEncoder();
    encoder.copyBufferToBuffer(from, 0, to, 0, from.size);
    this.#device.queue.submit([encoder.finish()]);
    await to.mapAsync(GPUMapMode.READ);
    const words = new Uint32Array(to.getMappedRange());
    const pairs = Array.from({ length: words[1] }, (_, k) => [this.#placed[words[4 + 2 * k]].id, words[5 + 2 * k]]);
    to.destroy();
    pairs.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    return { instances: Uint32Array.from(pairs, ([instance]) => instance), clusters: Uint32Array.from(pairs, ([, cluster]) => cluster) };
  }
  /** Pages that the last select() chose from: page p is bit p % 32 of word p / 32. */
  get resident() {
    const words = new Uint32Array(Math.ceil(this.#pageData.length / 64));
    for (let page = 0; 2 * page < this.#pageData.length; ++page) if (this.#pageData[2 * page + 1] !== NONE) words[page >> 5] |= 1 << (page & 31);
    return words;
  }
  /** Requests failed pages again. */
  retry() {
    this.#worker?.postMessage({ type: 'retry' });
  }
  /** Ends the worker and frees GPU memory; the object must not be used afterwards. */
  dispose() {
    this.#worker?.terminate();
    this.#worker = this.#groups = null;
    for (const buffer of Object.values(this.#buffers)) buffer.destroy();
  }

  #ask(view, viewProjection) {
    const frustum = this.#options.isCulled === false ? null : frustumOf(viewProjection, this.#options.margin);
    const query = { view, frustum, pixelError: this.pixelError };
    const key = JSON.stringify(query);
    if (key !== this.#asked) [this.#asked, this.#next] = [key, query];
    this.#send();
  }
  #send() {
    if (!this.#next || !this.#isAnswered || !this.#worker) return;
    this.#isAnswered = false;
    this.#worker.postMessage({ type: 'view', ...this.#next, id: ++this.#ids });
    this.#next = null;
  }

  #take(data) {
    if (!this.#worker) return;
    if (data.type === 'error') return this.#fail(data);
    if (data.type === 'page' || data.dropped?.length > 0) this.#arrived.push(data);
    if (data.type === 'selection') this.statistics = data.statistics;
    if (data.id === this.#ids) this.#isAnswered = true;
    this.#send();
    if (this.#arrived.length > 0) this.#options.onChange();
  }
  #apply({ type, page, bytes, dropped = [] }) {
    for (const one of dropped) {
      if (this.#pageData[2 * one + 1] !== NONE) this.#free.push(this.#pageData[2 * one + 1]);
      this.#pageData[2 * one + 1] = NONE;
    }
    if (type !== 'page') return;
    const word = (this.#pageData[2 * page + 1] = this.#free.pop());
    this.#device.queue.writeBuffer(this.#buffers.pool, 4 * word, bytes);
  }
  #fail({ place, reason, isFatal = false, page }) {
    if (isFatal) {
      this.#worker.terminate();
      this.#worker = null;
    }
    this.#options.onError({ place, message: `${place}: ${reason}`, isFatal, page });
  }
}
