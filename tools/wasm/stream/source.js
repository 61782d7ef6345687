// SPDX-License-Identifier: MIT
// Ranges of a file, over HTTP or of a Blob. Errors name the range.

/** An error with its place: a range of a file, or what was read from it. */
export class LodeError extends Error {
  constructor(place, reason) {
    super(`${place}: ${reason}`);
    Object.assign(this, { name: 'LodeError', place, reason });
  }
}

const ATTEMPTS = 3; // a dropped connection, a server that restarts; more attempts delay the error
const WAIT_MS = 400; // before the second attempt, four times as long before the third: two seconds in all
const END_MS = 100; // for the end of a body whose bytes are all there: it comes with them, or never; a cache wants it
const STEP_BYTES = 65536; // due within each time limit: 2 kB/s at 30 s, below which a picture never comes
const MOST_BYTES = 2 ** 31; // of a range, or of a file without ranges: a tab has no memory for more beside what it draws

export class RangeSource {
  bytesRead = 0;
  requests = 0;
  fileBytes = null; // null before the first read, and where another origin hides Content-Range
  #file;
  #options;
  #whole = null;
  #reading = null; // the promise of #whole
  #first = new Uint8Array(0); // bytes of the first read: part of the head, and of pages behind it in a small file

  /** `file`: an address or a Blob. Options: headers, credentials, timeoutMs. */
  constructor(file, options) {
    this.#file = file;
    this.#options = options;
    if (file instanceof Blob) [this.#whole, this.fileBytes] = [file, file.size];
  }

  /** The bytes [offset, offset + count). `isFirst`: fewer, where the file is shorter. */
  async read(offset, count, isFirst = false) {
    if (offset < this.#first.length && !isFirst) {
      const have = this.#first.subarray(offset, offset + count);
      if (have.length === count) return have;
      const rest = await this.read(offset + have.length, count - have.length);
      return new Uint8Array(await new Blob([have, rest]).arrayBuffer());
    }
    const place = `bytes ${offset} to ${offset + count - 1}`;
    if (count > MOST_BYTES) throw new LodeError(place, `more than ${MOST_BYTES} bytes`);
    for (let attempt = 1; ; ++attempt) {
      try {
        const bytes = await this.#readOnce(offset, count, isFirst, place);
        if (isFirst) this.#first = bytes;
        return bytes;
      } catch (error) {
        if (error.isFinal || attempt === ATTEMPTS) throw error instanceof LodeError ? error : new LodeError(place, error.message);
        await new Promise((done) => setTimeout(done, WAIT_MS * 4 ** (attempt - 1)));
      }
    }
  }

  async #readOnce(offset, count, isFirst, place) {
    const fail = (message, isFinal = false) => {
      throw Object.assign(new LodeError(place, message), { isFinal });
    };
    await this.#reading;
    if (this.#whole) {
      const end = Math.min(offset + count, this.fileBytes);
      if (!isFirst && end < offset + count) fail(`the file has ${this.fileBytes} bytes`, true);
      if (!(this.#whole instanceof Blob)) return this.#whole.subarray(offset, end);
      this.bytesRead += end - offset;
      return new Uint8Array(await this.#whole.slice(offset, end).arrayBuffer());
    }
    const abort = new AbortController();
    const { timeoutMs: limit, headers, credentials } = this.#options;
    let timer = 0;
    const arm = () => {
      clearTimeout(timer);
      const end = () => abort.abort(new Error(`too slow: less than ${STEP_BYTES} bytes within ${limit} ms`));
      if (limit < 2 ** 31) timer = setTimeout(end, limit); // longer ones end at once
    };
    arm();
    try {
      ++this.requests;
      const asked = { ...headers, Range: `bytes=${offset}-${offset + count - 1}` };
      const response = await fetch(this.#file, { headers: asked, credentials, signal: abort.signal });
      const { status } = response;
      // Another attempt helps with time-outs, limits of requests and faults of the server.
      if (status !== 200 && status !== 206) fail(`the server answers ${status}`, status < 500 && status !== 408 && status !== 429);
      if (status === 200) {
        if (this.#reading || this.#whole) clearTimeout(timer); // another request reads the file
        else this.#reading = this.#readWhole(response, arm, fail).finally(() => (this.#reading = null));
        await this.#reading;
        return this.#readOnce(offset, count, isFirst, place);
      }
      const said = this.#checkRange(response, offset, count, isFirst, fail);
      const due = said ?? Math.min(count, (this.fileBytes ?? Infinity) - offset);
      const bytes = await this.#body(response, due, said, arm, fail);
      if (bytes.length < due && !(isFirst && this.fileBytes === null)) fail(`only ${bytes.length} bytes came`);
      return bytes;
    } catch (error) {
      throw abort.signal.aborted && abort.signal.reason instanceof Error ? abort.signal.reason : error;
    } finally {
      clearTimeout(timer);
      abort.abort(); // ends a body that is too long
    }
  }
  /** The bytes that Content-Range says, where this origin may see it. */
  #checkRange(response, offset, count, isFirst, fail) {
    const said = response.headers.get('Content-Range');
    if (said === null) return undefined;
    const [, first, last, total] = (/^bytes (\d+)-(\d+)\/(\d+|\*)$/.exec(said) ?? []).map(Number);
    const end = Number.isFinite(total) ? Math.min(offset + count, total) : offset + count;
    if (first !== offset || last + 1 !== end || (end < offset + count && !isFirst)) fail(`the server sends ${said}`, true);
    if (Number.isFinite(total)) this.#setSize(total, fail);
    return end - offset;
  }
  async #readWhole(response, arm, fail) {
    const whole = await this.#body(response, Math.min(MOST_BYTES, this.fileBytes ?? Infinity), undefined, arm, fail);
    this.#setSize(whole.length, fail);
    this.#whole = whole;
  }
  /** A body of at most `limit` bytes, and of `due` where they are known: some servers leave the connection open behind them. */
  async #body(response, limit, due, arm, fail) {
    // Content-Length is of what is encoded, and another origin may hide that it is.
    const isPlain = response.type === 'basic' && !response.headers.has('Content-Encoding');
    const said = Number((isPlain && response.headers.get('Content-Length')) || NaN);
    const check = (bytes) => bytes > limit && fail('more bytes came than were asked for', true);
    check(said);
    const parts = [];
    let [size, armed] = [0, 0];
    const reader = response.body.getReader();
    for (;;) {
      const next = reader.read();
      const end = () => new Promise((resolve) => setTimeout(resolve, END_MS, { done: true }));
      const { value, done } = await (size === due ? Promise.race([next, end()]) : next);
      if (done) break;
      parts.push(value);
      size += value.length;
      this.bytesRead += value.length;
      check(size);
      if (size - armed < STEP_BYTES) continue;
      armed = size;
      arm();
    }
    if (size < said) fail(`only ${size} bytes came`);
    return new Uint8Array(await new Blob(parts).arrayBuffer());
  }
  #setSize(total, fail) {
    if (this.fileBytes !== null && total !== this.fileBytes) fail(`the file had ${this.fileBytes} bytes and has ${total}`, true);
    this.fileBytes = total;
  }
}
