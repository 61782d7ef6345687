// SPDX-License-Identifier: GPL-3.0-or-later
// What the page can do beyond being read: tables sort, a point is picked out in all plots and tables, pictures lie over each
// other, colours switch. Everything is there without it. Written without the characters that XML takes for markup.
'use strict';
(function () {
  const all = function (selector, below) { return Array.from((below || document).querySelectorAll(selector)); };
  const make = function (tag, properties) { return Object.assign(document.createElement(tag), properties); };
  const say = function (text) { document.getElementById('said').textContent = text; };

  // Colours. Where nothing can be kept (a file opened from disk, in some browsers) the choice holds while the page is open.
  const recall = function () { try { return localStorage.getItem('meshlode-theme'); } catch (error) { return null; } };
  const keep = function (theme) { try { localStorage.setItem('meshlode-theme', theme); } catch (error) { return; } };
  const setTheme = function (theme) {
    if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
  };
  const kept = ['light', 'dark'].includes(recall()) ? recall() : 'system';
  setTheme(kept);
  all('.theme').forEach(function (set) { set.hidden = false; });
  all('.theme input').forEach(function (input) {
    input.checked = input.value === kept;
    input.addEventListener('change', function () { setTheme(input.value); keep(input.value); });
  });

  // Sorting: numbers by their value, those without one last either way; texts by letters, numbers in them as numbers.
  const keyOf = function (row, column, isNumber) {
    const cell = row.cells[column];
    const sorted = cell.dataset.sort;
    if (isNumber) return sorted === '' || sorted === undefined ? null : Number(sorted);
    return cell.textContent;
  };
  const compare = function (a, b, turn) {
    if (a === null || b === null) return (a === null ? 1 : 0) - (b === null ? 1 : 0);
    if (typeof a === 'number') return turn * Math.sign(a - b);
    return turn * a.localeCompare(b, 'en', { numeric: true });
  };
  const sortBy = function (table, column, heading) {
    const isUp = heading.getAttribute('aria-sort') !== 'ascending';
    const isNumber = heading.classList.contains('number');
    const body = table.tBodies[0];
    const keyed = Array.from(body.rows).map(function (row) { return [keyOf(row, column, isNumber), row]; });
    keyed.sort(function (a, b) { return compare(a[0], b[0], isUp ? 1 : -1); });
    keyed.forEach(function (pair) { body.append(pair[1]); });
    all('thead th', table).forEach(function (other) { other.removeAttribute('aria-sort'); });
    heading.setAttribute('aria-sort', isUp ? 'ascending' : 'descending');
    say(table.caption.textContent + ': sorted by ' + heading.textContent + (isUp ? ', ascending' : ', descending'));
  };
  all('table.sortable').forEach(function (table) {
    all('thead th', table).forEach(function (heading, column) {
      const button = make('button', { type: 'button', textContent: heading.textContent });
      heading.replaceChildren(button);
      button.addEventListener('click', function () { sortBy(table, column, heading); });
    });
  });

  // One point picked out everywhere.
  let picked = null;
  const pick = function (id) {
    picked = picked === id ? null : id;
    all('[data-point]').forEach(function (element) {
      element.classList.toggle('is-picked', element.dataset.point === picked);
    });
    all('svg.plot').forEach(function (plot) {
      plot.classList.toggle('has-picked', plot.querySelector('.is-picked') !== null);
    });
    all('.pick').forEach(function (button) {
      button.setAttribute('aria-pressed', String(button.closest('tr').dataset.point === picked));
    });
  };
  all('tr[data-point]').forEach(function (row) {
    const name = row.cells[0].querySelector('bdi');
    const button = make('button', { type: 'button', className: 'pick', title: 'Pick this point out in all plots' });
    button.setAttribute('aria-pressed', 'false');
    name.replaceWith(button);
    button.append(name);
    button.addEventListener('click', function () { pick(row.dataset.point); });
  });
  all('.mark[data-point]').forEach(function (mark) {
    mark.style.cursor = 'pointer';
    mark.addEventListener('click', function () { pick(mark.dataset.point); });
  });

  // Pictures.
  all('.stage').forEach(function (stage) {
    const cuts = all('.cut', stage);
    if (cuts.length === 0) return;
    const show = function (index) {
      cuts.forEach(function (cut, i) { cut.classList.toggle('is-shown', i === index); });
    };
    const control = make('div', { className: 'control' });
    const choice = make('select', {});
    cuts.forEach(function (cut, i) { choice.append(make('option', { value: String(i), textContent: cut.dataset.label })); });
    choice.addEventListener('change', function () { show(Number(choice.value)); });
    const slider = make('input', { type: 'range', min: '0', max: '100', value: '50' });
    slider.setAttribute('aria-valuetext', 'full resolution on the left 50%');
    slider.addEventListener('input', function () {
      stage.style.setProperty('--at', slider.value + '%');
      slider.setAttribute('aria-valuetext', 'full resolution on the left ' + slider.value + '%');
    });
    [['Cut: ', choice], ['Full resolution left of: ', slider]].forEach(function (pair) {
      const label = make('label', { textContent: pair[0] });
      label.append(pair[1]);
      control.append(label);
    });
    stage.prepend(control);
    stage.classList.add('is-live');
    show(0);
  });

  // A card shows its point's first picture, which the page has once, among those of all points.
  all('.card').forEach(function (card) {
    const picture = all('.stage .cut').find(function (cut) { return cut.dataset.point === card.dataset.point; });
    if (picture === undefined) return;
    const over = picture.querySelector('.over');
    card.append(make('img', { src: over.src, alt: over.alt }));
  });

  // Commands can be copied; where a browser keeps the clipboard from pages, the command is selected.
  all('.command code').forEach(function (code) {
    const button = make('button', { type: 'button', className: 'copy', textContent: 'Copy' });
    button.setAttribute('aria-label', 'Copy the command');
    button.addEventListener('click', function () {
      const done = function () { say('The command is copied.'); button.textContent = 'Copied'; };
      const choose = function () {
        getSelection().selectAllChildren(code);
        say('The command is selected.');
      };
      if (navigator.clipboard === undefined) choose();
      else navigator.clipboard.writeText(code.textContent).then(done, choose);
    });
    code.after(button);
  });

  // A link to a section unfolds it.
  const unfold = function () {
    const section = location.hash.length === 0 ? null : document.getElementById(location.hash.slice(1));
    if (section !== null) all('.fold', section).forEach(function (fold) { fold.open = true; });
  };
  window.addEventListener('hashchange', unfold);
  all('nav a').forEach(function (link) { link.addEventListener('click', function () { setTimeout(unfold, 0); }); });
  unfold();

  // Printed, the numbers are all there.
  let closed = [];
  window.addEventListener('beforeprint', function () {
    closed = all('details:not([open])');
    closed.forEach(function (element) { element.open = true; });
  });
  window.addEventListener('afterprint', function () { closed.forEach(function (element) { element.open = false; }); });
})();
