// SPDX-License-Identifier: GPL-3.0-or-later
// An asset opened by its head, against the same one opened whole: tables, cuts, pages and images from the caller's bytes, and
// refusals of what is not theirs.

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** The head of a file, read as a caller reads it; with the sizes that were asked for. */
function readHead(runtime, file) {
  const sizes = [64];
  for (;;) {
    const { bytes, isKnown } = runtime.headBytes(file.subarray(0, sizes.at(-1)), file.length);
    if (isKnown && bytes <= sizes.at(-1)) return sizes;
    sizes.push(bytes);
  }
}

export function checkHead({ runtime, file, name, expect, refused }) {
  const whole = runtime.open(file);
  const sizes = readHead(runtime, file);
  const head = runtime.openHead(file.subarray(0, sizes.at(-1)), file.length);
  const tables = ['meshes', 'materials', 'instances', 'groups', 'clusters', 'pages', 'blobs', 'meta', 'scene'];
  expect(sizes.length <= 3 && sizes.at(-1) < file.length && tables.every((one) => isSame(head[one], whole[one])),
    `${name}: a head of ${sizes.join(', ')} of ${file.length} bytes has the tables of the whole`);
  expect(isSame(head.largestCluster(), { vertices: Math.max(...whole.clusters.map((c) => c.vertexCount)),
    triangles: Math.max(...whole.clusters.map((c) => c.triangleCount)) }), `${name}: the largest cluster`);

  const { meshes, instances, pages } = whole;
  const { diagonal } = meshes[0];
  const target = [3, 7, 11].map((at) => instances[0].transform[at]);
  const selector = head.createSelector();
  const resident = new Uint32Array(Math.ceil(pages.length / 32));
  let equal = 0;
  let steps = 0;
  for (let k = 0; k < 6; ++k) {
    const eye = [target[0] + diagonal * Math.sin(k), target[1], target[2] + diagonal * Math.cos(k)];
    const view = { eye, fovyRadians: 0.7, nearDistance: 0.001 * diagonal, heightPx: 800, isOrthographic: k === 5, orthoHeight: diagonal };
    const frustum = head.makeFrustum(view, target, [0, 1, 0], 1.5);
    for (;;) {
      const drawn = selector.select(view, 1, resident, frustum);
      const { pages: wanted, priorities } = selector.requests;
      const all = selector.pagePriorities;
      if (!wanted.every((page, i) => all[page] === priorities[i] && (i === 0 || priorities[i] <= priorities[i - 1]))) break;
      if (wanted.length === 0) {
        equal += isSame(drawn, whole.selectView(view, 1, frustum)) && drawn.clusters.length <= whole.selectView(view, 1).clusters.length;
        break;
      }
      const { offset, storedBytes } = pages[wanted[0]];
      head.unpackPage(wanted[0], file.subarray(offset, offset + storedBytes));
      resident[wanted[0] >> 5] |= 1 << (wanted[0] & 31);
      ++steps;
    }
  }
  expect(equal === 6 && steps > 0, `${name}: ${equal} of 6 views are the whole's cuts after ${steps} pages`);

  // What has no priority of infinity with nothing resident is not read first, and all else is.
  selector.select({ eye: [0, 0, 0], fovyRadians: 0.7, nearDistance: 0.001 * diagonal, heightPx: 800 }, 1, new Uint32Array(resident.length));
  const nothing = selector.pagePriorities;
  const first = [...pages.keys()].filter((page) => nothing[page] === 3.4028234663852886e38);
  const isIn = (page) => (range) => range.offset <= pages[page].offset && pages[page].offset + pages[page].storedBytes <= range.offset + range.bytes;
  const ranges = head.firstRanges();
  const covered = [...pages.keys()].filter((page) => ranges.some(isIn(page)));
  const one = { offset: pages[first[0]].offset, bytes: pages[first.at(-1)].offset + pages[first.at(-1)].storedBytes - pages[first[0]].offset };
  expect(isSame(covered, first) && [file.length + 0.5, Infinity].every((gap) => isSame(head.firstRanges(gap), [one])) && isSame(head.firstRanges(-1), ranges), `${name}: ${ranges.length} ranges of ${first.length} first pages`);

  const loaded = pages.findIndex((_, page) => (resident[page >> 5] >>> (page & 31)) & 1);
  const cluster = pages[loaded].firstCluster;
  const floats = ({ positions, normals, uvs, triangles }) => [positions, normals, ...uvs, triangles].map((array) => array && [...array]);
  expect(isSame(floats(head.decodeFloats(cluster)), floats(whole.decodeFloats(cluster))), `${name}: a page of the caller's bytes`);
  head.dropPage(loaded);
  const stored = Buffer.from(file.subarray(pages[loaded].offset, pages[loaded].offset + pages[loaded].storedBytes));
  expect(refused(() => head.loadPage(loaded)) !== 'nothing', `${name}: a head loads no page`);
  expect(refused(() => head.unpackPage(loaded, stored.subarray(1))) === 'usage', `${name}: a page of too few bytes`);
  expect(refused(() => head.unpackPage(1e6, stored)) === 'usage', `${name}: bytes of no page`);
  stored[stored.length >> 1] ^= 4;
  expect(refused(() => head.unpackPage(loaded, stored)) === 'invalid', `${name}: a page of wrong bytes`);

  whole.blobs.forEach(({ offset, bytes, kind, sourceIndex }, blob) => {
    const own = Buffer.from(file.subarray(offset, offset + bytes));
    head.checkBlob(blob, own);
    const isImage = kind !== 1 || (head.blobOfImage(sourceIndex) === blob && head.imageOfTexture(0) < whole.scene.images.length);
    expect(own.equals(whole.blobBytes(blob)) && head.blobBytes(blob).length === 0 && isImage, `${name}: blob ${blob}, ${bytes} bytes`);
    own[bytes >> 1] ^= 1;
    expect(refused(() => head.checkBlob(blob, own)) === 'invalid', `${name}: blob ${blob} of wrong bytes`);
  });
  expect(refused(() => head.checkBlob(1e6, stored)) === 'usage' && whole.blobBytes(1e6).length === 0, `${name}: no such blob`);
  expect(refused(() => selector.select({ fovyRadians: 9, nearDistance: 1, heightPx: 1 }, 1, resident)) === 'usage', `${name}: no view`);
  expect(refused(() => head.makeFrustum({ eye: target, fovyRadians: 1, nearDistance: 1, heightPx: 1 }, target, [0, 1, 0], 1)) === 'usage',
    `${name}: no frustum`);
  const other = head.createSelector();
  selector.close();
  const view = { eye: target, fovyRadians: 0.7, nearDistance: 0.001 * diagonal, heightPx: 800 };
  const ask = (one) => [() => one.select(view, 1, resident), () => one.requests, () => one.pagePriorities].map(refused);
  expect(isSame(ask(selector), ['usage', 'usage', 'usage']), `${name}: a closed selector answers nothing`);
  expect(isSame(ask(other), ['nothing', 'nothing', 'nothing']), `${name}: another one answers`);
  head.close();
  expect(isSame(ask(other), ['usage', 'usage', 'usage']) && refused(() => head.createSelector()) === 'usage', `${name}: a closed asset's answers nothing`);
  whole.close();
  expect(refused(() => runtime.openHead(file.subarray(0, sizes.at(-1) - 8), file.length)) === 'invalid', `${name}: a head that is cut off`);
  expect(refused(() => runtime.openHead(file.subarray(0, sizes.at(-1)), file.length + 1)) === 'invalid', `${name}: a file of another size`);
}
