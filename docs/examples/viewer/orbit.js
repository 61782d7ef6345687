// SPDX-License-Identifier: MIT
// A camera that goes round a box: pointer, wheel, two fingers and keys of a canvas. Nothing here draws.

export const FIELD_OF_VIEW = 0.7; // vertical, radians
const FRAME_SHARE = 0.92; // of the picture that Home fills
const DRAG = 4; // CSS pixels that a click may move

export class Orbit {
  /** `onMove()` after each change, `onClick(x, y)` in CSS pixels of the canvas. */
  constructor(canvas, { onMove, onClick }) {
    Object.assign(this, { canvas, onMove, onClick });
    this.pointers = new Map();
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('pointerdown', (event) => this.#press(event));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault()); // the right button moves
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  /** The box that Home shows: its middle, which the camera's places are relative to, and its half edges. */
  frame({ center, half }) {
    Object.assign(this, { center, half, radius: Math.hypot(...half) || 1 });
    this.reset();
  }
  reset() {
    this.yaw = 0.6;
    this.pitch = 0.35;
    this.target = [0, 0, 0];
    this.distance = 1;
    this.distance = Math.max(this.#fittingDistance(), this.radius / 100);
  }

  /** Six numbers that restore() takes: angles, and lengths in radii of the box. */
  state() {
    return [this.yaw, this.pitch, this.distance / this.radius, ...this.target.map((value) => value / this.radius)];
  }
  restore([yaw, pitch, distance, ...target]) {
    Object.assign(this, { yaw, pitch, distance: distance * this.radius, target: target.map((value) => value * this.radius) });
    this.#limit();
  }

  /** Relative to the middle of the box. */
  eye() {
    const flat = Math.cos(this.pitch) * this.distance;
    const away = [Math.sin(this.yaw) * flat, Math.sin(this.pitch) * this.distance, Math.cos(this.yaw) * flat];
    return away.map((value, k) => value + this.target[k]);
  }
  /** Right, up and backwards. */
  axes() {
    const z = this.eye().map((value, k) => (value - this.target[k]) / this.distance);
    const flat = Math.hypot(z[0], z[2]);
    const x = [z[2] / flat, 0, -z[0] / flat];
    const y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
    return { x, y, z };
  }
  near() {
    return Math.max(this.#reach() - 1.5 * this.radius, this.distance / 500);
  }
  far() {
    return this.#reach() + 1.5 * this.radius;
  }
  #reach() {
    return Math.hypot(...this.eye());
  }

  /** From where all corners of the box are in the picture, with a rim. */
  #fittingDistance() {
    const { x, y, z } = this.axes();
    const reach = FRAME_SHARE * Math.tan(FIELD_OF_VIEW / 2);
    const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight) || 1;
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const p = this.half.map((value, k) => ((corner >> k) & 1 ? value : -value));
      const along = (axis) => axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
      distance = Math.max(distance, along(z) + Math.max(Math.abs(along(x)) / aspect, Math.abs(along(y))) / reach);
    }
    return distance;
  }

  #limit() {
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch));
    this.distance = Math.max(this.radius / 1000, Math.min(this.radius * 50, this.distance));
    this.target = this.target.map((value) => Math.max(-2 * this.radius, Math.min(2 * this.radius, value)));
  }
  #moved() {
    this.#limit();
    this.onMove();
  }
  /** By CSS pixels, so that what is at the target stays under the pointer. */
  #pan(right, down) {
    const { x, y } = this.axes();
    const scale = (2 * this.distance * Math.tan(FIELD_OF_VIEW / 2)) / Math.max(1, this.canvas.clientHeight);
    this.target = this.target.map((value, k) => value + scale * (down * y[k] - right * x[k]));
  }

  #wheel(event) {
    event.preventDefault();
    this.distance *= Math.exp(event.deltaY * 0.001);
    this.#moved();
  }

  #press(event) {
    const { pointers } = this;
    pointers.set(event.pointerId, event);
    this.canvas.setPointerCapture(event.pointerId);
    if (pointers.size > 1) return;
    let hasTurned = false;
    let travelled = 0;
    const move = (e) => {
      const last = pointers.get(e.pointerId);
      if (!last) return;
      const [right, down] = [e.clientX - last.clientX, e.clientY - last.clientY];
      travelled += Math.hypot(right, down);
      hasTurned ||= travelled > DRAG;
      const other = [...pointers].find(([id]) => id !== e.pointerId)?.[1];
      pointers.set(e.pointerId, e);
      if (!hasTurned) return;
      if (other) {
        const gap = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
        this.distance *= Math.max(1, gap(last)) / Math.max(1, gap(e));
        this.#pan(right / 2, down / 2);
      } else if (event.button === 2 || e.shiftKey) {
        this.#pan(right, down);
      } else {
        this.yaw -= right * 0.008;
        this.pitch += down * 0.008;
      }
      this.#moved();
    };
    const end = (e) => {
      pointers.delete(e.pointerId);
      if (pointers.size > 0) return;
      for (const [name, listener] of [['pointermove', move], ['pointerup', end], ['pointercancel', end]]) {
        this.canvas.removeEventListener(name, listener);
      }
      if (hasTurned || event.button !== 0 || e.type === 'pointercancel') return;
      const box = this.canvas.getBoundingClientRect();
      this.onClick(e.clientX - box.left, e.clientY - box.top);
    };
    this.canvas.addEventListener('pointermove', move);
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
  }

  #key(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (step && event.shiftKey) this.#pan(-40 * step[0], 40 * step[1]);
    else if (step) [this.yaw, this.pitch] = [this.yaw + 0.1 * step[0], this.pitch + 0.1 * step[1]];
    else if (event.key === '+' || event.key === '=') this.distance *= 0.85;
    else if (event.key === '-') this.distance /= 0.85;
    else if (event.key === 'Home') this.reset();
    else return;
    event.preventDefault();
    this.#moved();
  }
}

/** The box of meshes with transforms, world space: {center, half}. */
export function boundsOf(asset, shown) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { mesh, transform } of shown) {
    const { origin, boundsMin, boundsMax } = asset.meshes[mesh];
    const t = transform ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
    for (let corner = 0; corner < 8; ++corner) {
      const p = [0, 1, 2].map((k) => origin[k] + ((corner >> k) & 1 ? boundsMax[k] : boundsMin[k]));
      for (let k = 0; k < 3; ++k) {
        const value = t[4 * k] * p[0] + t[4 * k + 1] * p[1] + t[4 * k + 2] * p[2] + t[4 * k + 3];
        low[k] = Math.min(low[k], value);
        high[k] = Math.max(high[k], value);
      }
    }
  }
  if (!(low[0] <= high[0])) return { center: [0, 0, 0], half: [1, 1, 1] };
  return { center: low.map((value, k) => (value + high[k]) / 2), half: low.map((value, k) => (high[k] - value) / 2) };
}
