// SPDX-License-Identifier: MIT
// The viewer of a file that streams: index.html#lode=ADDRESS, or a file that is dropped. What is shown is in the hash of the address.
import { loadRuntime } from 'meshlode';
import { loadLode } from 'meshlode/three';
import { Address } from './address.js';
import { countTriangles } from './dag.js';
import { openHead } from './head.js';
import { LodeStage } from './lode_stage.js';
import { boundsOf } from './orbit.js';
import { Viewer, byId, count, fillList, number, say, short } from './viewer.js';

const POOL_MIB = [0.5, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048];
const LINK_MBIT = [0.5, 1, 2, 5, 10, 20, 50, 100, 1000, Infinity];
const LATENCY_MS = [0, 10, 20, 50, 100, 200, 500, 1000];
const FREE = LINK_MBIT.length - 1;

const threeWorker = new URL('../stream/worker.js', import.meta.resolve('meshlode/three')).href;
const mebibytes = (bytes) => `${short(bytes / 2 ** 20)} MiB`;

class StreamingViewer extends Viewer {
  /** `file`: its address, which of a dropped file is of this tab alone. */
  constructor(facts, asset, address, file) {
    super(facts, asset, address);
    this.file = file;
    this.hadErrors = 0;
    this.view = new LodeStage(byId('mesh-view'), {
      onSelect: (cluster) => this.select(cluster),
      onMove: () => this.keepCamera(),
      onDraw: () => this.sayDrawn(),
    });
    this.view.frame(boundsOf(asset, asset.instances.filter(({ flags }) => (flags & 2) === 0)));
  }

  showMesh(mesh) {
    byId('mesh').value = String(mesh);
    this.showGraph(mesh < 0 ? this.asset.instances[0]?.mesh ?? 0 : mesh);
    if (byId('mesh').value !== '-1') this.lookAt(mesh);
  }
  /** All instances are drawn; the camera goes to the first of a mesh. */
  lookAt(mesh) {
    const one = this.asset.instances.find((instance) => instance.mesh === mesh && (instance.flags & 2) === 0);
    if (one) this.view.frame(boundsOf(this.asset, [one]));
  }

  restore() {
    const settings = [['pool', POOL_MIB, 9], ['link', LINK_MBIT, FREE], ['latency', LATENCY_MS, 0]];
    for (const [id, steps, usual] of settings) {
      const step = this.address.integer(id, 0, steps.length - 1);
      byId(id).value = String(step ?? usual);
    }
    this.sayLink();
    super.restore();
  }
  connect(prefersDark) {
    super.connect(prefersDark);
    for (const id of ['pool', 'link', 'latency']) {
      this.on(byId(id), 'input', () => {
        this.sayLink();
        this.address.set({ [id]: byId(id).value });
      });
    }
    this.on(byId('pool'), 'change', () => this.load());
    this.on(byId('again'), 'click', () => this.load());
  }
  sayLink() {
    const [mbit, latencyMs] = [LINK_MBIT[byId('link').value], LATENCY_MS[byId('latency').value]];
    say('pool', `${POOL_MIB[byId('pool').value]} MiB`);
    say('link', mbit === Infinity ? 'as it is' : `${mbit} Mbit/s`);
    say('latency', latencyMs === 0 ? 'as it is' : `${latencyMs} ms more`);
    this.link = { type: 'link', bytesPerSecond: (mbit * 1e6) / 8, latencyMs };
    this.worker?.postMessage(this.link);
  }

  /** Streams the file from its start. */
  async load() {
    const attempt = (this.attempt = (this.attempt ?? 0) + 1);
    byId('errors').hidden = true;
    this.hadErrors = 0;
    let worker;
    const createWorker = () => {
      worker = new Worker(new URL(`./slow_worker.js?${encodeURIComponent(threeWorker)}`, import.meta.url), { type: 'module' });
      worker.postMessage(this.link);
      return worker;
    };
    try {
      const lode = await loadLode(this.file, { poolBytes: POOL_MIB[byId('pool').value] * 2 ** 20, pixelError: this.pixelError, createWorker });
      if (attempt !== this.attempt || this.view.isOver) return lode.dispose();
      this.worker = worker;
      this.worker.postMessage(this.link);
      lode.addEventListener('error', ({ message, isFatal }) => this.sayError(message, isFatal));
      lode.addEventListener('statistics', ({ statistics }) => this.sayStatistics(statistics));
      lode.addEventListener('change', () => this.markCut(lode.drawn?.clusters ?? []));
      lode.pixelError = this.pixelError; // it may have changed meanwhile
      this.view.setLode(lode);
    } catch (error) {
      if (attempt === this.attempt) this.sayError(error.message, true);
    }
  }
  recut() {
    this.sayPixels();
    if (this.view.lode) this.view.lode.pixelError = this.pixelError;
    this.view.draw();
  }

  // ------------------------------------------------------------------------------------------------------------ words

  markCut(clusters) {
    this.graph.inCut = new Set(clusters);
    this.graph.draw();
  }
  sayError(message, isFatal) {
    this.hadErrors += 1;
    byId('errors').hidden = false;
    const more = this.hadErrors > 1 ? ` (${number(this.hadErrors)} in all)` : '';
    byId('errors').textContent = `${message}${more}${isFatal ? '. Nothing more is loaded.' : '. Coarser geometry or a plain colour stands there.'}`;
  }
  sayDrawn() {
    const clusters = this.view.lode.drawn?.clusters ?? [];
    const triangles = countTriangles(this.asset, clusters);
    const text = `${count(clusters.length, 'cluster')}, ${count(triangles, 'triangle')} in ${count(this.view.calls, 'draw call')}.`;
    if (byId('cut-text').textContent !== text) byId('cut-text').textContent = text;
    document.documentElement.dataset.drawn = String(clusters.length);
  }
  sayStatistics(s) {
    const pool = POOL_MIB[byId('pool').value] * 2 ** 20;
    fillList(byId('statistics'), [
      ['Read', `${number(s.bytesRead)} of ${number(s.fileBytes)} bytes (${Math.round((100 * s.bytesRead) / s.fileBytes)}%), ${count(s.requests, 'request')}`],
      ['Pages', `${number(s.residentPages)} of ${number(s.pages)} resident, ${number(s.missing)} wanted${s.failed > 0 ? `, ${number(s.failed)} failed` : ''}`],
      ['Pool', `${mebibytes(s.poolUsed)} of ${mebibytes(pool)}${s.isFull ? ', full: what costs most pixels is kept' : ''}`],
      ['Selection', `${s.selectMs.toFixed(2)} ms, unpacking ${Math.round(s.unpackMs)} ms in all`],
      ['Module', `${mebibytes(s.moduleBytes)} of memory`],
    ]);
    byId('progress').value = s.residentPages + s.missing === 0 ? 0 : s.residentPages / (s.residentPages + s.missing);
    document.documentElement.dataset.settled = this.view.lode.isSettled ? 'yes' : 'no';
  }

  end() {
    this.attempt = -1;
    this.view.end();
    super.end();
    byId('statistics').replaceChildren();
    byId('progress').value = 0;
    if (this.file.startsWith('blob:')) URL.revokeObjectURL(this.file);
  }
}

// ------------------------------------------------------------------------------------------------------------ the page

const address = new Address();
let runtime = null;
let viewer = null;
let opening = 0;
let reading = new AbortController(); // of the head

function refuse(message) {
  byId('summary').textContent = message;
  document.documentElement.dataset.failed = 'yes';
  document.body.classList.add('empty');
}

/** Opens an address or a file in place of what is shown. */
async function open(file, name) {
  const mine = ++opening;
  reading.abort();
  const abort = (reading = new AbortController());
  viewer?.end();
  viewer = null;
  const { dataset } = document.documentElement;
  for (const key of ['failed', 'settled', 'drawn']) delete dataset[key];
  byId('summary').textContent = `Reading ${name} …`;
  document.title = `${name} – meshlode viewer`;
  let opened = null;
  let isTaken = false; // by a viewer, which frees it
  try {
    runtime ??= await loadRuntime();
    opened = await openHead(file, runtime, abort);
    if (mine !== opening) return;
    viewer = new StreamingViewer(opened.facts, opened.asset, address, file);
    isTaken = true;
    window.meshlodeViewer = viewer; // for a console, and for tests
    document.body.classList.remove('empty');
    viewer.start();
    await viewer.load();
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) runtime = opened = null; // a trap: the memory of the module may be anything
    if (!viewer) byId('graph').replaceWith(byId('graph').cloneNode()); // with the listeners of one that could not be made
    if (mine === opening) refuse(`${name} cannot be shown: ${error.message}`);
  } finally {
    if (!isTaken) {
      opened?.asset.close();
      if (file.startsWith('blob:')) URL.revokeObjectURL(file);
    }
  }
}
function openFile(file) {
  // What is of one file alone is not said of another; the address of a dropped file means nothing elsewhere.
  address.set({ lode: null, mesh: null, cam: null, cluster: null });
  byId('lode').value = '';
  open(URL.createObjectURL(file), file.name);
}

function listen() {
  byId('open').addEventListener('submit', (event) => {
    event.preventDefault();
    const lode = byId('lode').value.trim();
    if (lode === '') return;
    address.set({ lode, mesh: null, cam: null, cluster: null });
    address.write();
    open(lode, lode);
  });
  byId('file').addEventListener('change', () => byId('file').files[0] && openFile(byId('file').files[0]));
  const mark = (event, isOver) => {
    event.preventDefault();
    document.body.classList.toggle('over', isOver);
  };
  addEventListener('dragover', (event) => mark(event, true));
  addEventListener('dragleave', (event) => mark(event, false));
  addEventListener('drop', (event) => {
    mark(event, false);
    const file = event.dataTransfer.files[0];
    if (file) openFile(file);
  });
}

for (const one of document.querySelectorAll('[data-only=embedded]')) one.hidden = true;
document.documentElement.dataset.theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
document.body.classList.add('empty');
listen();
const lode = address.text('lode');
if (lode) {
  byId('lode').value = lode;
  open(lode, lode);
}
