// SPDX-License-Identifier: MIT
// What a viewer knows of the DAG beyond the tables: who was made from whom, cuts of the pages that are there, and the measures
// that graph and mesh show. Nothing here draws.
import { NONE, INFINITE_ERROR, STUCK_REASONS } from 'meshlode';

/** For each group the clusters that were made from it. */
export function clustersMadeFrom(asset) {
  const made = asset.groups.map(() => []);
  asset.clusters.forEach((cluster, c) => {
    if (cluster.ownGroup !== NONE) made[cluster.ownGroup].push(c);
  });
  return made;
}

/**
 * The cut closest to `clusters` (of one instance) that draws pages in `present` alone. A group that is refined and whose page is
 * missing is not refined; finer ones are then missing too, because a page is there only with those it depends on.
 */
export function restrictCut(asset, made, present, clusters) {
  if (clusters.every((c) => present[asset.groups[asset.clusters[c].coarserGroup].page])) return clusters;
  const refined = new Set();
  const queue = Array.from(clusters, (c) => asset.clusters[c].coarserGroup);
  while (queue.length > 0) {
    const g = queue.pop();
    if (refined.has(g)) continue;
    refined.add(g);
    for (const c of made[g]) queue.push(asset.clusters[c].coarserGroup);
  }
  const drawn = [];
  for (const g of refined) {
    const group = asset.groups[g];
    if (!present[group.page]) continue;
    for (let c = group.firstCluster; c < group.firstCluster + group.clusterCount; ++c) {
      const own = asset.clusters[c].ownGroup;
      if (own === NONE || !refined.has(own) || !present[asset.groups[own].page]) drawn.push(c);
    }
  }
  return drawn.sort((a, b) => a - b);
}

export function countTriangles(asset, clusters) {
  let sum = 0;
  for (const c of clusters) sum += asset.clusters[c].triangleCount;
  return sum;
}

/** How many times the error of what it was made from a cluster's coarser group has; null at level 0, for roots, from error 0. */
export function errorRatio(asset, c) {
  const cluster = asset.clusters[c];
  if (cluster.ownGroup === NONE) return null;
  const own = asset.groups[cluster.ownGroup].error;
  const coarser = asset.groups[cluster.coarserGroup].error;
  return own > 0 && coarser < INFINITE_ERROR ? coarser / own : null;
}

export function stuckReason(asset, c) {
  const reason = asset.groups[asset.clusters[c].coarserGroup].stuckReason;
  return reason === 0 ? null : STUCK_REASONS[reason] ?? 'unknown';
}

/** A number of 32 bits that neighbours do not share. */
export function scatter(id) {
  let h = Math.imul(id + 1, 0x9e3779b1);
  h ^= h >>> 15;
  h = Math.imul(h, 0x85ebca6b);
  return (h ^ (h >>> 13)) >>> 0;
}

/** What a cluster shows under a measure: share (0 to 1: the height of its cell), hue in degrees or null, mark: a letter or ''. */
export function measureOf(asset, cap, measure, c) {
  const cluster = asset.clusters[c];
  if (measure === 'fill') return { share: Math.min(1, cluster.triangleCount / cap), hue: null, mark: '' };
  if (measure === 'ratio') {
    const ratio = errorRatio(asset, c);
    if (ratio === null) return { share: 0, hue: null, mark: '' };
    return { share: Math.min(1, Math.log2(Math.max(1, ratio)) / 6), hue: null, mark: '' };
  }
  if (measure === 'stuck') {
    const reason = stuckReason(asset, c);
    return reason === null ? { share: 0.15, hue: null, mark: '' } : { share: 1, hue: 25, mark: reason[0].toUpperCase() };
  }
  // 13 levels, which a million triangles have, before a hue comes again.
  if (measure === 'level') return { share: 1, hue: (210 + 332 * cluster.level) % 360, mark: '' };
  if (measure === 'page') {
    const page = asset.groups[cluster.coarserGroup].page;
    return { share: page % 2 === 0 ? 1 : 0.7, hue: (page * 137.508) % 360, mark: '' };
  }
  return { share: 1, hue: scatter(c) % 360, mark: '' };
}

export const LEGENDS = {
  fill: 'Height and depth of colour: how full a cluster is of triangles.',
  ratio: 'Height and depth of colour: error of the coarser group over that of the own one, from 1 to 64 times. Roots and level 0 have none.',
  stuck: 'Full height and a letter: its group could not be simplified. L locked, F flips, S seams, C components, T too small or topology, B locked border.',
  level: 'Hue: the level, blue for the finest; then green, yellow, red and violet.',
  page: 'Hue: the page; pages with odd numbers are lower.',
  cluster: 'Each cluster has a hue of its own.',
};

/** CSS colour of a measure: of one hue where it has one, else between the theme's two ends. */
export function colourOf(value, theme) {
  if (value.hue !== null) return `hsl(${value.hue} 55% ${theme.isDark ? 58 : 45}%)`;
  const mix = theme.low.map((low, k) => Math.round(low + (theme.high[k] - low) * value.share));
  return `rgb(${mix.join(' ')})`;
}

/** The same as three numbers up to 255. */
export function colourBytes(value, theme) {
  if (value.hue === null) return theme.low.map((low, k) => Math.round(low + (theme.high[k] - low) * value.share));
  const lightness = theme.isDark ? 0.58 : 0.45;
  const a = 0.55 * Math.min(lightness, 1 - lightness);
  return [0, 8, 4].map((n) => {
    const k = (n + value.hue / 30) % 12;
    return Math.round(255 * (lightness - a * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  });
}
