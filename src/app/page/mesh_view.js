// SPDX-License-Identifier: MIT
// A cut in 3D by WebGL2: vertices of all its clusters in one buffer, in world space around the middle of what is shown, each
// with the number of its cluster, whose colour is looked up in a texture: measures and selection change without new geometry.
import { NONE } from 'meshlode';
import { FIELD_OF_VIEW, Orbit } from './orbit.js';

const COLOUR_WIDTH = 1024;
const NORMALS = 1; // of the uniform `mode`: 0 is colours of clusters, 2 edges
const EDGES = 2;

const VERTEX = `#version 300 es
uniform mat4 camera;
in vec3 position;
in uint cluster;
in vec3 normal;
out vec3 place;
out vec3 shaded;
flat out uint id;
void main() {
  place = position;
  shaded = normal;
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
uniform vec3 edge;
uniform int mode;
in vec3 place;
in vec3 shaded;
flat in uint id;
out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  if (mode == 1) {
    colour = vec4(0.5 + 0.5 * (dot(shaded, shaded) > 0.0 ? normalize(shaded) : normal), 1.0);
    return;
  }
  if (mode == 2) {
    colour = vec4(edge, 1.0);
    return;
  }
  float light = 0.35 + 0.65 * abs(dot(normal, normalize(eye - place)));
  vec4 own = texelFetch(colours, ivec2(int(id & 1023u), int(id >> 10u)), 0);
  bool isStripe = own.a < 0.75 && mod(gl_FragCoord.x + gl_FragCoord.y, 10.0) < 5.0;
  colour = vec4((isStripe ? mark : own.rgb) * light, 1.0);
}`;

const PICK = `#version 300 es
precision highp float;
precision highp int;
in vec3 place;
in vec3 shaded;
flat in uint id;
out uvec2 picked;
void main() { picked = uvec2(id + 1u, 0u); }`;

export class MeshView {
  /** Throws where there is no WebGL2. */
  constructor(canvas, asset, { onSelect, onMove, onResize }) {
    Object.assign(this, { canvas, asset, hasMoved: false, mode: 0, isWire: false, items: [] });
    const gl = canvas.getContext('webgl2', { antialias: true });
    if (!gl) throw new Error('this browser has no WebGL2');
    this.gl = gl;
    this.programs = { draw: compile(gl, FRAGMENT), pick: compile(gl, PICK) };
    this.decoded = new Map();
    this.decodedFloats = 0;
    this.count = 0;
    this.vertices = gl.createBuffer();
    this.normals = gl.createBuffer();
    this.ids = gl.createBuffer();
    this.indices = gl.createBuffer();
    this.array = gl.createVertexArray();
    this.colours = gl.createTexture();
    this.colourRows = Math.max(1, Math.ceil(asset.clusters.length / COLOUR_WIDTH));
    gl.enable(gl.DEPTH_TEST);
    this.#bindGeometry();
    this.orbit = new Orbit(canvas, {
      onMove: () => {
        this.hasMoved = true;
        this.draw();
        onMove();
      },
      onClick: (x, y) => {
        const cluster = this.pick(x, y);
        if (cluster !== NONE) onSelect(cluster);
      },
    });
    new ResizeObserver(() => {
      this.draw();
      onResize();
    }).observe(canvas);
  }

  /** The box that Home shows, world space: its middle, around which geometry is stored, and its half edges. */
  frame(box) {
    this.center = box.center;
    this.decoded.clear();
    this.decodedFloats = 0;
    this.orbit.frame(box);
  }

  /** The camera as meshlode_view has it. */
  view() {
    return {
      eye: this.orbit.eye().map((value, k) => value + this.center[k]),
      fovyRadians: FIELD_OF_VIEW,
      nearDistance: this.orbit.near(),
      heightPx: Math.max(1, Math.round(this.canvas.clientHeight * (window.devicePixelRatio || 1))),
    };
  }

  setMode(measure, isWire) {
    this.mode = measure === 'normals' ? NORMALS : 0;
    if (isWire === this.isWire) return this.draw();
    this.isWire = isWire;
    this.setCut(this.items);
  }

  /** items: [{cluster, transform: 3x4 or null, origin}] */
  setCut(items) {
    this.items = items;
    let vertexCount = 0;
    let indexCount = 0;
    const parts = items.map((item) => {
      const part = this.#decode(item.cluster);
      vertexCount += part.vertexCount;
      indexCount += 3 * part.triangleCount;
      return part;
    });
    const positions = new Float32Array(3 * vertexCount);
    const normals = new Float32Array(3 * vertexCount);
    const ids = new Uint32Array(vertexCount);
    const indices = new Uint32Array(this.isWire ? 3 * indexCount : indexCount); // triangles, and behind them edges
    let v = 0;
    let i = 0;
    items.forEach(({ cluster, transform, origin }, k) => {
      const part = parts[k];
      place(part.positions, transform, origin, this.center, positions.subarray(3 * v, 3 * (v + part.vertexCount)));
      if (part.normals) turn(part.normals, transform, normals.subarray(3 * v, 3 * (v + part.vertexCount)));
      ids.fill(cluster, v, v + part.vertexCount);
      for (const corner of part.triangles) indices[i++] = v + corner;
      v += part.vertexCount;
    });
    for (let t = 0; this.isWire && t < indexCount; t += 3) {
      for (let k = 0; k < 3; ++k) {
        indices[i++] = indices[t + k];
        indices[i++] = indices[t + ((k + 1) % 3)];
      }
    }
    const gl = this.gl;
    for (const [buffer, data] of [[this.vertices, positions], [this.normals, normals], [this.ids, ids]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    }
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
    // Triangles a step behind their edges.
    if (this.isWire) gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.#render(this.programs.draw, width / height, this.mode);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (this.isWire) this.#render(this.programs.draw, width / height, EDGES);
  }

  toPng(done) {
    this.drawNow();
    this.canvas.toBlob(done);
  }

  #render(program, aspect, mode) {
    const gl = this.gl;
    const at = (name) => gl.getUniformLocation(program, name);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at('camera'), false, cameraMatrix(this.orbit, aspect));
    gl.uniform3fv(at('eye'), this.orbit.eye());
    gl.uniform3fv(at('mark'), this.theme.mark.map((value) => value / 255));
    gl.uniform3fv(at('edge'), this.theme.isDark ? [0.9, 0.9, 0.9] : [0.1, 0.1, 0.1]);
    gl.uniform1i(at('mode'), mode);
    gl.uniform1i(at('colours'), 0);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.bindVertexArray(this.array);
    if (mode === EDGES) gl.drawElements(gl.LINES, 2 * this.count, gl.UNSIGNED_INT, 4 * this.count);
    else gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
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
    this.#render(this.programs.pick, canvas.width / canvas.height, 0);
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
    gl.bindBuffer(gl.ARRAY_BUFFER, this.normals);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribPointer(2, 3, gl.FLOAT, false, 0, 0);
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

/** Normals to world: by the cofactors of the transform, which are right under unequal scales too, and inwards where it mirrors. */
function turn(from, transform, to) {
  const t = transform ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
  const minor = (i, k) => t[4 * ((i + 1) % 3) + ((k + 1) % 3)] * t[4 * ((i + 2) % 3) + ((k + 2) % 3)] -
    t[4 * ((i + 1) % 3) + ((k + 2) % 3)] * t[4 * ((i + 2) % 3) + ((k + 1) % 3)];
  const rows = [0, 1, 2].map((i) => [0, 1, 2].map((k) => minor(i, k)));
  const sign = t[0] * rows[0][0] + t[1] * rows[0][1] + t[2] * rows[0][2] < 0 ? -1 : 1;
  for (let i = 0; i < from.length; i += 3) {
    for (let k = 0; k < 3; ++k) to[i + k] = sign * (rows[k][0] * from[i] + rows[k][1] * from[i + 1] + rows[k][2] * from[i + 2]);
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
  gl.bindAttribLocation(program, 2, 'normal');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

/** Of an orbit's camera; column-major. */
function cameraMatrix(orbit, aspect) {
  const { x, y, z } = orbit.axes();
  const [eye, near, far] = [orbit.eye(), orbit.near(), orbit.far()];
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
