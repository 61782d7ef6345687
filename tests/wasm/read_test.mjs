// SPDX-License-Identifier: GPL-3.0-or-later
// read_test.mjs PACKAGE WRITE_DECODED WRITE_BROKEN MESHLODE STORE_BY DATA: the module, through the package's own index.js, makes of assets what the
// native runtime makes of them, byte for byte: decoded integers and floats, cuts, and refusals of broken files.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { checkHead } from './head_checks.mjs';

const [, , folder, writeDecoded, writeBroken, meshlode, storeBy, data] = process.argv;
const { loadRuntime, MeshlodeError } = await import(pathToFileURL(join(folder, 'index.js')));
const runtime = await loadRuntime();
const work = mkdtempSync(join(tmpdir(), 'meshlode-wasm-'));
let failures = 0;

function expect(holds, what) {
  console.log(`${holds ? 'holds' : 'FAILED'}: ${what}`);
  if (!holds) ++failures;
}

function native(path) {
  const out = join(work, 'native');
  execFileSync(writeDecoded, [path, out]);
  return readFileSync(out);
}

const raw = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
const words = (...values) => raw(Uint32Array.from(values));

function putCuts(asset, promise, parts) {
  for (let step = 0; step < 12; ++step) {
    const distance = 2 ** step / 8;
    asset.meshes.forEach((mesh, m) => {
      const cut = asset.selectUniform(m, (mesh.diagonal * distance) / 256, promise);
      parts.push(words(cut.clusters.length), raw(cut.clusters), raw(Float64Array.of(cut.storedError)));
    });
    const { instances, clusters } = asset.selectView(
      {
        eye: [0.25 * distance, 0.5 * distance, distance],
        isOrthographic: step % 3 === 2,
        fovyRadians: 0.75,
        orthoHeight: distance,
        nearDistance: 0.0625,
        heightPx: 720,
        promise,
      },
      1.5,
    );
    parts.push(words(clusters.length));
    clusters.forEach((cluster, i) => parts.push(words(instances[i], cluster)));
  }
}

/** The stream of write_decoded.c. */
function decoded(path) {
  const parts = [];
  let asset;
  try {
    asset = runtime.open(readFileSync(path));
    asset.pages.forEach((page, p) => {
      asset.loadPage(p);
      for (let c = page.firstCluster; c < page.firstCluster + page.clusterCount; ++c) {
        const ints = asset.decodeIntegers(c);
        parts.push(words(ints.vertexCount, ints.triangleCount, ints.channelCount));
        parts.push(raw(ints.values), raw(ints.triangles), raw(ints.triangleMaterials));
        const floats = asset.decodeFloats(c);
        parts.push(raw(floats.positions));
        if (floats.normals) parts.push(raw(floats.normals));
        parts.push(...floats.uvs.map(raw));
        if (floats.colors) parts.push(raw(floats.colors));
      }
      asset.dropPage(p);
    });
  } catch (error) {
    if (!(error instanceof MeshlodeError)) throw error;
    asset?.close();
    return { bytes: Buffer.concat(parts), refusal: error };
  }
  for (const promise of ['position', 'texels', 'appearance']) {
    try {
      asset.checkPromise(promise);
    } catch (error) {
      if (!(error instanceof MeshlodeError) || error.status !== 'unsupported') throw error;
      continue;
    }
    putCuts(asset, promise, parts);
  }
  asset.close();
  return { bytes: Buffer.concat(parts), refusal: null };
}

/** How many of an asset's texts are no JSON, which is a refusal like any other. */
function badTexts(path) {
  let asset;
  let count = 0;
  try {
    asset = runtime.open(readFileSync(path));
  } catch {
    return 0; // decoded() has looked at that
  }
  for (const name of ['meta', 'scene']) {
    try {
      void asset[name];
    } catch (error) {
      if (!(error instanceof MeshlodeError) || error.status !== 'invalid') throw error;
      ++count;
    }
  }
  asset.close();
  return count;
}

/** A promise is an argument: cuts are by its tables, it is refused where there is none, and other selections do not notice. */
function checkPromises(promising, plain) {
  const asset = runtime.open(readFileSync(promising));
  const error = asset.meshes[0].diagonal / 100;
  const trianglesOf = (clusters) => Array.from(clusters).reduce((sum, c) => sum + asset.clusters[c].triangleCount, 0);
  const counts = ['position', 'texels', 'appearance'].map((promise) => {
    const cut = asset.selectUniform(0, error, promise);
    const { meshes, groups } = asset.tablesOf(promise);
    const worst = Math.max(...Array.from(cut.clusters, (c) => asset.clusters[c].ownGroup)
      .map((group) => groups[group]?.error ?? meshes[0].level0Deviation));
    expect(worst <= error && cut.storedError <= error, `${promise}: the tables are those of the cut`);
    return trianglesOf(cut.clusters);
  });
  expect(counts[0] <= counts[1] && counts[1] <= counts[2] && counts[0] < counts[2], `more is promised with more triangles: ${counts.join(' ')}`);
  expect(trianglesOf(asset.selectUniform(0, error).clusters) === counts[0], 'a cut without a promise is by positions');
  const refusalOf = (call) => {
    try {
      call();
    } catch (caught) {
      return caught;
    }
    return null;
  };
  const view = { eye: [0, 0, 3], fovyRadians: 0.8, nearDistance: 0.01, heightPx: 720 };
  const none = refusalOf(() => asset.selectView({ ...view, promise: 'colour' }, 1));
  expect(none?.status === 'usage', `a promise that is none: ${none?.message}`);
  asset.close();
  const other = runtime.open(readFileSync(plain));
  for (const call of [() => other.checkPromise('texels'), () => other.selectUniform(0, 0, 'texels'), () => other.streamingOrder('texels'),
    () => other.selectView({ ...view, promise: 'texels' }, 1)]) {
    const refusal = refusalOf(call);
    expect(refusal?.status === 'unsupported', `a promise that was not built: ${refusal?.message}`);
  }
  other.close();
}

const hash = (bytes) => createHash('sha256').update(bytes).digest('hex').slice(0, 16);

/** Whether what the module made is what native made; a refusal has native's text, behind what was read before it. */
function isSame(here, there) {
  if (here.refusal === null) return here.bytes.equals(there);
  if (there.length < 248) return false;
  const text = there.subarray(there.length - 244);
  const said = text.subarray(0, text.indexOf(0)).toString();
  return here.bytes.equals(there.subarray(0, there.length - 248)) && said === here.refusal.message;
}

function compare(path, name) {
  const here = decoded(path);
  const there = native(path);
  const refusal = here.refusal ? `, refused: ${here.refusal.message}` : '';
  expect(isSame(here, there), `${name}: ${there.length} bytes, ${hash(there)}${refusal}`);
}

try {
  expect(runtime.formatVersion > 0, 'the version of the format');
  for (const scene of ['crystal', 'rock', 'city', 'foliage']) {
    for (const codec of ['none', 'strips', 'zstd']) {
      const path = join(work, `${scene}.${codec}.lode`);
      if (codec === 'zstd') {
        execFileSync(storeBy, [codec, join(work, `${scene}.none.lode`), path]);
      } else {
        execFileSync(meshlode, ['build', '--quiet', join(data, `${scene}.glb`), '-o', path, '--codec', codec]);
      }
      if (codec !== 'zstd') {
        compare(path, `${scene} stored as ${codec}`);
      } else if (scene === 'rock') {
        const refusal = decoded(path).refusal;
        expect(refusal?.status === 'unsupported', `pages of another codec are refused: ${refusal?.message}`);
      }
    }
  }
  const promising = join(work, 'promising.lode');
  execFileSync(meshlode, ['build', '--quiet', join(data, 'terrain.glb'), '-o', promising, '--promise', 'appearance']);
  compare(promising, 'terrain by each promise');
  checkPromises(promising, join(work, 'rock.none.lode'));
  // Broken files: cut short, and single bytes changed all over the file, header, tables and pages.
  const whole = readFileSync(join(work, 'crystal.strips.lode'));
  const broken = join(work, 'broken.lode');
  for (let k = 0; k < 40; ++k) {
    const bytes = Buffer.from(k < 8 ? whole.subarray(0, Math.floor((whole.length * k) / 8)) : whole);
    if (k >= 8) bytes[Math.floor((whole.length * (k - 8)) / 32) + 17] ^= 0x41;
    writeFileSync(broken, bytes);
    compare(broken, `broken ${k}`);
  }
  // Many more with their checksums written anew, in either codec that is read: each is refused as native refuses it or read to its
  // end, never a trap or a hang, and the module reads what is whole afterwards.
  for (const name of ['crystal.none', 'foliage.strips', 'city.strips']) {
    const count = 150;
    const resealed = join(work, `${name}.broken`);
    mkdirSync(resealed);
    execFileSync(writeBroken, [join(work, `${name}.lode`), resealed, String(count)]);
    let refused = 0;
    let different = 0;
    let noJson = 0;
    for (let k = 0; k < count; ++k) {
      const path = join(resealed, String(k));
      const here = decoded(path);
      refused += here.refusal ? 1 : 0;
      noJson += badTexts(path);
      if (!isSame(here, native(path))) {
        ++different;
        console.log(`  ${name} ${k}: ${here.refusal?.message}`);
      }
    }
    expect(different === 0, `${name}: ${count} broken ones are what they are natively, ${refused} of them refused`);
    expect(refused > count / 4 && refused < count, `${name}: some are refused and some are not`);
    expect(noJson > 0, `${name}: ${noJson} texts are no JSON, and refused`);
    rmSync(resealed, { recursive: true });
    compare(join(work, `${name}.lode`), `${name} after them`);
  }
  const asset = runtime.open(whole);
  const refused = (call) => {
    try {
      call();
      return 'nothing';
    } catch (error) {
      return error.status;
    }
  };
  for (const name of ['rock.strips', 'city.none', 'foliage.strips']) {
    checkHead({ runtime, file: readFileSync(join(work, `${name}.lode`)), name, expect, refused });
  }
  expect(refused(() => asset.decodeFloats(1e6)) === 'usage', 'a cluster that is not there');
  expect(refused(() => asset.loadPage(1e6)) === 'usage', 'a page that is not there');
  expect(refused(() => asset.selectUniform(0, NaN)) === 'usage', 'an error that is no number');
  expect(refused(() => asset.selectView({ fovyRadians: 9, nearDistance: 1, heightPx: 1 }, 1)) === 'usage', 'a view that is none');
  expect(asset.streamingOrder().length === asset.pages.length, 'an order of all pages');
  const huge = Object.defineProperty(new Uint8Array(1), 'byteLength', { value: 2 ** 32 + 16 });
  expect(refused(() => runtime.open(huge)) === 'out_of_memory', 'more bytes than a module can have');
  expect(asset.meta.settings !== undefined, 'META is JSON');
  expect(asset.meshes[0].name.length > 0, 'a mesh has its name');
  asset.close();
} finally {
  rmSync(work, { recursive: true });
}
console.log(failures === 0 ? 'all holds' : `${failures} FAILED`);
process.exit(failures === 0 ? 0 : 1);
