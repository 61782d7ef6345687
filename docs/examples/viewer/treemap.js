// SPDX-License-Identifier: MIT
// Where the bytes of a file are, as a treemap of two levels (squarified: Bruls, Huizing, van Wijk 2000). The parts of a group stand in
// its frame; each says its name and bytes as far as there is room, and in its tooltip.


/** Rectangles for sizes (falling, above 0) in a box: rows along its shorter side, each as square as it can be. */
function squarify(sizes, box) {
  const total = sizes.reduce((sum, size) => sum + size, 0);
  const scale = (box.width * box.height) / total;
  const out = [];
  let { x, y, width, height } = box;
  for (let at = 0; at < sizes.length; ) {
    const side = Math.min(width, height);
    const worst = (sum, largest, least) => Math.max((side * side * largest) / (sum * sum), (sum * sum) / (side * side * least));
    let sum = sizes[at] * scale;
    let end = at + 1;
    while (end < sizes.length) {
      const next = sizes[end] * scale;
      if (worst(sum + next, sizes[at] * scale, next) > worst(sum, sizes[at] * scale, sizes[end - 1] * scale)) break;
      sum += next;
      ++end;
    }
    const depth = side > 0 ? sum / side : 0;
    let along = 0;
    for (; at < end; ++at) {
      const length = depth > 0 ? (sizes[at] * scale) / depth : 0;
      out.push(width >= height ? { x, y: y + along, width: depth, height: length } : { x: x + along, y, width: length, height: depth });
      along += length;
    }
    if (width >= height) [x, width] = [x + depth, width - depth];
    else [y, height] = [y + depth, height - depth];
  }
  return out;
}

/** groups: [{name, parts: [{name, bytes}]}]. Fills the size that the SVG has: to be drawn again where that changes. */
export function drawTreemap(svg, groups) {
  const [width, height] = [Math.max(200, svg.clientWidth), Math.max(100, svg.clientHeight)];
  const letter = parseFloat(getComputedStyle(svg).fontSize); // its height; 0.6 of it is a wide letter's width
  const line = 1.3 * letter;
  const make = (name, attributes, parent) => {
    const made = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    parent.append(made);
    return made;
  };
  const write = (text, x, y, room, parent, className) => {
    const most = Math.floor(room / (0.6 * letter));
    if (most >= 4) make('text', { x, y, class: className }, parent).textContent = text.length > most ? `${text.slice(0, most - 1)}…` : text;
  };
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.replaceChildren();
  const falling = (list) => list.filter(({ bytes }) => bytes > 0).sort((a, b) => b.bytes - a.bytes);
  const sized = falling(groups.map((group) => ({ ...group, bytes: group.parts.reduce((sum, { bytes }) => sum + bytes, 0) })));
  const all = sized.reduce((sum, { bytes }) => sum + bytes, 0);
  const boxes = squarify(sized.map(({ bytes }) => bytes), { x: 0, y: 0, width, height });
  sized.forEach(({ name, bytes, parts }, g) => {
    const box = boxes[g];
    const share = `${name}: ${bytes.toLocaleString('en-GB')} bytes, ${Math.round((100 * bytes) / all)}%`;
    const head = box.height > 3 * line && box.width > 4 * letter ? 1.5 * letter : 0; // for the name of the group
    make('rect', { ...box, class: 'frame' }, svg);
    if (head > 0) write(share, box.x + 6, box.y + 1.1 * letter, box.width - 8, svg, 'head');
    const inside = { x: box.x + 1, y: box.y + head + 1, width: Math.max(0, box.width - 2), height: Math.max(0, box.height - head - 2) };
    const list = falling(parts);
    squarify(list.map((part) => part.bytes), inside).forEach((cell, k) => {
      const group = make('g', {}, svg);
      make('title', {}, group).textContent = `${name}, ${list[k].name}: ${list[k].bytes.toLocaleString('en-GB')} bytes, ${((100 * list[k].bytes) / all).toFixed(1)}% of the file`;
      make('rect', { ...cell, class: k % 2 === 0 ? 'part' : 'part odd' }, group);
      if (cell.height > line) write(list[k].name, cell.x + 5, cell.y + letter, cell.width - 6, group, '');
      if (cell.height > 2 * line) write(list[k].bytes.toLocaleString('en-GB'), cell.x + 5, cell.y + letter + line, cell.width - 6, group, 'quiet');
    });
  });
  svg.setAttribute('aria-label', `Bytes of the file. ${sized.map(({ name, bytes }) => `${name}: ${Math.round((100 * bytes) / all)}%`).join(', ')}`);
}

/** How many letters all names start with alike, to the end of a word: images of a scene are often named after it. */
function commonStart(names) {
  if (names.length < 2) return 0;
  let length = 0;
  while (length < names[0].length && names.every((name) => name[length] === names[0][length])) ++length;
  return names[0].slice(0, length).search(/[^A-Za-z0-9][A-Za-z0-9]*$/) + 1;
}

/** What the treemap shows of an asset: geometry by level, images, tables. `sections`: [name, bytes] of each. */
export function bytesOf(asset, sections, storedBytes, words) {
  const levels = [];
  asset.pages.forEach((page, p) => {
    // A page's bytes go to the levels of its clusters by their triangles.
    const clusters = asset.clusters.slice(page.firstCluster, page.firstCluster + page.clusterCount);
    const triangles = clusters.reduce((sum, { triangleCount }) => sum + triangleCount, 0);
    for (const { level, triangleCount } of clusters) levels[level] = (levels[level] ?? 0) + (storedBytes(p) * triangleCount) / triangles;
  });
  const blobs = asset.blobs.map(({ name, mimeType, sourceIndex, bytes }) => ({ name: name || `${mimeType} ${sourceIndex}`, bytes }));
  const common = commonStart(blobs.map(({ name }) => name));
  const images = blobs.map(({ name, bytes }) => ({ name: name.slice(common), bytes }));
  const tables = sections.filter(([name]) => name !== 'PAGE' && name !== 'BLOB');
  return [
    { name: 'geometry', parts: levels.map((bytes, level) => ({ name: `level ${level}`, bytes: Math.round(bytes) })) },
    { name: 'images', parts: images },
    { name: 'tables', parts: tables.map(([name, bytes]) => ({ name: words[name] ?? name, bytes })) },
  ];
}
