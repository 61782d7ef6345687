// SPDX-License-Identifier: MIT
// What every viewer of an asset does: the DAG, colours, selection, tables, the treemap, and the state in the address. A class that
// extends it draws: its `view` has `orbit`, `setColours(bytes)`, `setMode(measure, isWire)` and `toPng(done)`. Every text of the
// asset's goes through textContent.
import { CODECS, INFINITE_ERROR, NONE, STUCK_REASONS } from 'meshlode';
import { LEGENDS, clustersMadeFrom, colourBytes, errorRatio, measureOf, stuckReason } from './dag.js';
import { Graph } from './graph.js';
import { bytesOf, drawTreemap } from './treemap.js';

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

export const byId = (id) => document.getElementById(id);
export const number = (value) => Number(value).toLocaleString('en-GB');
export const count = (value, word) => `${number(value)} ${word}${value === 1 ? '' : word.endsWith('sh') ? 'es' : 's'}`;
export const short = (value) => (value >= INFINITE_ERROR ? 'none' : Number(value.toPrecision(4)).toString());

function element(name, text, parent) {
  const out = document.createElement(name);
  if (text !== null) out.textContent = text;
  parent?.append(out);
  return out;
}

/** A list of names and values, in place of what is in `parent`. */
export function fillList(parent, lines) {
  const list = element('dl', null);
  for (const [name, text] of lines) {
    element('dt', name, list);
    element('dd', text, list);
  }
  parent.replaceChildren(list);
}

/** What a slider stands at, beside it and to a screen reader. */
export function say(slider, text) {
  byId(`${slider}-value`).textContent = text;
  byId(slider).setAttribute('aria-valuetext', text);
}

/** Saves a blob as a download with this name. */
export function download(blob, name) {
  const link = document.createElement('a');
  const address = URL.createObjectURL(blob);
  Object.assign(link, { download: name, href: address }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const css = (name) => style.getPropertyValue(name).trim();
  const hex = (name) => [1, 3, 5].map((k) => parseInt(css(name).slice(k, k + 2), 16));
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

export class Viewer {
  /**
   * `facts`: file_bytes, sections as [name, bytes]; and where an asset is embedded what of it is: embedded_pages, page_bytes,
   * embedded_page_bytes, stored_pages, level_bits.
   */
  constructor(facts, asset, address) {
    this.facts = facts;
    this.asset = asset;
    this.address = address;
    this.made = clustersMadeFrom(asset);
    this.present = new Uint8Array(asset.pages.length);
    for (const [first, size] of facts.embedded_pages ?? [[0, asset.pages.length]]) this.present.fill(1, first, first + size);
    this.cap = clusterCap(asset);
    this.selected = NONE;
    this.unselected = [...byId('selection').childNodes]; // what is said where nothing is selected
    this.view = null;
    this.listeners = new AbortController();
    this.graph = new Graph(byId('graph'), asset, this.made, this.cap, (cluster) => this.select(cluster));
  }

  /** What the selected mesh, the slider and moves of the camera do: for the class that draws. */
  showMesh() {}
  recut() {}

  /** Calls listener(event) until end(). */
  on(target, name, listener) {
    target.addEventListener(name, listener, { signal: this.listeners.signal });
  }

  start() {
    this.fillTexts();
    this.fillMeshes();
    this.fillTables();
    const wanted = this.address.text('show');
    if ([...byId('measure').options].some(({ value, hidden }) => value === wanted && !hidden)) byId('measure').value = wanted;
    byId('wire').checked = this.address.text('wire') === '1';
    const prefersDark = matchMedia('(prefers-color-scheme: dark)');
    const theme = this.address.text('theme');
    this.applyTheme(theme === 'dark' || (theme !== 'light' && prefersDark.matches));
    const first = this.address.integer('mesh', -1, this.asset.meshes.length - 1) ?? this.firstMesh();
    this.showMesh(first);
    this.restore();
    this.connect(prefersDark);
  }

  firstMesh() {
    const { instances, meshes } = this.asset;
    return instances.length === 1 ? instances[0].mesh : instances.length === 0 && meshes.length > 0 ? 0 : -1;
  }

  /** The rest of what the address says, over what the first picture has. */
  restore() {
    const step = this.address.integer('px', ...PIXEL_STEPS);
    if (step !== null) byId('pixels').value = String(step);
    const camera = this.address.numbers('cam', 6, -100, 100);
    if (camera) this.view?.orbit.restore(camera);
    const cluster = this.address.integer('cluster', 0, this.asset.clusters.length - 1);
    if (cluster !== null) this.select(cluster);
    this.recut();
  }

  connect(prefersDark) {
    this.on(byId('theme'), 'click', () => {
      this.applyTheme(document.documentElement.dataset.theme !== 'dark');
      this.address.set({ theme: document.documentElement.dataset.theme });
    });
    this.on(prefersDark, 'change', (event) => this.applyTheme(event.matches));
    this.on(byId('mesh'), 'change', () => {
      this.showMesh(Number(byId('mesh').value));
      this.address.set({ mesh: byId('mesh').value, cam: null });
    });
    this.on(byId('measure'), 'change', () => this.recolour());
    this.on(byId('wire'), 'change', () => this.recolour());
    for (const id of ['measure', 'wire']) this.on(byId(id), 'change', () => this.keepShown());
    this.on(byId('pixels'), 'input', () => {
      this.recut();
      this.address.set({ px: byId('pixels').value });
    });
    this.on(byId('csv'), 'click', () => download(new Blob([this.clustersAsCsv()], { type: 'text/csv' }), 'clusters.csv'));
    this.on(byId('png'), 'click', () => this.view?.toPng((blob) => download(blob, 'view.png')));
    this.on(byId('share'), 'click', () => this.copyAddress());
    if (this.view) this.on(this.view.canvas, 'keydown', (event) => this.shortcut(event));
  }
  keepShown() {
    this.address.set({ show: byId('measure').value, wire: byId('wire').checked ? 1 : null });
  }
  keepCamera() {
    this.address.set({ cam: this.view.orbit.state().map((value) => Number(value.toFixed(5))) });
  }
  async copyAddress() {
    this.address.write();
    const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    byId('share').textContent = isCopied ? 'Copied' : 'It is in the address bar';
    setTimeout(() => (byId('share').textContent = 'Copy the address'), 2000);
  }

  /** On the 3D view: digits choose what is shown, w the edges. */
  shortcut(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const option = [...byId('measure').options].filter(({ hidden }) => !hidden)[Number(event.key) - 1];
    if (event.key === 'w') byId('wire').checked = !byId('wire').checked;
    else if (option) byId('measure').value = option.value;
    else return;
    this.recolour();
    this.keepShown();
  }

  /** Ends what the page does for this asset; another may be shown then. */
  end() {
    this.listeners.abort();
    for (const id of ['graph', 'treemap']) byId(id).replaceWith(byId(id).cloneNode()); // with their listeners
    byId('mesh').replaceChildren();
    byId('selection').replaceChildren(...this.unselected);
    byId('cut-text').textContent = '';
    this.asset.close();
  }

  applyTheme(isDark) {
    document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
    this.theme = readTheme();
    this.graph.theme = this.theme;
    if (this.view) this.view.theme = this.theme;
    this.recolour();
  }

  // ----------------------------------------------------------------------------------------------- colours, selection

  get pixelError() {
    return 2 ** (Number(byId('pixels').value) / 10);
  }
  sayPixels() {
    const pixels = this.pixelError;
    say('pixels', pixels === 1 ? '1 pixel' : `${short(pixels)} pixels`);
  }

  recolour() {
    const shown = byId('measure').value;
    const measure = LEGENDS[shown] ? shown : 'cluster';
    this.graph.measure = measure;
    this.graph.draw();
    byId('legend').textContent = `${this.graph.legend()} A bar below a cell: it is in the cut.`;
    const bytes = new Uint8Array(4 * this.asset.clusters.length);
    for (let c = 0; c < this.asset.clusters.length; ++c) {
      bytes.set(colourBytes(measureOf(this.asset, this.cap, measure, c), this.theme), 4 * c);
      bytes[4 * c + 3] = c === this.selected ? 0 : 255;
    }
    this.view?.setMode(shown, byId('wire').checked);
    this.view?.setColours(bytes);
  }

  showGraph(mesh) {
    this.graph.show(mesh);
    const { meshes } = this.asset;
    byId('graph-head').textContent = meshes.length > 1 ? `DAG of mesh ${mesh}: ${meshes[mesh]?.name || '(no name)'}` : 'DAG';
  }

  select(cluster) {
    this.selected = cluster;
    this.address.set({ cluster });
    const mesh = this.asset.groups[this.asset.clusters[cluster].coarserGroup].mesh;
    if (this.graph.mesh !== mesh) this.showGraph(mesh);
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
    fillList(byId('selection'), [
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
    ]);
  }

  /** A line per cluster: numbers and the runtime's own words alone, so that no text of the asset's is a formula. */
  clustersAsCsv() {
    const { asset } = this;
    const error = (value) => (value >= INFINITE_ERROR ? '' : value);
    const lines = asset.clusters.map((cluster, c) => {
      const group = asset.groups[cluster.coarserGroup];
      const own = cluster.ownGroup === NONE ? 0 : asset.groups[cluster.ownGroup].error;
      return [c, group.mesh, cluster.level, cluster.triangleCount, cluster.vertexCount, error(own), error(group.error), group.page,
        STUCK_REASONS[group.stuckReason] ?? 'unknown', Number(this.graph.inCut.has(c))].join();
    });
    return `cluster,mesh,level,triangles,vertices,own_error,coarser_error,page,stuck,in_cut\n${lines.join('\n')}\n`;
  }

  // ------------------------------------------------------------------------------------------------------------ texts

  fillTexts() {
    const { facts, asset } = this;
    const source = asset.meshes.reduce((sum, mesh) => sum + mesh.sourceTriangles, 0);
    byId('summary').textContent =
      `${count(source, 'source triangle')} in ${count(asset.meshes.length, 'mesh')}, ${count(asset.instances.length, 'instance')}, ` +
      `${count(asset.clusters.length, 'cluster')}, ${count(asset.groups.length, 'group')}, ${count(asset.pages.length, 'page')}; ` +
      `${count(facts.file_bytes, 'byte')}.`;
    const isPart = facts.embedded_page_bytes < facts.page_bytes;
    byId('omitted').hidden = !isPart;
    if (!isPart) return;
    byId('omitted').textContent =
      `Only coarser levels are in this page: ${number(facts.embedded_page_bytes)} of ${number(facts.page_bytes)} bytes of pages. ` +
      'Finer clusters are in the graph and the tables, not in 3D.';
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
    fillTable(byId('levels'), ['level', 'clusters', 'triangles', 'fill', 'largest error', 'stuck clusters', ...absent],
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
    byId('bytes').parentElement.hidden = rows.length === 0;
    byId('bytes-text').textContent = this.bytesText(bits, names);
    const { sections, file_bytes: all } = this.facts;
    fillTable(byId('sections'), ['section', 'bytes', 'share of the file'],
      sections.map(([name, size]) => [SECTION_WORDS[name] ? `${name}: ${SECTION_WORDS[name]}` : name, number(size), size / Math.max(1, all)]));
    const stored = (page) => this.facts.stored_pages?.[page][0] ?? this.asset.pages[page].storedBytes;
    const groups = bytesOf(this.asset, sections, stored, SECTION_WORDS);
    const map = byId('treemap');
    new ResizeObserver(() => drawTreemap(map, groups)).observe(map);
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
  table.replaceChildren();
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
