// SPDX-License-Identifier: GPL-3.0-or-later
// examples_test.mjs NPM MESHLODE SOURCE SCREENSHOTS: docs/examples/viewer and docs/examples/three in headless Chromium, from a server
// of ranges, with meshlode and three from npm. Every way to show an asset, addresses that are shared, files that are none, links and
// pools that are small, keys, themes, widths; where MESHLODE_MODELS has the models, the helmet and the bunny too, and the helmet's
// picture against that of its source by three's own loader.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { Browser } from '../viewer/chromium.mjs';
import { serve } from '../three/server.mjs';
import { installPackage } from '../three/package.mjs';
import { comparePictures } from './compare_pictures.mjs';

const [npmFolder, meshlode, source, screenshots] = process.argv.slice(2).map((path) => resolve(path));
const models = process.env.MESHLODE_MODELS;
let failures = 0;
const expect = (holds, what) => {
  console.log(`${holds ? 'holds' : 'FAILED'}: ${what}`);
  if (!holds) ++failures;
};
mkdirSync(screenshots, { recursive: true });
const { work } = installPackage(npmFolder);
const build = (name, scene) => execFileSync(meshlode, ['build', '--quiet', scene, '-o', join(work, `${name}.lode`), '--for', 'web']);

const IS_OVER = `document.documentElement.dataset.failed === 'yes' || document.documentElement.dataset.settled === 'yes'`;
const text = (id) => `document.getElementById('${id}').textContent`;
const set = (id, value, event) => `(() => { const e = document.getElementById('${id}');
  if (e.type === 'checkbox') e.checked = ${value}; else e.value = '${value}'; e.dispatchEvent(new Event('${event}')); })()`;
const middleOf = (id) => `(() => { const e = document.getElementById('${id}'); e.scrollIntoView({block: 'center'});
  const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()`;
/** A picture as a sum, and which share of it is not the ground. */
const PICTURE = `(() => { const { view, theme } = meshlodeViewer; view.drawNow(); const gl = view.renderer.getContext();
  const { drawingBufferWidth: w, drawingBufferHeight: h } = gl; const bytes = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  let [sum, other] = [0, 0];
  for (let i = 0; i < bytes.length; i += 4) { sum = (Math.imul(sum, 31) + bytes[i] * 65536 + bytes[i + 1] * 256 + bytes[i + 2]) | 0;
    other += theme.canvas.some((value, k) => Math.abs(value - bytes[i + k]) > 3); }
  return { sum, share: (4 * other) / bytes.length }; })()`;

let browser;
let server;
async function open(hash, view = {}) {
  const tab = await browser.open(`${server.origin}/viewer/index.html${hash}`, { width: 1280, height: 900, isDark: false, ...view });
  await tab.until(IS_OVER, 40);
  return tab;
}
const settle = async (tab, label) => {
  await tab.value('new Promise((done) => setTimeout(done, 50))');
  expect(await tab.until('meshlodeViewer.view.lode.isSettled', 40), `${label}: settles`);
};
const shoot = async (tab, name) => writeFileSync(join(screenshots, `example-${name}.png`), await tab.screenshot());
const expectSilence = (tab, label) => expect(tab.said.length === 0, `${label}: nothing on the console ${tab.said.join('; ')}`);

async function lookAtModes(name) {
  const tab = await open(`#lode=/assets/${name}.lode`);
  expect((await tab.value(text('summary'))).includes('source triangles'), `${name}: ${await tab.value(text('summary'))}`);
  await settle(tab, name);
  const seen = new Map();
  for (const mode of ['textured', 'cluster', 'level', 'normals', 'fill', 'ratio', 'stuck', 'page']) {
    await tab.value(set('measure', mode, 'change'));
    const { sum, share } = await tab.value(PICTURE);
    expect(share > 0.02 && share < 0.95, `${name}: ${mode} covers ${Math.round(100 * share)}% of the view`);
    seen.set(mode, sum);
    if (['textured', 'cluster', 'level', 'normals'].includes(mode)) await shoot(tab, `${name}-${mode}`);
    await tab.value(set('wire', true, 'change'));
    expect((await tab.value(PICTURE)).sum !== sum, `${name}: ${mode} with edges is another picture`);
    const [edges, triangles] = await tab.value('[meshlodeViewer.view.edges, meshlodeViewer.view.triangles]');
    expect(edges === 3 * triangles, `${name}: ${mode} has ${edges} edges of ${triangles} triangles`);
    if (mode === 'cluster') await shoot(tab, `${name}-edges`);
    await tab.value(set('wire', false, 'change'));
    expect((await tab.value(PICTURE)).sum === sum, `${name}: ${mode} without them is what it was`);
  }
  // A batch of clusters that have come and are not drawn yet.
  await tab.value(set('wire', true, 'change'));
  const end = await tab.value(`(() => { const { view } = meshlodeViewer; const other = view.lode.children[0].clone(); other.userData = { shown: [] }; view.lode.add(other);
    try { view.drawNow(); return 'a picture'; } catch (error) { return error.message; } finally { view.lode.remove(other); other.dispose(); } })()`);
  expect(end === 'a picture', `${name}: edges with a new batch: ${end}`);
  await tab.value(set('wire', false, 'change'));
  const alike = [...seen].filter(([, sum], i) => [...seen.values()].indexOf(sum) !== i).map(([mode]) => mode);
  // Where nothing is stuck all is one colour, as where all clusters are full.
  expect(alike.every((mode) => ['stuck', 'ratio', 'fill'].includes(mode)), `${name}: modes differ ${alike.join(' ')}`);
  const fine = await tab.value('meshlodeViewer.view.lode.drawn.clusters.length');
  await tab.value(set('pixels', 60, 'input'));
  await settle(tab, `${name}, 64 pixels`);
  let coarse = fine; // the worker may be a while behind the picture
  for (let tries = 0; tries < 50 && coarse >= fine; ++tries) {
    await new Promise((resolve) => setTimeout(resolve, 100));
    coarse = await tab.value('meshlodeViewer.view.lode.drawn.clusters.length');
  }
  expect(coarse < fine, `${name}: ${fine} clusters at one pixel, ${coarse} at 64`);
  expect((await tab.value('document.querySelectorAll("#treemap rect").length')) > 8, `${name}: bytes are a treemap`);
  expectSilence(tab, name);
  await tab.close();
}

const STATE = `(() => { const v = meshlodeViewer; const value = (id) => document.getElementById(id).value;
  return JSON.stringify([value('measure'), value('pixels'), value('pool'), value('link'), value('latency'), document.getElementById('wire').checked,
    v.selected, document.documentElement.dataset.theme, v.view.orbit.state().map((x) => x.toFixed(3)), v.view.lode.pixelError]); })()`;
async function lookAtAddress() {
  const tab = await open('#lode=/assets/rock.lode');
  for (const [id, value, event] of [['measure', 'level', 'change'], ['wire', true, 'change'], ['pixels', 13, 'input'], ['latency', 1, 'input'],
    ['pool', 7, 'input'], ['link', 8, 'input']]) await tab.value(set(id, value, event));
  await tab.value(`document.getElementById('theme').click(); document.getElementById('mesh-view').focus()`);
  for (const key of ['ArrowLeft', 'ArrowUp', 'ArrowUp']) await tab.press(key);
  await tab.value(`document.getElementById('graph').focus()`);
  await tab.press('ArrowDown');
  await settle(tab, 'address');
  await tab.value('meshlodeViewer.address.write()');
  const [hash, state, picture] = [await tab.value('location.hash'), await tab.value(STATE), await tab.value(PICTURE)];
  const other = await open(hash);
  await settle(other, 'address, again');
  expect((await other.value(STATE)) === state, `an address brings the state back: ${hash} ${await other.value(STATE)} ${state}`);
  const again = await other.value(PICTURE);
  expect(Math.abs(again.share - picture.share) < 1e-3, `and the picture: ${picture.share} and ${again.share} of the view`);
  const third = await open(hash);
  await settle(third, 'address, once more');
  expect((await third.value(PICTURE)).sum === again.sum, 'one address is one picture, bit for bit');
  await third.close();
  await other.value('meshlodeViewer.address.write()');
  expect((await other.value('location.hash')) === hash, 'and is the same address');
  await other.close();
  expectSilence(tab, 'address');
  await tab.close();
  const odd = await open('#lode=/assets/rock.lode&show=<img src=x>&px=1e9&wire=yes&cam=NaN,1,2,3,,Infinity&mesh=99&cluster=-1&pool=0.5&link=99&latency=x&theme=x&y');
  await settle(odd, 'an address of nonsense');
  expect((await odd.value(PICTURE)).share > 0.02 && (await odd.value('document.getElementById("measure").value')) === 'textured', 'an address of nonsense: the first picture');
  expectSilence(odd, 'an address of nonsense');
  await odd.close();
}

async function lookAtBadFiles() {
  const rock = readFileSync(join(work, 'rock.lode'));
  const flip = (at) => {
    const copy = Buffer.from(rock);
    copy[at] ^= 0x40;
    return copy;
  };
  const huge = Buffer.from(rock);
  huge.writeBigUInt64LE(2n ** 62n, 16);
  const bad = { empty: Buffer.alloc(0), short: rock.subarray(0, 40), noise: Buffer.alloc(9999, 0x5a), cut: rock.subarray(0, 900), table: flip(100), head: flip(700), huge };
  for (const [name, bytes] of Object.entries(bad)) writeFileSync(join(work, `${name}.lode`), bytes);
  const addresses = ['nothere.lode', ...Object.keys(bad).map((name) => `${name}.lode`)].map((name) => `/assets/${name}`);
  for (const lode of [...addresses, 'http://127.0.0.1:9/x.lode', 'javascript:alert(1)', '//[', 'data:,x']) {
    const tab = await open(`#lode=${encodeURIComponent(lode)}`);
    const said = `${await tab.value(text('summary'))} ${await tab.value(text('errors'))}`;
    const hasEnded = await tab.value(`document.documentElement.dataset.failed === 'yes' || !document.getElementById('errors').hidden`);
    expect(hasEnded && /cannot be shown: .{8}|Nothing more is loaded/.test(said), `${lode}: ${said.slice(0, 140)}`);
    expect(!tab.said.some((line) => /Uncaught|TypeError|RangeError/.test(line)), `${lode}: no exception ${tab.said.join('; ').slice(0, 200)}`);
    await tab.close();
  }
  // A page that is broken: coarser geometry and a line that says so; another file may be opened in its place.
  const whole = await open('#lode=/assets/terrain.lode');
  const late = 1000 + (await whole.value('meshlodeViewer.asset.pages.at(-1).offset'));
  await whole.close();
  server.fault = ({ path, first, last, bytes }) => {
    if (!path.endsWith('/terrain.lode') || late < first || last < late) return null;
    const body = Buffer.from(bytes);
    body[late - first] ^= 0x10;
    return { body };
  };
  const tab = await open('#lode=/assets/terrain.lode&px=-20');
  await tab.until(`!document.getElementById('errors').hidden`, 20);
  expect(/^page \d+: .*Coarser geometry/.test(await tab.value(text('errors'))), `a broken page: ${await tab.value(text('errors'))}`);
  expect((await tab.value(PICTURE)).share > 0.02, 'a broken page: coarser geometry is drawn');
  await shoot(tab, 'broken-page');
  server.fault = null;
  await tab.value(`document.getElementById('lode').value = '/assets/rock.lode'; document.getElementById('open').requestSubmit()`);
  expect(await tab.until(`${IS_OVER} && meshlodeViewer.facts.file_bytes === ${rock.length}`, 20), 'another file: is opened');
  expect(await tab.value(`document.getElementById('errors').hidden && location.hash.includes('rock.lode')`), 'another file: its address, and nothing is wrong');
  await tab.value('meshlodeViewer.select(3); new Promise((done) => setTimeout(done, 500))');
  expectSilence(tab, 'another file');
  // A head that does not come: its request ends with the next file, or with time. Nothing of the files before is left.
  server.fault = ({ path }) => (path.endsWith('/terrain.lode') ? { hang: true } : null);
  const ask = (lode) => tab.value(`document.getElementById('lode').value = '/assets/${lode}.lode'; document.getElementById('open').requestSubmit()`);
  await tab.value(`window.signals = []; window.fetch = new Proxy(fetch, { apply: (call, self, args) => (signals.push(args[1]?.signal), Reflect.apply(call, self, args)) });
    window.setTimeout = new Proxy(setTimeout, { apply: (call, self, [what, ms]) => Reflect.apply(call, self, [what, ms === 30000 ? limitMs : ms]) });
    window.limitMs = 300;`);
  await ask('terrain');
  expect(await tab.until(`/cannot be shown: too slow/.test(${text('summary')})`, 10), `no head: ${await tab.value(text('summary'))}`);
  expect(await tab.value(`${text('selection')}.startsWith('Nothing is selected') && ${text('cut-text')} + ${text('statistics')} === ''`), 'no head: nothing is said of the file before');
  await tab.value('limitMs = 30000');
  await ask('terrain');
  await ask('rock');
  expect(await tab.until(`${IS_OVER} && signals[1].aborted && !signals[2].aborted`, 20), 'no head: another file ends the request');
  server.fault = null;
  await tab.close();
}

async function lookAtLinks() {
  const tab = await open('#lode=/assets/terrain.lode&link=2&latency=4&px=-20');
  await settle(tab, 'a slow link');
  const { bytesRead, requests } = await tab.value('meshlodeViewer.view.lode.statistics');
  const time = `(async () => { const start = performance.now(); await meshlodeViewer.load(); meshlodeViewer.view.draw();
    const { view } = meshlodeViewer; while (!(view.lode.isSettled && view.lode.statistics.missing === 0)) await new Promise((done) => setTimeout(done, 10));
    return performance.now() - start; })()`;
  const slow = await tab.value(time);
  await tab.value(set('link', 9, 'input'));
  await tab.value(set('latency', 0, 'input'));
  const fast = await tab.value(time);
  const due = (8 * bytesRead) / 2000 + 2 * 100; // two round trips at least: the head, then pages
  expect(slow > 0.95 * due && slow > fast, `2 Mbit/s: ${bytesRead} bytes in ${requests} requests take ${Math.round(slow)} ms, at least ${
    Math.round(due)}; without a limit ${Math.round(fast)}`);
  const before = await tab.value('meshlodeViewer.view.lode.drawn.clusters.length');
  await tab.value(set('pool', 0, 'change'));
  await tab.value('meshlodeViewer.load()');
  await settle(tab, 'a small pool');
  await tab.until('meshlodeViewer.view.lode.statistics.isFull', 10);
  const { isFull, drawnClusters } = await tab.value('meshlodeViewer.view.lode.statistics');
  expect(isFull && drawnClusters < before && (await tab.value(text('statistics'))).includes('full'), `a pool of half a mebibyte is full: ${drawnClusters} of ${before} clusters`);
  const isMet = `(async () => { const end = meshlodeViewer.load(); ${set('pixels', 20, 'input')}; await end; return meshlodeViewer.view.lode.pixelError === 4; })()`;
  expect(await tab.value(isMet), 'an error that is set while a file is opened holds');
  expectSilence(tab, 'links');
  await tab.close();
}

async function lookAtHands() {
  const early = await browser.open(`${server.origin}/viewer/index.html#lode=/assets/rock.lode&latency=7`, { width: 1280, height: 900, isDark: false });
  await early.until('window.meshlodeViewer !== undefined', 20);
  await early.click(...(await early.value(middleOf('mesh-view'))));
  expect(await early.value('meshlodeViewer.view.lode === null && meshlodeViewer.selected === 0xffffffff'), 'a click before anything is drawn');
  expectSilence(early, 'a click before anything is drawn');
  await early.close();
  const tab = await open('');
  expect((await tab.value(text('summary'))).startsWith('Drop a .lode'), 'without an address: says what to do');
  await shoot(tab, 'empty');
  const drop = (bytes, name) => tab.value(`(async () => { const data = new DataTransfer(); data.items.add(new File([${bytes}], '${name}'));
    for (const event of ['dragover', 'drop']) dispatchEvent(new DragEvent(event, { dataTransfer: data, cancelable: true })); })()`);
  await tab.value(`window.freed = []; URL.revokeObjectURL = new Proxy(URL.revokeObjectURL, { apply: (call, self, args) => (freed.push(...args), Reflect.apply(call, self, args)) });`);
  await drop('"noise"', 'noise.lode');
  expect(await tab.until(`/noise.lode cannot be shown/.test(${text('summary')}) && freed.length === 1`, 10), 'a dropped file that is none: is refused and freed');
  // A file that is dropped.
  await drop(`await (await fetch('/assets/rock.lode')).blob()`, 'dropped <b>.lode');
  expect(await tab.until(`window.meshlodeViewer?.view.lode?.isSettled`, 20), 'a dropped file: is shown');
  expect((await tab.value('document.title')).startsWith('dropped <b>.lode') && !(await tab.value('location.hash')).includes('blob'), 'a dropped file: its name, and no address of it');
  await tab.value(`document.getElementById('mesh-view').focus()`);
  await tab.press('2');
  expect((await tab.value(`document.getElementById('measure').value`)) === 'cluster', 'the key 2 shows clusters');
  await tab.press('w');
  expect(await tab.value(`document.getElementById('wire').checked`), 'the key w shows edges');
  const yaw = await tab.value('meshlodeViewer.view.orbit.yaw');
  await tab.press('ArrowRight');
  expect((await tab.value('meshlodeViewer.view.orbit.yaw')) !== yaw, 'keys turn it');
  await settle(tab, 'keys');
  const [x, y] = await tab.value(middleOf('mesh-view'));
  await tab.click(x, y);
  expect(await tab.until('meshlodeViewer.selected !== 0xffffffff', 5), 'a click selects');
  expect(await tab.value('meshlodeViewer.view.lode.drawn.clusters.includes(meshlodeViewer.selected)'), 'what it selects is drawn');
  expect((await tab.value(text('selection'))).includes('in the cut'), 'and described');
  await shoot(tab, 'selected');
  // What the buttons give.
  await tab.value(`window.given = []; URL.createObjectURL = (blob) => (given.push(blob), 'data:,'); HTMLAnchorElement.prototype.click = () => {};
    for (const id of ['csv', 'png']) document.getElementById(id).click()`);
  await tab.until('given.length === 2', 10);
  const [csv, png] = await tab.value(`Promise.all([given.find((b) => b.type === 'text/csv').text(), given.find((b) => b.type === 'image/png').arrayBuffer()
    .then((b) => new DataView(b)).then((v) => [v.getUint32(0), v.getUint32(16), v.getUint32(20)])])`);
  const lines = csv.trim().split('\n');
  const drawn = await tab.value('new Set(meshlodeViewer.view.lode.drawn.clusters).size');
  expect(lines.length === 1 + (await tab.value('meshlodeViewer.asset.clusters.length')) && lines.slice(1).filter((line) => line.endsWith(',1')).length === drawn &&
    lines.slice(1).every((line) => /^\d+,\d+,\d+,\d+,\d+,[0-9.e-]*,[0-9.e-]*,\d+,[a-z_]+,[01]$/.test(line)), `CSV: ${lines.length - 1} clusters, ${drawn} of them drawn`);
  const size = await tab.value(`[document.getElementById('mesh-view').width, document.getElementById('mesh-view').height]`);
  expect(png[0] === 0x89504e47 && png[1] === size[0] && png[2] === size[1], `PNG: ${png[1]} x ${png[2]}`);
  expectSilence(tab, 'hands');
  await tab.close();
}

async function lookAtForms(name) {
  for (const [width, height] of [[390, 844], [1280, 900], [3840, 2160]]) {
    for (const isDark of width === 3840 ? [true] : [false, true]) {
      const tab = await open(`#lode=/assets/${name}.lode`, { width, height, isDark });
      const label = `${name}, ${width} pixels, ${isDark ? 'dark' : 'light'}`;
      await settle(tab, label);
      expect(await tab.value(`document.documentElement.scrollWidth <= ${width}`), `${label}: nothing is wider than the window`);
      expect(await tab.value(`document.documentElement.dataset.theme === '${isDark ? 'dark' : 'light'}'`), `${label}: the theme`);
      expect((await tab.value(PICTURE)).share > 0.02, `${label}: something is drawn`);
      await shoot(tab, `${name}-${width}-${isDark ? 'dark' : 'light'}`);
      if (width === 1280 && !isDark) {
        await tab.send('Accessibility.enable');
        const { nodes } = await tab.send('Accessibility.getFullAXTree');
        const focusable = nodes.filter((node) => !node.ignored && node.role.value !== 'RootWebArea' &&
          node.properties?.some(({ name: key, value }) => key === 'focusable' && value.value === true));
        const nameless = focusable.filter((node) => !node.name?.value);
        expect(focusable.length >= 15 && nameless.length === 0, `${focusable.length} controls have names ${nameless.map((n) => n.role.value).join(' ')}`);
      }
      expectSilence(tab, label);
      await tab.close();
    }
  }
}

async function lookAtSample() {
  const tab = await browser.open(`${server.origin}/three/index.html?/assets/rock.lode`, { width: 640, height: 480 });
  const bytes = readFileSync(join(work, 'rock.lode')).length;
  expect(await tab.until(`((said) => said && said[2] === '${bytes}' && said[1] > 0.99 * ${bytes})(/^(\\d+) of (\\d+) bytes$/.exec(${text('said')}))`, 20),
    `three: ${await tab.value(text('said'))}`);
  await tab.value('new Promise((done) => setTimeout(done, 300))');
  const picture = await tab.screenshot();
  writeFileSync(join(screenshots, 'example-three.png'), picture);
  expect(picture.length > 20000, `three: a picture of ${picture.length} bytes`);
  expectSilence(tab, 'three');
  await tab.close();
  const other = await browser.open(`${server.origin}/three/index.html?/assets/nothere.lode`, { width: 640, height: 480 });
  expect(await other.until(`/answers 404/.test(${text('said')})`, 20), `three: ${await other.value(text('said'))}`);
  await other.close();
}

build('rock', join(source, 'data/rock.glb'));
build('terrain', join(source, 'data/terrain.glb'));
build('foliage', join(source, 'data/foliage.glb'));
const ofModels = [['helmet', 'FlightHelmet/FlightHelmet.gltf'], ['bunny', 'bunny.glb']].filter(([, path]) => models && existsSync(join(models, path)));
for (const [name, path] of ofModels) build(name, join(models, path));
const examples = join(source, 'docs/examples');
const packages = join(work, 'node_modules');
server = await serve({ '/viewer/': join(examples, 'viewer'), '/viewer/node_modules/': packages, '/three/': join(examples, 'three'),
  '/three/node_modules/': packages, '/assets/': work, '/models/': models ?? work });
browser = await Browser.start();
try {
  await lookAtSample();
  for (const name of ['rock', 'foliage', ...ofModels.map(([one]) => one)]) await lookAtModes(name);
  await lookAtAddress();
  await lookAtBadFiles();
  await lookAtLinks();
  await lookAtHands();
  await lookAtForms(ofModels[0]?.[0] ?? 'rock');
  for (const [name, path] of ofModels) await comparePictures({ tab: await open(`#lode=/assets/${name}.lode`), name, address: `/models/${path}`, screenshots, expect });
} finally {
  await browser.end();
  await server.close();
  rmSync(work, { recursive: true });
}
console.log(failures === 0 ? `all holds; screenshots in ${screenshots}` : `${failures} FAILED`);
process.exit(failures === 0 ? 0 : 1);
