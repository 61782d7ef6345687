// SPDX-License-Identifier: MIT
// The DAG of one mesh on a canvas: a row a level, the coarsest on top; groups as frames, clusters as cells in the order of what
// they became, so that what is below a cluster is what it was made from, as far as a DAG allows it. Zoomed sideways.
import { NONE } from 'meshlode';
import { LEGENDS, colourOf, measureOf } from './dag.js';

const MIN_SPAN = 1e-5; // of the row's width

export class Graph {
  constructor(canvas, asset, made, cap, onSelect) {
    Object.assign(this, { canvas, asset, made, cap, onSelect });
    this.measure = 'cluster';
    this.selected = NONE;
    this.inCut = new Set();
    this.start = 0; // the part of the rows that is seen
    this.span = 1;
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('pointerdown', (event) => this.#press(event));
    canvas.addEventListener('keydown', (event) => this.#key(event));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(mesh) {
    this.mesh = mesh;
    this.rows = layOut(this.asset, this.made, mesh);
    this.place = new Map();
    this.rows.forEach((row, level) => row.cells.forEach((cell, index) => this.place.set(cell.cluster, { level, index })));
    this.start = 0;
    this.span = 1;
    this.draw();
  }

  legend() {
    return LEGENDS[this.measure];
  }

  /** Selects without telling, and brings it into sight. */
  select(cluster) {
    this.selected = cluster;
    const at = this.place?.get(cluster);
    if (at) {
      const cell = this.rows[at.level].cells[at.index];
      if (cell.x < this.start || cell.x + cell.width > this.start + this.span) this.start = cell.x + cell.width / 2 - this.span / 2;
    }
    this.draw();
  }

  draw() {
    cancelAnimationFrame(this.request);
    this.request = requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    if (!this.rows) return;
    const { canvas, theme } = this;
    const ratio = window.devicePixelRatio || 1;
    const scale = ratio * letterScale(canvas);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    this.start = Math.max(0, Math.min(1 - this.span, this.start));
    const ink = canvas.getContext('2d');
    ink.clearRect(0, 0, width, height);
    const rowHeight = height / this.rows.length;
    const left = 34 * scale;
    const toX = (x) => left + ((x - this.start) / this.span) * (width - left);
    ink.font = `${11 * scale}px system-ui, sans-serif`;
    ink.textBaseline = 'middle';
    this.rows.forEach((row, level) => {
      const top = height - (level + 1) * rowHeight;
      ink.fillStyle = theme.quiet;
      ink.fillText(String(level), 6 * scale, top + rowHeight / 2);
      this.#drawCells(ink, row, top, rowHeight, toX, scale, left, width);
      this.#drawGroups(ink, row, top, rowHeight, toX, left, width);
    });
    this.#drawSelection(ink, height, rowHeight, toX, scale);
  }

  #drawCells(ink, row, top, rowHeight, toX, scale, left, width) {
    const body = rowHeight * 0.8;
    let drawnTo = -1;
    for (const cell of row.cells) {
      const from = Math.max(left, toX(cell.x));
      const to = Math.min(width, toX(cell.x + cell.width));
      if (to <= left || from >= width) continue;
      const value = measureOf(this.asset, this.cap, this.measure, cell.cluster);
      // Many to a pixel: one of them stands for all, but for those that have a mark.
      if (to - drawnTo < 0.5 && value.mark === '') continue;
      drawnTo = to;
      const gap = to - from > 4 * scale ? scale : 0;
      const share = Math.max(0.04, value.share) * body;
      ink.fillStyle = colourOf(value, this.theme);
      ink.fillRect(from, top + body - share + rowHeight * 0.08, Math.max(1, to - from - gap), share);
      if (this.inCut.has(cell.cluster)) {
        ink.fillStyle = this.theme.text;
        ink.fillRect(from, top + rowHeight * 0.91, Math.max(1, to - from - gap), Math.max(2, rowHeight * 0.05));
      }
      if (to - from < 14 * scale) continue;
      const word = value.mark || (to - from > 46 * scale ? String(cell.cluster) : '');
      if (!word) continue;
      ink.strokeStyle = this.theme.ground; // a rim, so that it is read on any colour
      ink.lineWidth = 3 * scale;
      ink.strokeText(word, from + 3 * scale, top + rowHeight * 0.5);
      ink.fillStyle = this.theme.text;
      ink.fillText(word, from + 3 * scale, top + rowHeight * 0.5);
    }
  }

  #drawGroups(ink, row, top, rowHeight, toX, left, width) {
    ink.strokeStyle = this.theme.line;
    ink.lineWidth = 1;
    for (const group of row.groups) {
      const from = toX(group.x);
      const to = toX(group.x + group.width);
      if (to - from < 6 || to < left || from > width) continue;
      ink.strokeRect(Math.max(left, from) + 0.5, top + 2.5, Math.min(width, to) - Math.max(left, from) - 1, rowHeight - 4);
    }
  }

  #drawSelection(ink, height, rowHeight, toX, scale) {
    const at = this.place.get(this.selected);
    if (!at) return;
    const cell = this.rows[at.level].cells[at.index];
    const from = toX(cell.x);
    const size = Math.max(4 * scale, toX(cell.x + cell.width) - from);
    const top = height - (at.level + 1) * rowHeight;
    ink.lineWidth = 3 * scale;
    ink.strokeStyle = this.theme.markText;
    ink.strokeRect(from - scale, top + scale, size + 2 * scale, rowHeight - 3 * scale);
    ink.fillStyle = this.theme.markText; // a wedge above, so that a cell thinner than its frame is found
    ink.beginPath();
    ink.moveTo(from + size / 2 - 6 * scale, top - 2 * scale);
    ink.lineTo(from + size / 2 + 6 * scale, top - 2 * scale);
    ink.lineTo(from + size / 2, top + 6 * scale);
    ink.fill();
  }

  /** Rows' x and level of a pointer. */
  #at(event) {
    const box = this.canvas.getBoundingClientRect();
    const left = 34 * letterScale(this.canvas);
    const x = this.start + ((event.clientX - box.left - left) / Math.max(1, box.width - left)) * this.span;
    const level = this.rows.length - 1 - Math.floor(((event.clientY - box.top) / box.height) * this.rows.length);
    return { x, level };
  }

  #zoom(factor, x) {
    const span = Math.max(MIN_SPAN, Math.min(1, this.span * factor));
    this.start = x - ((x - this.start) / this.span) * span;
    this.span = span;
    this.draw();
  }

  #wheel(event) {
    event.preventDefault();
    if (event.shiftKey) {
      this.start += (event.deltaY / this.canvas.clientWidth) * this.span;
      this.draw();
    } else {
      this.#zoom(Math.exp(event.deltaY * 0.002), this.#at(event).x);
    }
  }

  #press(event) {
    const begin = { x: event.clientX, start: this.start };
    let moved = false;
    const move = (e) => {
      moved ||= Math.abs(e.clientX - begin.x) > 4;
      if (moved) this.start = begin.start - ((e.clientX - begin.x) / this.canvas.clientWidth) * this.span;
      this.draw();
    };
    const end = (e) => {
      this.canvas.removeEventListener('pointermove', move);
      if (moved || e.type === 'pointercancel') return;
      const { x, level } = this.#at(e);
      const cell = this.rows[level]?.cells.find((c) => x >= c.x && x < c.x + c.width);
      if (cell) this.onSelect(cell.cluster);
    };
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.addEventListener('pointermove', move);
    this.canvas.addEventListener('pointerup', end, { once: true });
    this.canvas.addEventListener('pointercancel', end, { once: true });
  }

  #key(event) {
    const middle = this.start + this.span / 2;
    const at = this.place?.get(this.selected);
    const first = this.rows?.[this.rows.length - 1]?.cells[0];
    let next = NONE;
    if (event.key === '+' || event.key === '=') this.#zoom(0.7, middle);
    else if (event.key === '-') this.#zoom(1 / 0.7, middle);
    else if (event.key === 'Home') this.#zoom(1e9, middle);
    else if (event.key.startsWith('Arrow')) next = at ? this.#neighbour(at, event.key) : first?.cluster ?? NONE;
    else return;
    event.preventDefault();
    if (next !== NONE) this.onSelect(next);
  }

  #neighbour(at, key) {
    const cells = this.rows[at.level].cells;
    const cluster = this.asset.clusters[this.selected];
    if (key === 'ArrowLeft') return cells[at.index - 1]?.cluster ?? NONE;
    if (key === 'ArrowRight') return cells[at.index + 1]?.cluster ?? NONE;
    if (key === 'ArrowUp') return this.made[cluster.coarserGroup][0] ?? NONE;
    return cluster.ownGroup === NONE ? NONE : this.asset.groups[cluster.ownGroup].firstCluster;
  }
}

/** Against letters of 15 pixels: larger screens have larger ones. */
const letterScale = (canvas) => parseFloat(getComputedStyle(canvas).fontSize) / 15 || 1;

/** Rows by level: {groups, cells}, each with x and width in 0 … 1. */
function layOut(asset, made, meshId) {
  const mesh = asset.meshes[meshId];
  if (!mesh) return [{ groups: [], cells: [] }];
  const x = new Map(); // cluster -> middle of its cell
  const rows = Array.from({ length: Math.max(1, mesh.levelCount) }, () => ({ groups: [], cells: [] }));
  const byLevel = rows.map(() => new Map()); // a row's clusters, by the group that they are members of
  for (let c = mesh.firstCluster; c < mesh.firstCluster + mesh.clusterCount; ++c) {
    const cluster = asset.clusters[c];
    const row = byLevel[Math.min(cluster.level, rows.length - 1)];
    if (!row.has(cluster.coarserGroup)) row.set(cluster.coarserGroup, []);
    row.get(cluster.coarserGroup).push(c);
  }
  for (let level = rows.length - 1; level >= 0; --level) {
    // A group stands below the middle of what was made from it; one that nothing was made from comes last, in its own order.
    const groups = [...byLevel[level]].map(([group, members]) => {
      const above = made[group].map((c) => x.get(c)).filter((value) => value !== undefined);
      return { group, members, key: above.length > 0 ? above.reduce((a, b) => a + b) / above.length : 2 };
    });
    groups.sort((a, b) => a.key - b.key || a.group - b.group);
    const count = groups.reduce((sum, group) => sum + group.members.length, 0);
    let at = 0;
    for (const { group, members } of groups) {
      rows[level].groups.push({ group, x: at / count, width: members.length / count });
      for (const cluster of members) {
        rows[level].cells.push({ cluster, x: at / count, width: 1 / count });
        x.set(cluster, (at + 0.5) / count);
        at += 1;
      }
    }
  }
  return rows;
}
