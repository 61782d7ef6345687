// SPDX-License-Identifier: GPL-3.0-or-later
// Servers that do not do what they should: each ends in an error with its place, or in coarser geometry that says so.

const isHead = ({ first }) => first < 65536;

/** What a server does to a range, and what the page must make of it: `place` of the refusal or of the event. */
const FAULTS = [
  { what: 'the file is not there', fault: () => ({ status: 404, body: '' }), opens: /^bytes 0 to 65535: the server answers 404$/ },
  { what: 'the server is broken', fault: () => ({ status: 500, body: '' }), opens: /answers 500/ },
  { what: 'the head is cut off', fault: ({ bytes }) => ({ body: bytes.subarray(0, bytes.length - 100) }), opens: /^bytes 0 to 65535: only 65436 bytes came$/ },
  { what: 'the head is too long', fault: ({ file }) => ({ body: file.subarray(0, 70000) }), opens: /more bytes came/ },
  { what: 'another range comes', fault: ({ total }) => ({ headers: { 'Content-Range': `bytes 16-65551/${total}` } }), opens: /sends bytes 16-65551/ },
  { what: 'a range without sense', fault: () => ({ headers: { 'Content-Range': 'bytes */7' } }), opens: /sends bytes/ },
  { what: 'the head is noise', fault: ({ bytes }) => ({ body: Buffer.from(bytes).fill(0x5a) }), opens: /^head: / },
  { what: 'one byte of the head is wrong', fault: ({ bytes }) => ({ body: flip(bytes, 700) }), opens: /^head: / },
  { what: 'nothing is answered', fault: () => ({ hang: true }), options: { timeoutMs: 700 }, opens: /too slow/ },
  { what: 'pages are not there', fault: (range) => (isHead(range) ? null : { status: 404, body: '' }), event: /^page \d+: bytes \d+ to \d+: the server answers 404$/ },
  { what: 'pages are cut off', fault: (range) => (isHead(range) ? null : { body: range.bytes.subarray(1) }), event: /^page \d+: bytes \d+ to \d+: only \d+ bytes came$/ },
  { what: 'pages do not come', fault: (range) => (isHead(range) ? null : { hang: true }), options: { timeoutMs: 700 }, event: /^page \d+: .*too slow/ },
  { what: 'the file gets another size', fault: (range) => (isHead(range) ? null : { headers: { 'Content-Range': `bytes ${range.first}-${range.last}/${range.total + 1}` } }),
    event: /the file had \d+ bytes and has \d+/ },
];
function flip(bytes, at) {
  const copy = Buffer.from(bytes);
  copy[at] ^= 0x10;
  return copy;
}

export async function lookAtServers({ browser, server, open, pages, expect }) {
  for (const { what, fault, options = {}, opens, event } of FAULTS) {
    const tab = await open(browser, server, null);
    server.fault = fault;
    const opened = await tab.value(`test.open('/assets/terrain.lode', ${JSON.stringify(options)})`);
    if (opens) {
      expect(opened !== 'ok' && opens.test(opened.message) && opened.message.startsWith(opened.place), `${what}: ${opened.message ?? opened}`);
    } else {
      await tab.value('test.frame()');
      const isSettled = await tab.value('test.settle(30)');
      const errors = await tab.value('test.errors');
      expect(opened === 'ok' && isSettled && errors.some(({ message }) => event.test(message)), `${what}: ${errors[0]?.message}`);
    }
    server.fault = null;
    await tab.close();
  }

  // Texts of an asset are JSON and otherwise what their writer liked.
  const strange = await open(browser, server, null);
  const scenes = [null, 7, { materials: 7 }, { materials: [null] }, { materials: [{ emissiveFactor: 5 }] }, { materials: [{ emissiveFactor: 'x' }] },
    { materials: [{ pbrMetallicRoughness: 3, normalTexture: [] }] }, { materials: [{ normalTexture: { index: 0 } }], textures: [{ source: -1 }] },
    { materials: [{ normalTexture: { index: 'length' } }], textures: [] }, { materials: [{ extensions: null }] }];
  const ends = [];
  for (const scene of scenes) ends.push(await strange.value(`Promise.race([test.openScene(${JSON.stringify(scene)}), new Promise((done) => setTimeout(done, 5000, 'a hang'))])`));
  expect(ends.every((end) => end === 'ok' || end === 'scene') && ends.includes('ok') && ends.includes('scene'), `strange scenes: ${ends.join(', ')}`);
  await strange.close();

  // A page that comes once out of two times is had; one whose bytes are wrong is drawn coarser, and again when it is mended.
  let isOdd = false;
  server.fault = (range) => (!isHead(range) && (isOdd = !isOdd) ? { status: 503, body: '' } : null);
  let tab = await open(browser, server, 'terrain');
  await tab.value('test.frame()');
  expect((await tab.value('test.settle()')) && (await tab.value('test.errors')).length === 0, 'a server that is busy at times: all is there');
  const all = await tab.value('test.lode.statistics');
  expect(all.missing === 0 && all.failed === 0 && all.residentPages > 1, `and complete with ${all.residentPages} pages`);
  await tab.close();

  const late = pages.at(-1).offset + 1000;
  server.fault = ({ first, last, bytes }) => (first <= late && late <= last ? { body: flip(bytes, late - first) } : null);
  tab = await open(browser, server, 'terrain');
  await tab.value('test.frame()');
  expect(await tab.value('test.settle()'), 'a corrupt page: settles');
  const errors = await tab.value('test.errors');
  const coarse = await tab.value('({ ...test.lode.statistics, triangles: test.renderer.info.render.triangles })');
  expect(errors.length > 0 && /^page \d+: page \d+|^page \d+: .*checksum/.test(errors[0].message), `a corrupt page: ${errors[0]?.message}`);
  expect(coarse.failed > 0 && coarse.triangles > 0 && coarse.drawnClusters < all.drawnClusters,
    `a corrupt page: ${coarse.drawnClusters} clusters are drawn and not ${all.drawnClusters}`);
  server.fault = null;
  await tab.value('test.lode.retry()');
  expect((await tab.until(`test.lode.statistics.drawnClusters === ${all.drawnClusters}`, 20)) && (await tab.value('test.lode.statistics.failed')) === 0,
    'a corrupt page: mended, it is drawn when asked for again');
  await tab.close();

  // Another origin that hides Content-Range: the size of the file is what its header says.
  const other = server.origin.replace('127.0.0.1', 'localhost');
  tab = await open(browser, server, null);
  expect((await tab.value(`test.open('${other}/assets/terrain.lode')`)) === 'ok', 'another origin: opens');
  await tab.value('test.frame()');
  expect((await tab.value('test.settle()')) && (await tab.value('test.lode.statistics.drawnClusters')) === all.drawnClusters &&
    (await tab.value('test.lode.statistics.fileBytes')) === all.fileBytes, 'another origin: the same is drawn');
  server.fault = ({ bytes }) => ({ body: bytes.subarray(0, bytes.length - 1) });
  const cut = await tab.value(`test.open('${other}/assets/terrain.lode')`);
  expect(cut.message?.startsWith('head: '), `another origin, a file that is cut off: ${cut.message ?? cut}`);
  server.fault = null;
  await tab.close();

  // No ranges: the whole file, once. Slow: later, and the same.
  server.fault = ({ file }) => ({ status: 200, headers: {}, body: file });
  const before = server.log.length;
  tab = await open(browser, server, 'terrain');
  await tab.value('test.frame()');
  expect((await tab.value('test.settle()')) && server.log.length === before + 1, 'no ranges: one whole fetch');
  expect((await tab.value('test.lode.statistics.drawnClusters')) === all.drawnClusters, 'no ranges: the same is drawn');
  await tab.close();
  server.fault = () => ({ afterMs: 150 });
  tab = await open(browser, server, 'terrain');
  await tab.value('test.frame()');
  expect((await tab.value('test.settle()')) && (await tab.value('test.lode.statistics.drawnClusters')) === all.drawnClusters, 'slow: the same is drawn');
  server.fault = null;
  await tab.close();
}
