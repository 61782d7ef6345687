// SPDX-License-Identifier: GPL-3.0-or-later
// Put into the report behind its own script: does what a reader does and writes what came of it, a line each, into the page.
'use strict';
(function () {
  const lines = [];
  const check = function (what, isTrue, detail) { lines.push((isTrue ? 'ok ' : 'FAILED ') + what + (isTrue ? '' : ': ' + detail)); };
  const finish = function () {
    const out = document.createElement('pre');
    out.id = 'probe';
    out.textContent = lines.join('\n') + '\nend';
    document.body.append(out);
  };
  window.addEventListener('error', function (event) { lines.push('FAILED script: ' + event.message); });
  try {
    const root = document.documentElement;
    check('nothing is wider than the window', root.scrollWidth <= window.innerWidth,
      root.scrollWidth + ' of ' + window.innerWidth);

    const folds = Array.from(document.querySelectorAll('.fold'));
    check('details are folded at first', folds.length !== 0 && folds.every(function (fold) { return !fold.open; }), folds.length);
    const top = document.querySelector('#summary .cards').getBoundingClientRect().top;
    check('the cards are on the first screen', window.innerWidth < 960 || top < 400, top);
    const cards = Array.from(document.querySelectorAll('.card'));
    check('three cards with a command to copy', cards.length === 3 && cards.every(function (card) {
      return card.querySelector('.command .copy') !== null;
    }), cards.length);
    const isDrawn = function (card) { return document.querySelector('.cut[data-point="' + card.dataset.point + '"]') !== null; };
    check('with its picture where the point has one', cards.some(isDrawn) && cards.every(function (card) {
      return (card.querySelector('img') !== null) === isDrawn(card);
    }), cards.map(isDrawn).join(' '));
    document.querySelector('nav a[href="#points"]').click();
    window.dispatchEvent(new Event('hashchange'));
    check('a link unfolds its section', document.querySelector('#points .fold').open, 'it is folded');
    folds.forEach(function (fold) { fold.open = true; });

    const table = document.querySelector('#points table');
    const headings = Array.from(table.tHead.rows[0].cells);
    const column = headings.findIndex(function (cell) { return cell.textContent === 'file'; });
    const values = function () {
      return Array.from(table.tBodies[0].rows).map(function (row) { return Number(row.cells[column].dataset.sort); });
    };
    const isSorted = function (numbers, turn) {
      return numbers.every(function (value, i) { return i === 0 || turn * (value - numbers[i - 1]) >= 0; });
    };
    const count = values().length;
    headings[column].querySelector('button').click();
    check('a table sorts ascending', isSorted(values(), 1), values().join(' '));
    check('and says so', headings[column].getAttribute('aria-sort') === 'ascending', headings[column].outerHTML);
    check('aloud', document.getElementById('said').textContent.includes('ascending'), 'nothing was said');
    headings[column].querySelector('button').click();
    check('a table sorts descending', isSorted(values(), -1), values().join(' '));
    check('no row is lost', values().length === count, values().length);

    const row = table.tBodies[0].rows[3];
    row.querySelector('.pick').click();
    const picked = Array.from(document.querySelectorAll('.mark.is-picked'));
    check('a point is picked out in the plots', picked.length >= 2, picked.length);
    check('and no other', picked.every(function (mark) { return mark.dataset.point === row.dataset.point; }), 'others are');
    check('its button is pressed', row.querySelector('.pick').getAttribute('aria-pressed') === 'true', 'not');
    row.querySelector('.pick').click();
    check('and let go', document.querySelector('.is-picked') === null, 'still picked');

    const stage = document.querySelector('.stage');
    const over = stage.querySelector('.is-shown .over'), full = stage.querySelector('.full img');
    const slider = stage.querySelector('input[type=range]'), choice = stage.querySelector('select');
    const a = over.getBoundingClientRect(), b = full.getBoundingClientRect();
    check('a cut lies over the full resolution', a.left === b.left && a.top === b.top && a.width === b.width && a.width > 0,
      JSON.stringify([a, b]));
    slider.value = '25';
    slider.dispatchEvent(new Event('input'));
    check('the slider moves the border', getComputedStyle(over).clipPath === 'inset(0px 0px 0px 25%)', getComputedStyle(over).clipPath);
    check('and says where it is', slider.getAttribute('aria-valuetext').includes('25%'), slider.outerHTML);
    choice.value = '1';
    choice.dispatchEvent(new Event('change'));
    const shown = stage.querySelectorAll('.cut.is-shown');
    check('another cut can be chosen', shown.length === 1 && shown[0] === stage.querySelectorAll('.cut')[1], shown.length);
    check('pictures are decoded', Array.from(document.images).every(function (one) { return one.naturalWidth > 0; }), 'not all');

    const paper = function () { return getComputedStyle(document.body).backgroundColor; };
    const choose = function (theme) {
      const input = document.querySelector('.theme input[value=' + theme + ']');
      input.checked = true;
      input.dispatchEvent(new Event('change'));
      return paper();
    };
    check('the switch makes it dark', choose('dark') === 'rgb(20, 23, 26)', paper());
    check('the switch makes it light', choose('light') === 'rgb(255, 255, 255)', paper());
    choose('system');

    const unnamed = Array.from(document.querySelectorAll('button, input, select, a')).filter(function (one) {
      return !(one.textContent.trim() || one.getAttribute('aria-label') || (one.labels && one.labels.length));
    });
    check('every control has a name', unnamed.length === 0, unnamed.map(function (one) { return one.outerHTML; }).join(' '));
    const pictures = Array.from(document.querySelectorAll('svg')).filter(function (one) {
      return !one.getAttribute('aria-labelledby').split(' ').every(function (id) { return document.getElementById(id); });
    });
    check('every plot has its title and description', pictures.length === 0, pictures.length);
    const look = new URLSearchParams(location.search).get('look');
    if (look) choose(look);
  } catch (error) {
    lines.push('FAILED probe: ' + error);
  }
  finish();
})();
