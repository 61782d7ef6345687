// SPDX-License-Identifier: MIT
// The page of a batch. All text comes from files: it gets into the page as text (textContent) and in no other way.
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const byId = id => document.getElementById(id);
  const COLORS = ['#4e79a7', '#76b7b2', '#59a14f', '#edc948', '#9c755f', '#bab0ac', '#b07aa1', '#f28e2b', '#888888'];
  const SEVERITIES = ['high', 'medium', 'low', 'warning'];

  // Characters that would turn or hide what stands around them are shown as what they are not.
  const clean = text => String(text).replace(/[\u0000-\u001f\u007f\u202a-\u202e\u2066-\u2069]/g, '\ufffd');
  const make = (name, text, className) => {
    const element = document.createElement(name);
    if (text !== undefined) element.textContent = clean(text);
    if (className) element.className = className;
    return element;
  };
  const number = value => Math.round(value).toLocaleString('en');
  const size = bytes => {
    for (const [unit, factor] of [['GB', 1e9], ['MB', 1e6], ['kB', 1e3]]) {
      if (Math.abs(bytes) >= factor) return (bytes / factor).toFixed(1) + ' ' + unit;
    }
    return number(bytes) + ' B';
  };
  const signed = (value, text) => (value > 0 ? '+' : value < 0 ? '\u2212' : '') + text(Math.abs(value));
  const share = (change, before) => before > 0 ? ' (' + signed(change / before * 100, v => v.toFixed(1) + '%') + ')' : '';
  const plural = (count, word) => number(count) + ' ' + word + (count === 1 ? '' : 's');
  const sum = (list, value) => list.reduce((all, item) => all + value(item), 0);

  // A picture is decoded when a row or the detail shows it, and never before.
  const thumbnail = asset => {
    const image = make('img');
    image.src = 'data:image/webp;base64,' + asset.thumbnail;
    image.alt = '';
    return image;
  };

  const assets = data.assets;
  const hasPictures = assets.some(a => a.thumbnail);
  document.body.classList.toggle('pictures', hasPictures);
  const ROW = hasPictures ? 44 : 26;  // pixels, as overview.css has it
  for (const asset of assets) {
    asset.made = !['failed', 'skipped'].includes(asset.status);
    asset.change = asset.made && asset.old !== undefined ? asset.bytes - asset.old : 0;
    asset.worst = asset.findings.length ? Math.min(...asset.findings.map(f => SEVERITIES.indexOf(f[0]))) : 9;
    asset.words = [asset.input, asset.output, asset.status, asset.error, asset.unread, asset.reason,
      ...asset.findings.flat()].filter(Boolean).join('\n').toLowerCase();
  }
  const FILTERS = [
    ['all', () => true],
    ['failed or skipped', a => !a.made || a.unread],
    ['with findings', a => a.findings.length > 0],
    ['stuck groups', a => a.stuck > 0],
    ['changed bytes', a => a.change !== 0],
    ['not from the cache', a => a.cache === 'miss'],
  ];

  function showSummary() {
    const bytes = sum(assets, a => a.made ? a.bytes : 0);
    const bad = assets.filter(a => !a.made || a.unread).length;
    byId('summary').textContent = plural(assets.length, 'asset') + ', ' + size(bytes) + ', ' + clean(data.generator);
    const alerts = [];
    if (!data.complete) alerts.push('The batch is not complete: it was interrupted, or is still at work.');
    if (bad) alerts.push(plural(bad, 'asset') + (bad === 1 ? ' is' : ' are') + ' missing or broken.');
    byId('alert').textContent = alerts.join(' ');
    byId('alert').hidden = !alerts.length;

    const add = (name, value, className) => {
      byId('counts').append(make('dt', name), make('dd', value, className));
    };
    const statuses = new Map();
    for (const asset of assets) statuses.set(asset.status, (statuses.get(asset.status) || 0) + 1);
    for (const [status, count] of statuses) {
      add(status, number(count), status === 'failed' || status === 'skipped' ? 'bad' : '');
    }
    const hits = assets.filter(a => a.cache === 'hit').length, misses = assets.filter(a => a.cache === 'miss').length;
    if (hits + misses) add('from the cache', hits + ' of ' + (hits + misses));
    if (data.against) {
      const old = sum(assets, a => a.old || 0) + sum(data.gone, g => g[1]);
      add('bytes', number(bytes) + ', ' + signed(bytes - old, number) + share(bytes - old, old));
    } else {
      add('bytes', number(bytes));
    }
    add('triangles', number(sum(assets, a => a.triangles)));
    if (assets.some(a => a.at_pixel !== undefined)) {
      add('at one pixel', number(sum(assets, a => a.at_pixel || 0)) +
        ' triangles drawn at one pixel of error, each asset by itself, framed in 1280 × 720');
    }
    add('stuck groups', number(sum(assets, a => a.stuck)));
    for (const severity of SEVERITIES) {
      const count = sum(assets, a => a.findings.filter(f => f[0] === severity).length);
      if (count) add(severity === 'warning' ? 'warnings' : 'faults, ' + severity, number(count), severity === 'high' ? 'bad' : '');
    }
    add('seconds', sum(assets, a => a.seconds).toFixed(1) + ', of processors ' + sum(assets, a => a.cpu).toFixed(1));
    const memory = Math.max(0, ...assets.map(a => a.memory));
    if (memory) add('most memory', size(memory));
    const versions = Object.entries(data.versions).map(([name, version]) => name + ' ' + version).join(', ');
    if (versions) add('versions', versions);
  }

  function showChanges() {
    if (!data.against) return;
    byId('changes').hidden = false;
    const changed = assets.filter(a => a.change !== 0)
      .sort((a, b) => Math.abs(b.change) - Math.abs(a.change) || b.change - a.change).slice(0, 10);
    const row = (cells, name) => {
      const line = make('tr');
      cells.forEach(cell => line.append(make(name, cell)));
      byId('changed').append(line);
    };
    row(['asset', 'before', 'now', 'change'], 'th');
    for (const a of changed) {
      row([a.output, number(a.old), number(a.bytes), signed(a.change, number) + share(a.change, a.old)], 'td');
    }
    const fresh = assets.filter(a => a.made && a.old === undefined).length;
    byId('gone').textContent = changed.length ? '' : 'No asset has other bytes. ';
    byId('gone').append(clean(plural(fresh, 'new asset') + ', ' + plural(data.gone.length, 'asset') + ' gone' +
      (data.gone.length ? ': ' + data.gone.slice(0, 10).map(g => g[0]).join(', ') : '')));
  }

  // The treemap: rows of rectangles, each row as near to squares as it gets (Bruls, Huizing, van Wijk 2000).
  let boxes = [];
  function layOut(items, x, y, w, h) {
    boxes = [];
    let left = sum(items, a => a.bytes), at = 0;
    while (at < items.length && left > 0 && w > 0 && h > 0) {
      const side = Math.min(w, h), scale = w * h / left;
      const worst = (bytes, least, most) => {
        const area = bytes * scale, s = side * side;
        return Math.max(s * most * scale / (area * area), area * area / (s * least * scale));
      };
      let end = at, bytes = 0;
      while (end < items.length) {
        const next = bytes + items[end].bytes;
        if (end > at && worst(next, items[end].bytes, items[at].bytes) > worst(bytes, items[end - 1].bytes, items[at].bytes)) break;
        bytes = next;
        ++end;
      }
      const thick = bytes * scale / side;
      let along = 0;
      for (; at < end; ++at) {
        const long = items[at].bytes * scale / thick;
        boxes.push(w >= h ? [items[at], x, y + along, thick, long] : [items[at], x + along, y, long, thick]);
        along += long;
      }
      if (w >= h) { x += thick; w -= thick; } else { y += thick; h -= thick; }
      left -= bytes;
    }
  }
  function drawMap() {
    const canvas = byId('map'), ratio = window.devicePixelRatio || 1;
    const w = canvas.clientWidth, h = canvas.clientHeight;
    canvas.width = w * ratio;
    canvas.height = h * ratio;
    const draw = canvas.getContext('2d');
    draw.scale(ratio, ratio);
    const items = assets.filter(a => a.made && a.bytes > 0).sort((a, b) => b.bytes - a.bytes);
    layOut(items, 0, 0, w, h);
    draw.font = '12px system-ui, sans-serif';
    for (const [asset, x, y, bw, bh] of boxes) {
      const all = sum(asset.streams, v => v) || 1;
      let done = 0;
      asset.streams.forEach((bytes, i) => {
        const part = bytes / all;
        draw.fillStyle = COLORS[i];
        if (bw >= bh) draw.fillRect(x + bw * done, y, bw * part, bh); else draw.fillRect(x, y + bh * done, bw, bh * part);
        done += part;
      });
      if (done === 0) { draw.fillStyle = '#888888'; draw.fillRect(x, y, bw, bh); }
      draw.strokeStyle = 'rgba(0, 0, 0, 0.6)';
      draw.strokeRect(x, y, bw, bh);
      if (bw < 60 || bh < 16) continue;
      draw.save();
      draw.beginPath();
      draw.rect(x + 2, y, bw - 4, bh);
      draw.clip();
      const name = clean(asset.output.slice(asset.output.lastIndexOf('/') + 1));
      draw.fillStyle = 'rgba(255, 255, 255, 0.8)';
      draw.fillRect(x + 2, y + 2, draw.measureText(name).width + 4, 15);
      draw.fillStyle = '#000000';
      draw.fillText(name, x + 4, y + 14);
      draw.restore();
    }
  }
  function boxAt(event) {
    const area = byId('map').getBoundingClientRect();
    const px = event.clientX - area.left, py = event.clientY - area.top;
    return boxes.find(([, x, y, w, h]) => px >= x && px < x + w && py >= y && py < y + h);
  }
  function showMap() {
    data.streams.forEach((name, i) => {
      const total = sum(assets, a => a.streams[i]);
      if (!total) return;
      const entry = make('span'), mark = make('i');
      mark.style.background = COLORS[i];
      entry.append(mark, clean(name) + ' ' + size(total));
      byId('legend').append(entry);
    });
    byId('map').addEventListener('pointermove', event => {
      const box = boxAt(event);
      if (box) byId('map-text').textContent = clean(box[0].output) + ': ' + streamText(box[0]);
    });
    byId('map').addEventListener('click', event => {
      const box = boxAt(event);
      if (!box) return;
      byId('search').value = box[0].output;
      byId('filter').selectedIndex = 0;
      choose();
      select(box[0]);
    });
    drawMap();
    window.addEventListener('resize', drawMap);
  }
  const streamText = asset => number(asset.bytes) + ' bytes: ' + (asset.streams
    .map((bytes, i) => [bytes, data.streams[i]]).filter(s => s[0] > 0).sort((a, b) => b[0] - a[0])
    .map(s => s[1] + ' ' + number(s[0])).join(', ') || 'streams are not known');

  // The table: what is chosen, sorted, and of that the rows in sight.
  const COLUMNS = [
    ['asset', a => a.output, a => a.output],
    ['status', a => a.unread ? 'broken' : a.status, a => a.unread ? 'broken' : a.status],
    ['bytes', a => a.made ? number(a.bytes) : '', a => a.made ? a.bytes : -1],
    ['change', a => a.change ? signed(a.change, number) : '', a => a.change],
    ['triangles', a => a.triangles ? number(a.triangles) : '', a => a.triangles],
    ['at 1 px', a => a.at_pixel !== undefined ? number(a.at_pixel) : '', a => a.at_pixel ?? -1],
    ['stuck', a => a.stuck ? number(a.stuck) : '', a => a.stuck],
    ['faults', a => a.findings.length ? a.findings.length + ' ' + ['high', 'med.', 'low', 'warn'][a.worst] : '', a => a.worst < 9 ? -a.worst * 1e4 + a.findings.length : -1e9],
    ['cache', a => a.cache === 'none' ? '' : a.cache, a => a.cache],
    ['seconds', a => a.seconds.toFixed(2), a => a.seconds],
  ];
  let chosen = [], sortBy = -1, isDown = true, selected = null;
  function choose() {
    const words = byId('search').value.toLowerCase().split(/\s+/).filter(Boolean);
    const exact = byId('search').value.toLowerCase();
    const filter = FILTERS[byId('filter').selectedIndex][1];
    chosen = assets.filter(a => filter(a) && (a.words.includes(exact) || words.every(word => a.words.includes(word))));
    if (sortBy >= 0) {
      const key = COLUMNS[sortBy][2];
      chosen.sort((a, b) => {
        const x = key(a), y = key(b);
        return (x < y ? -1 : x > y ? 1 : 0) * (isDown ? -1 : 1);
      });
    }
    byId('shown').textContent = plural(chosen.length, 'asset');
    byId('rows').style.height = chosen.length * ROW + 'px';
    byId('table').scrollTop = 0;
    showRows();
  }
  // The file's name, for that is what differs, and its folder below it.
  function showName(asset) {
    const frame = make('span', undefined, 'picture'), text = make('span', undefined, 'name');
    if (asset.thumbnail) frame.append(thumbnail(asset));
    const end = asset.output.lastIndexOf('/') + 1;
    text.append(make('span', asset.output.slice(end)), make('span', asset.output.slice(0, end), 'folder'));
    return [frame, text];
  }
  function showRows() {
    const table = byId('table');
    const first = Math.max(0, Math.floor(table.scrollTop / ROW) - 4);
    const last = Math.min(chosen.length, first + Math.ceil(table.clientHeight / ROW) + 8);
    const rows = [];
    for (let i = first; i < last; ++i) {
      const asset = chosen[i], row = make('div', undefined, 'row');
      row.style.top = i * ROW + 'px';
      row.setAttribute('role', 'row');
      row.setAttribute('aria-selected', asset === selected);
      COLUMNS.forEach(([name, text], c) => {
        const value = text(asset), cell = make('span', value);
        cell.title = clean(value);
        if (c === 0 && hasPictures) cell.replaceChildren(...showName(asset));
        if (c === 1) cell.className = asset.made && !asset.unread ? 'good' : 'bad';
        if (c === 3 && asset.change > 0) cell.className = 'bad';
        row.append(cell);
      });
      row.addEventListener('click', () => select(asset));
      rows.push(row);
    }
    byId('rows').replaceChildren(...rows);
  }
  function select(asset) {
    selected = asset;
    showRows();
    const detail = byId('detail');
    const head = make('p', asset.output), links = make('p');
    head.className = asset.made && !asset.unread ? '' : 'bad';
    for (const [link, name] of [[asset.page, 'page'], [asset.link, 'asset']]) {
      if (!link) continue;
      const anchor = make('a', name);
      anchor.href = link;  // relative, with a dot in front: batch_page.cpp
      links.append(anchor, ' ');
    }
    detail.replaceChildren(head, links, make('p', 'from ' + asset.input));
    if (asset.thumbnail) detail.prepend(thumbnail(asset));
    if (asset.error) detail.append(make('p', asset.error, 'bad'));
    if (asset.unread) detail.append(make('p', asset.unread, 'bad'));
    if (asset.thumbnail_note) detail.append(make('p', 'thumbnail: ' + asset.thumbnail_note, 'bad'));
    if (asset.made) detail.append(make('p', streamText(asset)));
    if (asset.at_pixel !== undefined) {
      detail.append(make('p', number(asset.triangles) + ' triangles, ' + number(asset.at_pixel) +
        ' drawn at one pixel of error, framed in 1280 × 720'));
    }
    if (asset.reason) detail.append(make('p', 'built, because ' + asset.reason));
    const costs = [asset.seconds.toFixed(2) + ' s, of processors ' + asset.cpu.toFixed(2) + ' s'];
    if (asset.memory) costs.push(size(asset.memory) + ' of memory');
    detail.append(make('p', costs.join(', ')));
    if (!asset.findings.length) return;
    const list = make('ul');
    for (const [severity, id, text] of asset.findings) list.append(make('li', severity + ', ' + id + ': ' + text));
    detail.append(list);
  }
  function showTable() {
    COLUMNS.forEach(([name], c) => {
      const button = make('button', name);
      button.type = 'button';
      button.addEventListener('click', () => {
        isDown = sortBy === c ? !isDown : c > 1;
        sortBy = c;
        [...byId('head').children].forEach((other, i) => other.setAttribute('aria-sort', i === c ? (isDown ? 'descending' : 'ascending') : 'none'));
        choose();
      });
      byId('head').append(button);
    });
    for (const [name] of FILTERS) byId('filter').append(make('option', name));
    byId('search').addEventListener('input', choose);
    byId('filter').addEventListener('change', choose);
    byId('table').addEventListener('scroll', showRows);
    window.addEventListener('resize', showRows);
    choose();
  }

  showSummary();
  showChanges();
  showMap();
  showTable();
})();
