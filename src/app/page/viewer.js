// SPDX-License-Identifier: MIT
// The page: reads the asset that it holds, and links graph, mesh, sliders and tables. Every text of the asset's goes through
// textContent; nothing is asked of a network.
import { CODECS, INFINITE_ERROR, NONE, loadRuntime } from './index.js';
import { clustersMadeFrom, colourBytes, countTriangles, errorRatio, measureOf, restrictCut, stuckReason } from './dag.js';
import { Graph } from './graph.js';
import { MeshView } from './mesh_view.js';

const FIRST_FRAME_TRIANGLES = 100000;
const MOST_TRIANGLES = 1500000;
const ERROR_STEPS = 400;
const PIXEL_STEPS = [-20, 60]; // tenths of a power of two: a quarter of a pixel to 64
const SECTION_WORDS = {
  META: 'settings and versions', SCNE: 'scene', STRS: 'names', MESH: 'meshes', MATL: 'materials', INST: 'instances',
  GRUP: 'groups', CLUS: 'clusters', NODE: 'hierarchy', PAGT: 'page table', PDEP: 'page dependencies', BLBT: 'image table',
  PAGE: 'geometry', BLOB: 'images',
};
const STREAM_WORDS = {
  heads: 'cluster headers', materials: 'materials', positions: 'positions', normals: 'normals', uvs: 'texture coordinates',
  colors: 'colours', topology: 'triangles', padding: 'padding',
};

const byId = (id) => document.getElementById(id);
const number = (value) => Number(value).toLocaleString('en-GB');
const count = (value, word) => `${number(value)} ${word}${value === 1 ? '' : word.endsWith('sh') ? 'es' : 's'}`;
const short = (value) => (value >= INFINITE_ERROR ? 'none' : Number(value.toPrecision(4)).toString());

function element(name, text, parent) {
  const out = document.createElement(name);
  if (text !== null) out.textContent = text;
  parent?.append(out);
  return out;
}

/** What a slider stands at, beside it and to a screen reader. */
function say(slider, text) {
  byId(`${slider}-value`).textContent = text;
  byId(slider).setAttribute('aria-valuetext', text);
}

function decodeBase64(text, into, at) {
  const bytes = atob(text);
  for (let i = 0; i < bytes.length; ++i) into[at + i] = bytes.charCodeAt(i);
}

function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const hex = (name) => {
    const text = style.getPropertyValue(name).trim();
    return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
  };
  const css = (name) => style.getPropertyValue(name).trim();
  return {
    isDark: document.documentElement.dataset.theme === 'dark',
    low: hex('--low'),
    high: hex('--high'),
    canvas: hex('--canvas'),
    mark: hex('--mark'),
    markText: css('--mark'),
    text: css('--text'),
    quiet: css('--quiet'),
    line: css('--line'),
    ground: css('--ground'),
  };
}

/** Triangles of a full cluster: what META says, where it says so, else the smallest usual cap that holds. */
function clusterCap(asset) {
  const largest = asset.clusters.reduce((most, cluster) => Math.max(most, cluster.triangleCount), 1);
  let said = 0;
  try {
    said = Number(asset.meta.settings.cluster_triangles);
  } catch {
    // META is text that nobody vouches for.
  }
  return said >= largest && said <= 256 ? said : largest > 128 ? 256 : 128;
}

class Viewer {
  constructor(facts, asset) {
    this.facts = facts;
    this.asset = asset;
    this.made = clustersMadeFrom(asset);
    this.present = new Uint8Array(asset.pages.length);
    for (const [first, count] of facts.embedded_pages) this.present.fill(1, first, first + count);
    this.cap = clusterCap(asset);
    this.selected = NONE;
    this.mesh = -1; // the whole scene
    this.graph = new Graph(byId('graph'), asset, this.made, this.cap, (cluster) => this.select(cluster));
    this.view = null;
    try {
      this.view = new MeshView(byId('mesh-view'), asset, {
        onSelect: (cluster) => this.select(cluster),
        onMove: () => this.cameraMoved(),
        onResize: () => this.cameraMoved(),
      });
    } catch (error) {
      byId('mesh-view').hidden = true;
      byId('mesh-keys').textContent = `No 3D: ${error.message}.`;
      document.querySelector('input[value=camera]').disabled = true;
      document.querySelector('input[value=uniform]').checked = true;
    }
  }

  start() {
    this.fillTexts();
    this.fillMeshes();
    this.fillTables();
    this.applyTheme(matchMedia('(prefers-color-scheme: dark)').matches);
    const { instances, meshes } = this.asset;
    this.showMesh(instances.length === 1 ? instances[0].mesh : instances.length === 0 && meshes.length > 0 ? 0 : -1);
    this.connect();
  }

  connect() {
    byId('theme').addEventListener('click', () => this.applyTheme(document.documentElement.dataset.theme !== 'dark'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => this.applyTheme(event.matches));
    byId('mesh').addEventListener('change', () => this.showMesh(Number(byId('mesh').value)));
    byId('measure').addEventListener('change', () => this.recolour());
    byId('error').addEventListener('input', () => this.recut());
    byId('pixels').addEventListener('input', () => this.recut());
    for (const radio of document.querySelectorAll('input[name=cut]')) {
      radio.addEventListener('change', () => {
        this.showSlider();
        this.recut();
      });
    }
  }

  showSlider() {
    byId('error-label').hidden = this.isCameraCut();
    byId('pixels-label').hidden = !this.isCameraCut();
  }

  applyTheme(isDark) {
    document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
    this.theme = readTheme();
    this.graph.theme = this.theme;
    if (this.view) this.view.theme = this.theme;
    this.recolour();
  }

  // ------------------------------------------------------------------------------------------------------------- cuts

  /** Which transforms the shown meshes have: [{mesh, transform, instance}]; a mesh that is nowhere is shown as it is. */
  shown() {
    const of = (instance, i) => ({ mesh: instance.mesh, transform: instance.transform, instance: i });
    const all = this.asset.instances.map(of).filter(({ instance }) => (this.asset.instances[instance].flags & 2) === 0);
    if (this.mesh < 0) return all;
    const one = all.find(({ mesh }) => mesh === this.mesh);
    return [one ?? { mesh: this.mesh, transform: null, instance: NONE }];
  }

  isCameraCut() {
    return document.querySelector('input[name=cut]:checked').value === 'camera';
  }

  showMesh(mesh) {
    this.mesh = mesh;
    byId('mesh').value = String(mesh);
    this.graph.show(mesh < 0 ? this.shown()[0]?.mesh ?? 0 : mesh);
    this.view?.frame(boundsOf(this.asset, this.shown()));
    byId('error').value = String(this.firstStep());
    if (this.view) byId('pixels').value = String(this.firstPixels());
    this.showSlider();
    this.recut();
  }

  /** Of the uniform cut: step 0 is no error, then from 10^-6 to 1 of each mesh's diagonal. */
  relativeError(step) {
    return step === 0 ? 0 : 10 ** ((6 * step) / ERROR_STEPS - 6);
  }

  uniformCut(step) {
    const cuts = new Map();
    return this.shown().map((shown) => {
      if (!cuts.has(shown.mesh)) {
        const error = this.relativeError(step) * this.asset.meshes[shown.mesh].diagonal;
        const { clusters, storedError } = this.asset.selectUniform(shown.mesh, error);
        cuts.set(shown.mesh, { clusters: restrictCut(this.asset, this.made, this.present, clusters), storedError });
      }
      return { ...shown, ...cuts.get(shown.mesh) };
    });
  }

  cameraCut(pixels) {
    const { instances, clusters } = this.asset.selectView(this.view.view(), pixels);
    const byInstance = new Map();
    instances.forEach((instance, i) => {
      if (!byInstance.has(instance)) byInstance.set(instance, []);
      byInstance.get(instance).push(clusters[i]);
    });
    return this.shown().map((shown) => ({
      ...shown,
      storedError: null,
      clusters: restrictCut(this.asset, this.made, this.present, byInstance.get(shown.instance) ?? []),
    }));
  }

  triangles(cut) {
    return cut.reduce((sum, part) => sum + countTriangles(this.asset, part.clusters), 0);
  }

  /** The finest step within the triangles of a first frame. */
  firstStep(most = FIRST_FRAME_TRIANGLES) {
    let low = -1;
    let high = ERROR_STEPS;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.triangles(this.uniformCut(middle)) <= most) high = middle;
      else low = middle;
    }
    return high;
  }

  /** From one pixel on, the smallest step within the triangles of a first frame. */
  firstPixels() {
    for (let step = 0; step < PIXEL_STEPS[1]; ++step) {
      if (this.triangles(this.cameraCut(2 ** (step / 10))) <= FIRST_FRAME_TRIANGLES) return step;
    }
    return PIXEL_STEPS[1];
  }

  recut() {
    const step = Number(byId('error').value);
    const pixels = 2 ** (Number(byId('pixels').value) / 10);
    say('error', step === 0 ? 'finest' : `${short(this.relativeError(step))} of the diagonal`);
    say('pixels', pixels === 1 ? '1 pixel' : `${short(pixels)} pixels`);
    const isCamera = this.isCameraCut() && this.view !== null;
    let cut = isCamera ? this.cameraCut(pixels) : this.uniformCut(step);
    let note = '';
    if (this.triangles(cut) > MOST_TRIANGLES) {
      note = ` Shown coarser: ${number(this.triangles(cut))} triangles are more than this page draws.`;
      cut = this.uniformCut(this.firstStep(MOST_TRIANGLES));
    }
    this.graph.inCut = new Set(cut.flatMap((part) => Array.from(part.clusters)));
    this.graph.draw();
    const items = cut.flatMap(({ mesh, transform, clusters }) =>
      Array.from(clusters, (cluster) => ({ cluster, transform, origin: this.asset.meshes[mesh].origin })),
    );
    this.view?.setCut(items);
    const worst = cut.reduce((most, part) => Math.max(most, part.storedError ?? 0), 0);
    const error = isCamera ? '' : `, stored error ${short(worst)}`;
    byId('cut-text').textContent =
      `${count(items.length, 'cluster')}, ${count(this.triangles(cut), 'triangle')}${error}.${note}`;
  }

  cameraMoved() {
    if (!this.isCameraCut()) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.recut(), 60);
  }

  // -------------------------------------------------------------------------------------------------------- selection

  recolour() {
    const measure = byId('measure').value;
    this.graph.measure = measure;
    this.graph.draw();
    byId('legend').textContent = `${this.graph.legend()} A bar below a cell: it is in the cut.`;
    const bytes = new Uint8Array(4 * this.asset.clusters.length);
    for (let c = 0; c < this.asset.clusters.length; ++c) {
      bytes.set(colourBytes(measureOf(this.asset, this.cap, measure, c), this.theme), 4 * c);
      bytes[4 * c + 3] = c === this.selected ? 0 : 255;
    }
    this.view?.setColours(bytes);
  }

  select(cluster) {
    this.selected = cluster;
    const mesh = this.asset.groups[this.asset.clusters[cluster].coarserGroup].mesh;
    if (this.graph.mesh !== mesh) this.graph.show(mesh);
    this.graph.select(cluster);
    this.recolour();
    this.describe(cluster);
  }

  describe(c) {
    const { asset } = this;
    const cluster = asset.clusters[c];
    const group = asset.groups[cluster.coarserGroup];
    const own = cluster.ownGroup === NONE ? null : asset.groups[cluster.ownGroup];
    const page = asset.pages[group.page];
    const ratio = errorRatio(asset, c);
    // As in the file, which may have another codec than what is embedded of it.
    const [stored, codec] = this.facts.stored_pages?.[group.page] ?? [page.storedBytes, CODECS[page.codec]];
    const lines = [
      ['Cluster', `${number(c)} of level ${cluster.level}${this.graph.inCut.has(c) ? ', in the cut' : ''}`],
      ['Triangles', `${cluster.triangleCount} of ${this.cap} (${Math.round((100 * cluster.triangleCount) / this.cap)}%)`],
      ['Vertices', String(cluster.vertexCount)],
      ['Own error', own ? `${short(own.error)} (group ${number(cluster.ownGroup)})` : 'none: level 0'],
      ['Coarser error', `${short(group.error)} (group ${number(cluster.coarserGroup)}, ${group.clusterCount} clusters)`],
      ['Ratio', ratio === null ? 'none' : `${short(ratio)} times`],
      ['Stuck', stuckReason(asset, c)?.replace('_', ' ') ?? 'no'],
      ['Page', `${number(group.page)}: ${number(stored)} bytes stored as ${codec}, ` +
        `${number(page.bytes)} decoded${this.present[group.page] ? '' : ', not in this page'}`],
      ['Mesh', asset.meshes[group.mesh].name || '(no name)'],
    ];
    const list = element('dl', null);
    for (const [name, text] of lines) {
      element('dt', name, list);
      element('dd', text, list);
    }
    byId('selection').replaceChildren(list);
  }

  // ------------------------------------------------------------------------------------------------------------ texts

  fillTexts() {
    const { facts, asset } = this;
    const source = asset.meshes.reduce((sum, mesh) => sum + mesh.sourceTriangles, 0);
    byId('summary').textContent =
      `${count(source, 'source triangle')} in ${count(asset.meshes.length, 'mesh')}, ${count(asset.instances.length, 'instance')}, ` +
      `${count(asset.clusters.length, 'cluster')}, ${count(asset.groups.length, 'group')}, ${count(asset.pages.length, 'page')}; ` +
      `${count(facts.file_bytes, 'byte')}.`;
    if (facts.embedded_page_bytes < facts.page_bytes) {
      byId('omitted').hidden = false;
      byId('omitted').textContent =
        `Only coarser levels are in this page: ${number(facts.embedded_page_bytes)} of ${number(facts.page_bytes)} bytes of pages. ` +
        'Finer clusters are in the graph and the tables, not in 3D.';
    }
  }

  fillMeshes() {
    const select = byId('mesh');
    const add = (value, text) => {
      element('option', text, select).value = String(value);
    };
    if (this.asset.instances.length !== 1) add(-1, 'the whole scene');
    this.asset.meshes.forEach((mesh, m) => add(m, `${m}: ${mesh.name || '(no name)'}`));
  }

  fillTables() {
    const levels = [];
    for (const [c, cluster] of this.asset.clusters.entries()) {
      levels[cluster.level] ??= { clusters: 0, triangles: 0, error: 0, stuck: 0, absent: 0 };
      const level = levels[cluster.level];
      level.clusters += 1;
      level.triangles += cluster.triangleCount;
      if (cluster.ownGroup !== NONE) level.error = Math.max(level.error, this.asset.groups[cluster.ownGroup].error);
      if (stuckReason(this.asset, c) !== null) level.stuck += 1;
      if (!this.present[this.asset.groups[cluster.coarserGroup].page]) level.absent += 1;
    }
    const isWhole = levels.every((level) => !level || level.absent === 0);
    const absent = isWhole ? [] : ['not in this page'];
    fillTable(byId('levels'), ['level', 'clusters', 'triangles', 'fill', 'largest error', 'clusters of stuck groups', ...absent],
      Array.from(levels, (level, l) => level && [
        String(l), number(level.clusters), number(level.triangles),
        `${Math.round((100 * level.triangles) / (level.clusters * this.cap))}%`, short(level.error), number(level.stuck),
        ...(isWhole ? [] : [number(level.absent)]),
      ]).filter(Boolean));
    const bits = this.facts.level_bits ?? [];
    const names = Object.keys(STREAM_WORDS);
    const sums = bits.map((level) => names.reduce((sum, name) => sum + level[name], 0));
    const most = Math.max(1, ...sums);
    const rows = bits.map((level, l) => [
      String(l), ...names.map((name) => number(Math.round(level[name] / 8))), number(Math.round(sums[l] / 8)), sums[l] / most,
    ]);
    fillTable(byId('bytes'), ['decoded, by level', ...Object.values(STREAM_WORDS), 'sum', 'share of the largest'], rows);
    byId('bytes-text').textContent = this.bytesText(bits, names);
    const largest = Math.max(1, ...this.facts.sections.map(([, size]) => size));
    fillTable(byId('sections'), ['section', 'bytes', 'share of the largest'],
      this.facts.sections.map(([name, size]) => [SECTION_WORDS[name] ? `${name}: ${SECTION_WORDS[name]}` : name, number(size), size / largest]));
  }

  /** Where the bytes are, in words. */
  bytesText(bits, names) {
    const of = (wanted) => this.facts.sections.reduce((sum, [name, size]) => sum + (name === wanted ? size : 0), 0);
    const [geometry, images] = [of('PAGE'), of('BLOB')];
    const tables = this.facts.file_bytes - geometry - images;
    const streams = names.map((name) => [STREAM_WORDS[name], bits.reduce((sum, level) => sum + level[name], 0)]);
    const all = streams.reduce((sum, [, size]) => sum + size, 0);
    const shares = streams.filter(([, size]) => size > 0.005 * all).sort((a, b) => b[1] - a[1])
      .map(([name, size]) => `${name} ${Math.round((100 * size) / all)}%`);
    const file = `The file: geometry ${number(geometry)} bytes, images ${number(images)}, tables and padding ${number(tables)}.`;
    return all === 0 ? file : `${file} Decoded geometry: ${shares.join(', ')}.`;
  }
}

/** A number in the last cell of a row is a share, drawn as a bar. */
function fillTable(table, head, rows) {
  const top = element('tr', null, element('thead', null, table));
  for (const name of head) element('th', name, top).scope = 'col';
  const body = element('tbody', null, table);
  for (const row of rows) {
    const line = element('tr', null, body);
    row.forEach((cell, k) => {
      const isBar = typeof cell === 'number';
      const at = element(k === 0 ? 'th' : 'td', isBar ? `${Math.round(100 * cell)}% ` : cell, line);
      if (k === 0) at.scope = 'row';
      if (!isBar) return;
      const bar = element('span', null, element('span', null, at));
      bar.className = 'bar';
      bar.style.width = `${cell === 0 ? 0 : Math.max(1, Math.round(120 * cell))}px`;
      bar.parentElement.className = 'bar-ground';
    });
  }
}

function boundsOf(asset, shown) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { mesh, transform } of shown) {
    const { origin, boundsMin, boundsMax } = asset.meshes[mesh];
    const t = transform ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
    for (let corner = 0; corner < 8; ++corner) {
      const p = [0, 1, 2].map((k) => origin[k] + ((corner >> k) & 1 ? boundsMax[k] : boundsMin[k]));
      for (let k = 0; k < 3; ++k) {
        const value = t[4 * k] * p[0] + t[4 * k + 1] * p[1] + t[4 * k + 2] * p[2] + t[4 * k + 3];
        low[k] = Math.min(low[k], value);
        high[k] = Math.max(high[k], value);
      }
    }
  }
  if (!(low[0] <= high[0])) return { center: [0, 0, 0], half: [1, 1, 1] };
  return { center: low.map((value, k) => (value + high[k]) / 2), half: low.map((value, k) => (high[k] - value) / 2) };
}

async function main() {
  const facts = JSON.parse(byId('facts').textContent);
  const module = byId('runtime').textContent;
  const code = new Uint8Array((module.length / 4) * 3 - (module.endsWith('==') ? 2 : module.endsWith('=') ? 1 : 0));
  decodeBase64(module, code, 0);
  const runtime = await loadRuntime(code);
  const file = new Uint8Array(facts.embedded_file_bytes);
  for (const piece of document.querySelectorAll('script.piece')) {
    decodeBase64(piece.textContent, file, Number(piece.dataset.at));
    piece.remove();
  }
  const viewer = new Viewer(facts, runtime.open(file));
  viewer.start();
  viewer.view?.drawNow();
  window.meshlodeViewer = viewer; // for a console, and for tests
  // When it is on the screen: a task after the frame that it is drawn in.
  requestAnimationFrame(() =>
    setTimeout(() => {
      document.documentElement.dataset.firstFrameMs = String(Math.round(performance.now()));
    }),
  );
}

main().catch((error) => {
  byId('summary').textContent = `This page cannot show its asset: ${error.message}`;
  document.documentElement.dataset.failed = 'yes';
  throw error;
});
