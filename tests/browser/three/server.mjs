// SPDX-License-Identifier: GPL-3.0-or-later
// A file server for tests: ranges as HTTP has them, a log of what was asked for, and faults on request.
import { createServer } from 'node:http';
import { readFileSync, statSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';

const TYPES = { '.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.json': 'application/json' };

/**
 * Serves folders: {'/path/': folder}. `log`: {path, first, last, sent} of each range. `fault`, where set, is called with
 * {path, first, last, total, bytes, count} of a range before it is answered; what it returns replaces what is answered: {status, headers,
 * body, hang, afterMs}.
 */
export async function serve(folders) {
  const state = { log: [], fault: null };
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    const prefix = Object.keys(folders).filter((one) => path.startsWith(one)).sort((a, b) => b.length - a.length)[0];
    let file;
    try {
      file = readFileSync(join(folders[prefix], path.slice(prefix.length)));
    } catch {
      response.writeHead(404).end('not here');
      return;
    }
    const headers = { 'Content-Type': TYPES[extname(path)] ?? 'application/octet-stream', 'Accept-Ranges': 'bytes', 'Cache-Control': 'no-store',
      // A page that may measure its memory.
      'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp',
      // Pages of another origin may read the bytes, and not see Content-Range.
      'Access-Control-Allow-Origin': '*' };
    const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    let answer = { status: 200, headers, body: file };
    if (range) {
      const first = Number(range[1]);
      const last = Math.min(Number(range[2]), file.length - 1);
      if (first > last) answer = { status: 416, headers: { 'Content-Range': `bytes */${file.length}` }, body: '' };
      else answer = { status: 206, headers: { ...headers, 'Content-Range': `bytes ${first}-${last}/${file.length}` }, body: file.subarray(first, last + 1) };
      const entry = { path, first, last, sent: answer.body.length };
      state.log.push(entry);
      const change = state.fault?.({ path, first, last, total: file.length, bytes: answer.body, file, count: state.log.length, headers: answer.headers });
      if (change?.hang) return;
      if (change?.afterMs) await new Promise((done) => setTimeout(done, change.afterMs));
      if (change) answer = { ...answer, ...change };
      entry.sent = answer.body.length;
    }
    const { status, body } = answer;
    response.writeHead(status, { 'Content-Length': body.length, ...answer.headers }).end(body);
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const close = () => {
    server.closeAllConnections();
    return new Promise((done) => server.close(done));
  };
  return Object.assign(state, { origin: `http://127.0.0.1:${server.address().port}`, close });
}
