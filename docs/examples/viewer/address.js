// SPDX-License-Identifier: MIT
// The state of a viewer in the hash of its address, so that a view can be shared. Whatever stands there may be anybody's.

const WAIT_MS = 300; // browsers refuse more than about a hundred changes in ten seconds

export class Address {
  #values = new URLSearchParams(location.hash.slice(1));
  #timer = 0;

  constructor() {
    // Only what a reader types is an event: replaceState() is none.
    addEventListener('hashchange', () => location.reload());
  }
  text(name) {
    return this.#values.get(name);
  }
  /** A whole number within the limits, or null. */
  integer(name, low, high) {
    const [value] = this.numbers(name, 1, low, high) ?? [null];
    return Number.isInteger(value) ? value : null;
  }
  /** So many numbers with commas between, or null. */
  numbers(name, count, low, high) {
    const text = this.#values.get(name);
    if (!text) return null;
    const all = text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
    return all.length === count && all.every((value) => value >= low && value <= high) ? all : null;
  }
  /** null takes a name out. */
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      if (value === null) this.#values.delete(name);
      else this.#values.set(name, String(value));
    }
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.write(), WAIT_MS);
  }
  write() {
    clearTimeout(this.#timer);
    history.replaceState(null, '', `#${this.#values}`.replaceAll('%2C', ',').replaceAll('%2F', '/').replaceAll('%3A', ':'));
  }
}
