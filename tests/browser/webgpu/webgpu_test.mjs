// SPDX-License-Identifier: GPL-3.0-or-later
// webgpu_test.mjs NPM RESIDENT_CUT MESHLODE DATA SCREENSHOTS: meshlode/webgpu from the tarball of `npm pack`, in headless Chromium
// on a CPU. decode.wgsl is held against the runtime integer by integer, what is selected against the native cut id by id, pictures
// against `render`, and hostile bytes must end in errors. Skipped, aloud, without Chromium or npm, or where this Chromium has no WebGPU
// (MESHLODE_REQUIRE_BROWSER=1, MESHLODE_REQUIRE_NPM=1: a failure). Times on a CPU say nothing, and none is taken.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { colouredSheet, herd } from '../three/herd.mjs';
import { serve } from '../three/server.mjs';
import { Browser, browserPath } from '../viewer/chromium.mjs';

const [npmFolder, residentCut, meshlode, data, screenshots] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const skip = (why, variable) => {
  const isAsked = process.env[variable] === '1';
  console.log(`${isAsked ? 'FAILED' : 'SKIPPED'}: ${why}`);
  process.exit(isAsked ? 1 : 77);
};
if (!browserPath) skip('no Chromium (Debian: chromium)', 'MESHLODE_REQUIRE_BROWSER');
if (spawnSync('npm', ['--version']).status !== 0) skip('no npm (Debian: npm)', 'MESHLODE_REQUIRE_NPM');

let failures = 0;
const expect = (holds, what) => {
  console.log(`${holds ? 'holds' : 'FAILED'}: ${what}`);
  if (!holds) ++failures;
};
const percent = (share) => `${(100 * share).toFixed(2)}%`;

const [WIDTH, HEIGHT] = [640, 480];
const work = mkdtempSync(join(tmpdir(), 'meshlode-webgpu-'));
const scenes = new Map();
/** Builds a scene's asset for the web. */
function build(name, scene = join(data, `${name}.glb`), options = []) {
  if (!scenes.has(name)) {
    scenes.set(name, { path: join(work, `${name}.lode`) });
    execFileSync(meshlode, ['build', '--quiet', scene, '-o', scenes.get(name).path, '--for', 'web', ...options]);
    const asset = runtime.open(readFileSync(scenes.get(name).path));
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const { transform: t, mesh } of asset.instances) {
      const { boundsMin, boundsMax, origin } = asset.meshes[mesh];
      for (let corner = 0; corner < 8; ++corner) {
        const p = [0, 1, 2].map((k) => origin[k] + (corner & (1 << k) ? boundsMax : boundsMin)[k]);
        for (let k = 0; k < 3; ++k) {
          const at = t[4 * k] * p[0] + t[4 * k + 1] * p[1] + t[4 * k + 2] * p[2] + t[4 * k + 3];
          [low[k], high[k]] = [Math.min(low[k], at), Math.max(high[k], at)];
        }
      }
    }
    Object.assign(scenes.get(name), { center: low.map((v, k) => (v + high[k]) / 2), radius: Math.hypot(...high.map((v, k) => v - low[k])) / 2,
      pages: asset.pages });
    asset.close();
  }
  return scenes.get(name);
}
/** A camera that frames the asset, from a direction. */
function frame(name, direction, distance) {
  const { center, radius } = build(name);
  const away = (distance * radius) / Math.sin(Math.PI / 8) / Math.hypot(...direction);
  return { eye: center.map((c, k) => c + direction[k] * away), target: center, near: 0.001 * radius };
}

async function open(browser, server, name, options = {}) {
  const tab = await browser.open(`${server.origin}/page.html`, { width: WIDTH, height: HEIGHT });
  if (!(await tab.until('window.test !== undefined', 30))) throw new Error(`no page: ${tab.said.join('; ')}`);
  if (name) {
    build(name);
    const opened = await tab.value(`test.open('/assets/${name}.lode', ${JSON.stringify(options)})`);
    expect(opened === 'ok', `${name}: opens ${opened === 'ok' ? '' : JSON.stringify(opened)}`);
  }
  return tab;
}
const look = (tab, camera) => tab.value(`test.setCamera(${JSON.stringify(camera)})`);
const settle = async (tab, label) => expect(await tab.value('test.settle()'), `${label}: settles`);
async function isQuiet(tab, label) {
  const [errors, lost] = await tab.value('[test.errors, test.lost]');
  expect(errors.length === 0 && lost.length === 0 && tab.said.length === 0, `${label}: nothing is said ${JSON.stringify([...errors, ...lost, ...tab.said])}`);
}
async function shoot(tab, name) {
  writeFileSync(join(screenshots, `webgpu-${name}.png`), await tab.screenshot());
}

async function compareDecoded(tab, names) {
  const all = {};
  for (const name of names) {
    build(name);
    const seen = await tab.value(`test.decodeAll('/assets/${name}.lode')`);
    expect(seen.wrong === 0 && seen.clusters > 0, `decode.wgsl, ${name}: ${seen.wrong} of ${seen.integers} integers of ${seen.clusters} clusters are wrong`);
    for (const [key, value] of Object.entries(seen)) all[key] = (all[key] ?? 0) + value;
  }
  expect(all.normals > 0 && all.uvs > 0 && all.colors > 0 && all.ranges > 0, `decode.wgsl: pages with normals, UVs, colours: ${all.normals}, ${all.uvs}, ${
    all.colors}; clusters of several materials: ${all.ranges}`);
}

const NO_PLANES = new Array(24).fill(0).join(' ');
/** What the native runtime selects. */
function natively(name, seen, planes = () => NO_PLANES) {
  const input = seen.map((one) => `${one.head} ${planes(one)} ${one.resident}`).join('\n');
  return execFileSync(residentCut, [build(name).path], { input, encoding: 'utf8', maxBuffer: 2 ** 28 }).split('\n').slice(0, -1);
}
const countIds = (seen) => seen.reduce((sum, { items }) => sum + (items === '' ? 0 : items.split(' ').length), 0);

/** Cameras all about a scene, with few pages and with all that are wanted. */
async function compareCuts(browser, server, name, options = {}) {
  const tab = await open(browser, server, name, { ...options, isCulled: false });
  const cameras = Array.from({ length: 6 }, (_, k) => frame(name, [Math.sin((Math.PI * k) / 3), 0.2 * (k % 3), Math.cos((Math.PI * k) / 3)], [1.2, 0.5, 3, 0.3][k % 4]));
  cameras.push({ ...cameras[1], orthoHeight: 2 * build(name).radius });
  const seen = [];
  let [wasFull, mostUsed] = [false, 0];
  for (const [k, camera] of cameras.entries()) {
    await tab.value(`test.lode.pixelError = ${[1, 1, 3, 0.25, 1, 0, 2][k]}`);
    await look(tab, camera);
    seen.push(await tab.value('test.drawn()'));
    await settle(tab, `${name}, camera ${k}`);
    seen.push(await tab.value('test.drawn()'));
    const { poolUsed, isFull } = await tab.value('test.lode.statistics');
    [wasFull, mostUsed] = [wasFull || isFull, Math.max(mostUsed, poolUsed)];
  }
  const said = natively(name, seen);
  const equal = said.filter((line, i) => line === seen[i].items).length;
  const residents = new Set(seen.map(({ resident }) => resident)).size;
  expect(said.length === seen.length && equal === seen.length && countIds(seen) > 0 && residents > 1,
    `${name}: ${equal} of ${seen.length} selections are the native cut, ${countIds(seen)} ids, ${residents} sets of pages`);
  if (options.poolBytes) expect(wasFull && mostUsed <= options.poolBytes, `${name}: the pool is full with ${mostUsed} of ${options.poolBytes} bytes`);
  await isQuiet(tab, name);
  await tab.close();
}

/** Many cameras and errors, some close to where a group begins to pass, while pages come or are withheld. */
async function compareManyCuts(browser, server, name, count, options = {}) {
  const tab = await open(browser, server, name, { ...options, isCulled: false });
  const seen = [];
  let state = 11;
  const random = () => (state = (Math.imul(state, 1103515245) + 12345) >>> 0) / 2 ** 32;
  for (let k = 0; k < count; ++k) {
    await tab.value(`(test.lode.pixelError = ${0.3 * 2 ** (5 * random())}, 0)`);
    await look(tab, frame(name, [random() - 0.5, random() - 0.3, random() - 0.5], 0.2 + 2 * random()));
    seen.push(await tab.value('test.drawn()'));
  }
  const said = natively(name, seen);
  const equal = said.filter((line, i) => line === seen[i].items).length;
  const residents = new Set(seen.map(({ resident }) => resident)).size;
  expect(said.length === count && equal === count && countIds(seen) > 0,
    `${name} ${JSON.stringify(options)}: ${equal} of ${count} selections are the native cut, ${countIds(seen)} ids, ${residents} sets of pages`);
  await isQuiet(tab, name);
  await tab.close();
}

/** Culled on the GPU: what lies outside by doubles may be drawn, what lies inside must be. */
async function compareCulled(browser, server, name, { frustumOf }) {
  const tab = await open(browser, server, name);
  const seen = [];
  for (let k = 0; k < 4; ++k) {
    await look(tab, frame(name, [Math.sin(2 * k), 0.3, Math.cos(2 * k)], [0.25, 0.1, 0.4, 0.15][k]));
    await settle(tab, `${name} culled, camera ${k}`);
    seen.push({ ...(await tab.value('test.drawn()')), planes: frustumOf(await tab.value('test.camera.viewProjection'), 0).join(' ') });
  }
  const [inside, all] = [natively(name, seen, ({ planes }) => planes), natively(name, seen)];
  let [wrong, culled, beyond] = [0, 0, 0];
  for (const [i, { items }] of seen.entries()) {
    const drawn = new Set(items.split(' '));
    const whole = new Set(all[i].split(' '));
    const must = inside[i].split(' ');
    wrong += must.filter((one) => !drawn.has(one)).length + [...drawn].filter((one) => !whole.has(one)).length;
    culled += whole.size - drawn.size;
    beyond += drawn.size - must.length;
  }
  expect(wrong === 0 && culled > 0, `${name} culled: ${wrong} ids are wrong, ${culled} of the cut are culled, ${beyond} are drawn that the native frustum leaves out`);
  await isQuiet(tab, `${name} culled`);
  await tab.close();
}

/** Pixels that only one of WebGPU and `render` covers. */
async function compareCoverage(browser, server, name, most) {
  const tab = await open(browser, server, name);
  for (const [k, direction] of [[0.4, 0.3, 1], [-1, 0.5, 0.2]].entries()) {
    const camera = frame(name, direction, 0.7);
    await look(tab, camera);
    await settle(tab, name);
    const ours = await tab.value('test.coverage()');
    await shoot(tab, `${name}-${k}`);
    execFileSync(meshlode, ['render', build(name).path, '-o', join(work, 'render.png'), '--quiet', '--size', `${WIDTH}x${HEIGHT}`,
      `--camera=${[...camera.eye, ...camera.target, 45, camera.near].join()}`]);
    writeFileSync(join(screenshots, `webgpu-${name}-${k}-render.png`), readFileSync(join(work, 'render.png')));
    const theirs = await tab.value(`test.coverageOf('/assets/render.png')`);
    const off = [...ours].filter((one, i) => one !== theirs[i]).length / ours.length;
    const inside = [...ours].filter((one) => one === '1').length / ours.length;
    expect(off <= most && inside > 0.05, `${name}, camera ${k}: ${percent(off)} of pixels are covered by one alone, ${percent(inside)} are covered`);
  }
  await isQuiet(tab, name);
  await tab.close();
}

async function lookAtHostile(browser, server) {
  const tab = await open(browser, server, null);
  const bytes = readFileSync(build('terrain').path);
  const { pages } = build('terrain');
  const put = (name, change) => {
    const copy = Buffer.from(bytes);
    writeFileSync(join(work, name), change(copy) ?? copy);
    return tab.value(`test.open('/assets/${name}')`);
  };
  const refused = async (what, opened, place) => expect(place.test(opened.place ?? opened), `${what}: ${opened.message ?? opened}`);
  await refused('a device that is none', await tab.value('test.openWithout()'), /^device$/);
  await refused('noise', await put('noise.lode', (copy) => void copy.fill(0x5a)), /^head$/);
  await refused('a cut file', await put('cut.lode', (copy) => copy.subarray(0, 300)), /^head$/);
  await refused('a byte of the head', await put('head.lode', (copy) => void (copy[700] ^= 16)), /^head$/);
  await refused('no file', await tab.value(`test.open('/assets/missing.lode')`), /^bytes 0 to/);
  await refused('a shader that is none', await tab.value(`test.open('/assets/terrain.lode', { shade: 'fn shade(' })`), /^shader$/);
  await refused('a pool that is no number', await tab.value(`test.open('/assets/terrain.lode', { poolBytes: NaN })`), /^options$/);
  expect((await tab.value(`test.open('/assets/terrain.lode', { poolBytes: 1e15 })`)) === 'ok', 'a pool beyond the device: opens');
  await tab.value('test.setCamera({ eye: [NaN, 0, 0], target: [0, 0, 0], near: 1 })');
  await tab.until(`(test.settle(0.1), test.errors.length > 0)`, 10); // nothing was selected yet
  await refused('a camera that is none', (await tab.value('test.errors'))[0] ?? 'nothing', /^camera$/);
  await refused('a camera without a place', await tab.value(`(() => { try { test.lode.select(null, { view: { isOrthographic: true, orthoHeight: 1,
    nearDistance: 1, heightPx: 480 }, viewProjection: new Array(16).fill(0) }); return 'ok'; } catch ({ place, message }) { return { place, message }; } })()`), /^camera$/);
  await refused('no format', await tab.value(`test.open('/assets/terrain.lode', { format: undefined })`), /^options$/);
  // A device with room for less than the tables.
  await tab.value(`(test.device = new Proxy({}, { get: (_, name) => name === 'limits' ? { maxStorageBufferBindingSize: 4096, maxBufferSize: 4096 } :
    typeof real[name] === 'function' ? real[name].bind(real) : real[name] }), 0)`.replaceAll('real', 'test.realDevice'));
  await refused('a small device', await tab.value(`test.open('/assets/terrain.lode')`), /^scene$/);
  expect(await tab.value(`test.realDevice.popErrorScope().then(() => false, () => true)`), 'a small device: no error scope is left');
  await tab.value('(test.device = undefined, 0)');

  // A page whose bytes are wrong: coarser geometry, the native cut without it, and the place in an event.
  const page = pages.length - 2;
  const opened = await put('page.lode', (copy) => void (copy[pages[page].offset + 40] ^= 4));
  expect(opened === 'ok', `a wrong page: opens`);
  await tab.value('(test.lode.pixelError = 0, 0)');
  await look(tab, frame('terrain', [0.4, 0.3, 1], 0.5));
  await settle(tab, 'a wrong page');
  const errors = await tab.value('test.errors');
  expect(errors.length > 0 && errors.every(({ place, isFatal }) => /^page \d+$/.test(place) && !isFatal) && errors.some(({ place }) => place === `page ${page}`),
    `a wrong page: ${errors.map(({ message }) => message).join('; ')}`);
  const covered = [...(await tab.value('test.coverage()'))].filter((one) => one === '1').length;
  expect(covered > 0.05 * WIDTH * HEIGHT, `a wrong page: ${percent(covered / WIDTH / HEIGHT)} are covered`);

  // Any byte: an error, or a picture; never a fault of the device.
  const ends = { refused: 0, event: 0, picture: 0, hang: 0 };
  let state = 7;
  const random = (n) => (state = (Math.imul(state, 1103515245) + 12345) >>> 0) % n;
  for (let k = 0; k < 24; ++k) {
    const end = await put('any.lode', (copy) => void (copy[k % 3 === 0 ? random(4096) : random(copy.length)] ^= 1 << random(8)));
    if (end !== 'ok') ++ends.refused;
    else {
      await look(tab, frame('terrain', [0.4, 0.3, 1], 0.5));
      if (!(await tab.value('test.settle(30)'))) ++ends.hang;
      await tab.value('test.draw()');
      ++ends[(await tab.value('test.errors.length')) > 0 ? 'event' : 'picture'];
    }
  }
  expect(ends.hang === 0 && ends.refused > 0 && ends.event + ends.picture > 0, `bytes that are wrong anywhere: ${JSON.stringify(ends)}`);
  const lost = await tab.value('test.lost');
  expect(lost.length === 0, `hostile bytes: the device says nothing ${lost.join('; ')}`);
  await tab.close();
}

mkdirSync(screenshots, { recursive: true });
const tarball = execFileSync('npm', ['pack', npmFolder, '--silent'], { cwd: work, encoding: 'utf8' }).trim().split('\n').pop();
execFileSync('tar', ['-xzf', tarball], { cwd: work });
const { loadRuntime } = await import(pathToFileURL(join(work, 'package/index.js')));
const view = await import(pathToFileURL(join(work, 'package/webgpu/view.js')));
const runtime = await loadRuntime();
const server = await serve({ '/': here, '/meshlode/': join(work, 'package'), '/assets/': work });
// A CPU's device: wherever Chromium runs.
const browser = await Browser.start(['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader']);
let isThere = true;
try {
  const tab = await open(browser, server, null);
  isThere = await tab.value('test.hasDevice');
  if (isThere) {
    writeFileSync(join(work, 'sheet.gltf'), colouredSheet());
    build('sheet', join(work, 'sheet.gltf'));
    await compareDecoded(tab, ['rock', 'city', 'crystal', 'foliage', 'terrain', 'sheet']);
    await tab.close();
    writeFileSync(join(work, 'herd.glb'), herd(['rock', 'crystal', 'terrain'].map((name) => join(data, `${name}.glb`)), 24));
    build('herd', join(work, 'herd.glb'));
    for (const name of ['rock', 'city', 'terrain', 'sheet', 'herd']) await compareCuts(browser, server, name);
    await compareCuts(browser, server, 'herd', { poolBytes: 600e3 });
    build('mosaic', join(work, 'herd.glb'), ['--page-size', '16']);
    await compareManyCuts(browser, server, 'mosaic', 80);
    for (const withhold of [0.1, 0.3, 0.5]) await compareManyCuts(browser, server, 'mosaic', 24, { withhold });
    const dragon = join(process.env.MESHLODE_MODELS ?? '', 'dragon.glb');
    if (process.env.MESHLODE_MODELS && existsSync(dragon)) {
      build('dragon', dragon);
      await compareCuts(browser, server, 'dragon', { poolBytes: 2e6 });
    } else {
      console.log('  no dragon below MESHLODE_MODELS');
    }
    for (const name of ['city', 'herd']) await compareCulled(browser, server, name, view);
    for (const name of ['rock', 'city', 'crystal', 'sheet']) await compareCoverage(browser, server, name, 0.005);
    await lookAtHostile(browser, server);
  }
} finally {
  await browser.end();
  await server.close();
  rmSync(work, { recursive: true });
}
if (!isThere) skip('this Chromium has no WebGPU on a CPU', 'MESHLODE_REQUIRE_BROWSER');
console.log(failures === 0 ? `all holds; screenshots in ${screenshots}` : `${failures} FAILED`);
process.exit(failures === 0 ? 0 : 1);
