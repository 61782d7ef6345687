// SPDX-License-Identifier: MIT
// A cut in 3D by WebGL2: vertices of all its clusters in one buffer, in world space around the middle of what is shown, each
// with the number of its cluster, whose colour is looked up in a texture: measures and selection change without new geometry.
import { NONE } from './index.js';

const COLOUR_WIDTH = 1024;
const FIELD_OF_VIEW = 0.7; // vertical, radians
const FRAME_SHARE = 0.92; // of the picture that Home fills

const VERTEX = `#version 300 es
uniform mat4 camera;
in vec3 position;
in uint cluster;
out vec3 place;
flat out uint id;
void main() {
  place = position;
  id = cluster;
  gl_Position = camera * vec4(position, 1.0);
}`;

// Flat shading by derivatives; what is selected is striped, so that no colour alone says it.
const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D colours;
uniform vec3 eye;
uniform vec3 mark;
in vec3 place;
flat in uint id;
out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.35 + 0.65 * abs(dot(normal, normalize(eye - place)));
  vec4 own = texelFetch(colours, ivec2(int(id & 1023u), int(id >> 10u)), 0);
  bool isStripe = own.a < 0.75 && mod(gl_FragCoord.x + gl_FragCoord.y, 10.0) < 5.0;
  colour = vec4((isStripe ? mark : own.rgb) * light, 1.0);
}`;

const PICK = `#version 300 es
precision highp float;
precision highp int;
in vec3 place;
flat in uint id;
out uvec2 picked;
void main() { picked = uvec2(id + 1u, 0u); }`;

export class MeshView {
  /** Throws where there is no WebGL2. */
  constructor(canvas, asset, { onSelect, onMove, onResize }) {
    Object.assign(this, { canvas, asset, onSelect, onMove });
    const gl = canvas.getContext('webgl2', { antialias: true });
    if (!gl) throw new Error('this browser has no WebGL2');
    this.gl = gl;
    this.programs = { draw: compile(gl, FRAGMENT), pick: compile(gl, PICK) };
    this.decoded = new Map();
    this.decodedFloats = 0;
    this.count = 0;
    this.vertices = gl.createBuffer();
    this.ids = gl.createBuffer();
    this.indices = gl.createBuffer();
    this.array = gl.createVertexArray();
    this.colours = gl.createTexture();
    this.colourRows = Math.max(1, Math.ceil(asset.clusters.length / COLOUR_WIDTH));
    gl.enable(gl.DEPTH_TEST);
    this.#bindGeometry();
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('pointerdown', (event) => this.#press(event));
    canvas.addEventListener('keydown', (event) => this.#key(event));
    new ResizeObserver(() => {
      this.draw();
      onResize();
    }).observe(canvas);
  }

  /** The box that Home shows, world space: its middle, around which geometry is stored, and its half edges. */
  frame({ center, half }) {
    this.center = center;
    this.half = half;
    this.radius = Math.hypot(...half) || 1;
    this.decoded.clear();
    this.decodedFloats = 0;
    this.#reset();
  }

  #reset() {
    this.yaw = 0.6;
    this.pitch = 0.35;
    this.distance = 1;
    this.distance = Math.max(this.#fittingDistance(), this.radius / 100);
  }

  /** From where all corners of the box are in the picture, with a rim. */
  #fittingDistance() {
    const { x, y, z } = cameraAxes(this.#eye());
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

  /** The camera as meshlode_view has it. */
  view() {
    const eye = this.#eye();
    return {
      eye: eye.map((value, k) => value + this.center[k]),
      fovyRadians: FIELD_OF_VIEW,
      nearDistance: this.#near(),
      heightPx: Math.max(1, Math.round(this.canvas.clientHeight * (window.devicePixelRatio || 1))),
    };
  }

  /** items: [{cluster, transform: 3x4 or null, origin}] */
  setCut(items) {
    let vertexCount = 0;
    let indexCount = 0;
    const parts = items.map((item) => {
      const part = this.#decode(item.cluster);
      vertexCount += part.vertexCount;
      indexCount += 3 * part.triangleCount;
      return part;
    });
    const positions = new Float32Array(3 * vertexCount);
    const ids = new Uint32Array(vertexCount);
    const indices = new Uint32Array(indexCount);
    let v = 0;
    let i = 0;
    items.forEach(({ cluster, transform, origin }, k) => {
      const part = parts[k];
      place(part.positions, transform, origin, this.center, positions.subarray(3 * v, 3 * (v + part.vertexCount)));
      ids.fill(cluster, v, v + part.vertexCount);
      for (const corner of part.triangles) indices[i++] = v + corner;
      v += part.vertexCount;
    });
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.vertices);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
    gl.bufferData(gl.ARRAY_BUFFER, ids, gl.DYNAMIC_DRAW);
    gl.bindVertexArray(this.array);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.DYNAMIC_DRAW);
    this.count = indexCount;
    this.draw();
  }

  /** bytes: 4 a cluster; the fourth below 128 is selected. */
  setColours(bytes) {
    const gl = this.gl;
    const all = new Uint8Array(4 * COLOUR_WIDTH * this.colourRows);
    all.set(bytes);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, COLOUR_WIDTH, this.colourRows, 0, gl.RGBA, gl.UNSIGNED_BYTE, all);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.draw();
  }

  draw() {
    cancelAnimationFrame(this.request);
    this.request = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    if (!this.center) return;
    const { gl, canvas } = this;
    const scale = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    const ground = this.theme.canvas.map((value) => value / 255);
    gl.clearColor(ground[0], ground[1], ground[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.#render(this.programs.draw, width / height);
  }

  #render(program, aspect) {
    const gl = this.gl;
    const eye = this.#eye();
    gl.useProgram(program);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'camera'), false, cameraMatrix(eye, aspect, this.#near(), this.#far()));
    gl.uniform3fv(gl.getUniformLocation(program, 'eye'), eye);
    gl.uniform3fv(gl.getUniformLocation(program, 'mark'), this.theme.mark.map((value) => value / 255));
    gl.uniform1i(gl.getUniformLocation(program, 'colours'), 0);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
  }

  /** The cluster at a place of the canvas, CSS pixels; NONE for the ground. */
  pick(x, y) {
    const { gl, canvas } = this;
    const target = gl.createFramebuffer();
    const colour = gl.createRenderbuffer();
    const depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.bindRenderbuffer(gl.RENDERBUFFER, colour);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RG32UI, canvas.width, canvas.height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, colour);
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, canvas.width, canvas.height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.#render(this.programs.pick, canvas.width / canvas.height);
    const scale = canvas.height / Math.max(1, canvas.clientHeight);
    const pixel = new Uint32Array(4);
    gl.readPixels(Math.round(x * scale), canvas.height - 1 - Math.round(y * scale), 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(target);
    gl.deleteRenderbuffer(colour);
    gl.deleteRenderbuffer(depth);
    return pixel[0] === 0 ? NONE : pixel[0] - 1;
  }

  #bindGeometry() {
    const gl = this.gl;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.vertices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribIPointer(1, 1, gl.UNSIGNED_INT, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
  }

  /** Decoded once, until there is too much of it. */
  #decode(cluster) {
    let part = this.decoded.get(cluster);
    if (!part) {
      if (this.decodedFloats > 2 ** 24) {
        this.decoded.clear();
        this.decodedFloats = 0;
      }
      part = this.asset.decodeFloats(cluster);
      this.decoded.set(cluster, part);
      this.decodedFloats += part.positions.length;
    }
    return part;
  }

  #eye() {
    const flat = Math.cos(this.pitch) * this.distance;
    return [Math.sin(this.yaw) * flat, Math.sin(this.pitch) * this.distance, Math.cos(this.yaw) * flat];
  }
  #near() {
    return Math.max(this.distance - 1.5 * this.radius, this.distance / 500);
  }
  #far() {
    return this.distance + 1.5 * this.radius;
  }

  #moved() {
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch));
    this.distance = Math.max(this.radius / 1000, Math.min(this.radius * 50, this.distance));
    this.draw();
    this.onMove();
  }

  #wheel(event) {
    event.preventDefault();
    this.distance *= Math.exp(event.deltaY * 0.001);
    this.#moved();
  }

  #press(event) {
    const begin = { x: event.clientX, y: event.clientY, yaw: this.yaw, pitch: this.pitch };
    let hasTurned = false;
    const move = (e) => {
      hasTurned ||= Math.hypot(e.clientX - begin.x, e.clientY - begin.y) > 4;
      if (!hasTurned) return;
      this.yaw = begin.yaw - (e.clientX - begin.x) * 0.008;
      this.pitch = begin.pitch + (e.clientY - begin.y) * 0.008;
      this.#moved();
    };
    const end = (e) => {
      this.canvas.removeEventListener('pointermove', move);
      if (hasTurned || e.type === 'pointercancel') return;
      const box = this.canvas.getBoundingClientRect();
      const cluster = this.pick(e.clientX - box.left, e.clientY - box.top);
      if (cluster !== NONE) this.onSelect(cluster);
    };
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.addEventListener('pointermove', move);
    this.canvas.addEventListener('pointerup', end, { once: true });
    this.canvas.addEventListener('pointercancel', end, { once: true });
  }

  #key(event) {
    if (event.key === 'ArrowLeft') this.yaw -= 0.1;
    else if (event.key === 'ArrowRight') this.yaw += 0.1;
    else if (event.key === 'ArrowUp') this.pitch += 0.1;
    else if (event.key === 'ArrowDown') this.pitch -= 0.1;
    else if (event.key === '+' || event.key === '=') this.distance *= 0.85;
    else if (event.key === '-') this.distance /= 0.85;
    else if (event.key === 'Home') this.#reset();
    else return;
    event.preventDefault();
    this.#moved();
  }
}

/** Mesh space to world, around a middle. */
function place(from, transform, origin, center, to) {
  const t = transform ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
  for (let i = 0; i < from.length; i += 3) {
    const x = from[i] + origin[0];
    const y = from[i + 1] + origin[1];
    const z = from[i + 2] + origin[2];
    for (let k = 0; k < 3; ++k) to[i + k] = t[4 * k] * x + t[4 * k + 1] * y + t[4 * k + 2] * z + t[4 * k + 3] - center[k];
  }
}

function compile(gl, fragment) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, 'position');
  gl.bindAttribLocation(program, 1, 'cluster');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

/** Of a camera that looks from the eye to the origin, y up: right, up and backwards. */
function cameraAxes(eye) {
  const length = Math.hypot(...eye);
  const z = eye.map((value) => value / length);
  const flat = Math.hypot(z[0], z[2]);
  const x = [z[2] / flat, 0, -z[0] / flat];
  const y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
  return { x, y, z };
}

/** Looks from the eye to the origin; column-major. */
function cameraMatrix(eye, aspect, near, far) {
  const { x, y, z } = cameraAxes(eye);
  const focus = 1 / Math.tan(FIELD_OF_VIEW / 2);
  const depth = (far + near) / (near - far);
  const shift = (2 * far * near) / (near - far);
  const dot = (a) => a[0] * eye[0] + a[1] * eye[1] + a[2] * eye[2];
  const out = new Float32Array(16);
  for (let k = 0; k < 3; ++k) {
    out[4 * k] = (x[k] * focus) / aspect;
    out[4 * k + 1] = y[k] * focus;
    out[4 * k + 2] = z[k] * depth;
    out[4 * k + 3] = -z[k];
  }
  out[12] = (-dot(x) * focus) / aspect;
  out[13] = -dot(y) * focus;
  out[14] = -dot(z) * depth + shift;
  out[15] = dot(z);
  return out;
}
