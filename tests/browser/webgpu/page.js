// SPDX-License-Identifier: GPL-3.0-or-later
// The page of the tests: one asset on a device of its own, driven from outside through window.test.
import { loadRuntime } from 'meshlode';
import { openLode, requestDevice } from 'meshlode/webgpu';

const sub = (a, b) => a.map((value, k) => value - b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((value) => value / Math.sqrt(dot(a, a)));
const FORMAT = 'rgba8unorm';
const GROUND = [1, 0, 1, 1];

/** {view, viewProjection} of a camera; columns, depths from 0 to 1. `orthoHeight`: without perspective. */
function cameraOf({ eye, target, fovy = 45, near, orthoHeight, width, height }) {
  const z = unit(sub(eye, target));
  const x = unit(cross([0, 1, 0], z));
  const y = cross(z, x);
  const toCamera = [x, y, z].map((axis) => [...axis, -dot(axis, eye)]);
  const far = 1e6 * near;
  const aspect = width / height;
  const f = 1 / Math.tan((0.5 * fovy * Math.PI) / 180);
  const w = orthoHeight ? [0, 0, 0, 1] : toCamera[2].map((value) => -value);
  const [scale, offset] = orthoHeight ? [-1 / (far - near), -near / (far - near)] : [-far / (far - near), (-far * near) / (far - near)];
  const [sx, sy] = orthoHeight ? [2 / (orthoHeight * aspect), 2 / orthoHeight] : [f / aspect, f];
  const depth = toCamera[2].map((value, k) => scale * value + (k === 3 ? offset : 0));
  const rows = [toCamera[0].map((value) => sx * value), toCamera[1].map((value) => sy * value), depth, w];
  const view = { eye, isOrthographic: orthoHeight !== undefined, nearDistance: near, heightPx: height };
  if (orthoHeight) view.orthoHeight = orthoHeight;
  else view.fovyRadians = (fovy * Math.PI) / 180;
  return { view, viewProjection: Array.from({ length: 16 }, (_, i) => rows[i % 4][i >> 2]) };
}

const device = await requestDevice();
const lost = [];
device?.addEventListener('uncapturederror', ({ error }) => lost.push(error.message));
device?.lost.then(({ message }) => lost.push(`lost: ${message}`));
const canvas = document.body.appendChild(document.createElement('canvas'));

const DECODE = `
@group(0) @binding(0) var<storage, read> words: array<u32>;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read_write> out: array<u32>;
@group(0) @binding(3) var<uniform> mesh: LodeMesh;
fn lode_word(i: u32) -> u32 { return words[i]; }
@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) lane: vec3u) {
  let c = lode_read_cluster(mesh, 0u, group.x);
  let stride = 3u + select(0u, 3u, mesh.normal_scale != 0u) + 2u * mesh.uv_set_count + select(0u, 4u, mesh.has_color != 0u);
  var at = starts[group.x];
  if (lane.x == 0u) { out[at] = c.vertex_count; out[at + 1u] = c.triangle_count; }
  at += 2u;
  for (var v = lane.x; v < c.vertex_count; v += 64u) {
    var to = at + v * stride;
    let raw = lode_raw_position(c, v);
    let q = lode_position(c, raw);
    for (var k = 0u; k < 3u; k++) { out[to] = bitcast<u32>(q[k]); to++; }
    if (mesh.normal_scale != 0u) {
      let n = lode_normal(c, v);
      for (var k = 0u; k < 3u; k++) { out[to] = bitcast<u32>(n[k]); to++; }
    }
    for (var k = 0u; k < mesh.uv_set_count; k++) {
      let uv = lode_uv(c, k, v, raw);
      out[to] = bitcast<u32>(uv.x); out[to + 1u] = bitcast<u32>(uv.y);
      to += 2u;
    }
    if (mesh.has_color != 0u) {
      let color = lode_color(c, v);
      for (var k = 0u; k < 4u; k++) { out[to] = color[k]; to++; }
    }
  }
  at += c.vertex_count * stride;
  for (var t = lane.x; t < c.triangle_count; t += 64u) {
    let corners = lode_triangle(c, t);
    out[at + 4u * t] = corners.x; out[at + 4u * t + 1u] = corners.y; out[at + 4u * t + 2u] = corners.z;
    out[at + 4u * t + 3u] = lode_material(c, t);
  }
}`;

const buffer = (usage, words) => {
  const made = device.createBuffer({ size: Math.max(16, words.byteLength), usage: usage | GPUBufferUsage.COPY_DST });
  device.queue.writeBuffer(made, 0, words);
  return made;
};
async function readBack(from, size) {
  const to = device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(from, 0, to, 0, size);
  device.queue.submit([encoder.finish()]);
  await to.mapAsync(GPUMapMode.READ);
  const bytes = to.getMappedRange().slice(0);
  to.destroy();
  return bytes;
}

/** The worker, without some of its pages: the main side is to select from any set. */
function withholding(share) {
  const worker = new Worker('/meshlode/stream/worker.js', { type: 'module' });
  const outer = { postMessage: (message) => worker.postMessage(message), terminate: () => worker.terminate() };
  const isLost = ({ type, page }) => type === 'page' && (Math.imul(page + 1, 2654435761) >>> 0) / 2 ** 32 < share;
  worker.onmessage = (event) => isLost(event.data) || outer.onmessage(event);
  worker.onerror = (event) => outer.onerror(event);
  return outer;
}

const test = {
  lode: null, errors: [], lost, changes: 0, camera: null, size: [640, 480],
  hasDevice: device !== null, realDevice: device,
  limits: device && { pool: device.limits.maxStorageBufferBindingSize },

  /** Every integer of every cluster by decode.wgsl and by the runtime: {clusters, integers, wrong, ranges, ...}. */
  async decodeAll(url) {
    const { STORAGE, UNIFORM, COPY_SRC } = GPUBufferUsage;
    const code = (await (await fetch('/meshlode/webgpu/decode.wgsl')).text()) + DECODE;
    const pipeline = await device.createComputePipelineAsync({ layout: 'auto', compute: { module: device.createShaderModule({ code }), entryPoint: 'main' } });
    const asset = (await loadRuntime()).open(new Uint8Array(await (await fetch(url)).arrayBuffer()));
    const seen = { clusters: 0, integers: 0, wrong: 0, normals: 0, uvs: 0, colors: 0, ranges: 0 };
    for (const [page, { firstCluster, clusterCount }] of asset.pages.entries()) {
      asset.loadPage(page);
      const mesh = asset.meshes[asset.meshOf(firstCluster)];
      const due = [];
      const starts = [];
      for (let cluster = firstCluster; cluster < firstCluster + clusterCount; ++cluster) {
        const { vertexCount, triangleCount, values, triangles, triangleMaterials } = asset.decodeIntegers(cluster);
        starts.push(due.length);
        due.push(vertexCount, triangleCount, ...values.map((value) => value));
        for (let t = 0; t < triangleCount; ++t) due.push(...triangles.subarray(3 * t, 3 * t + 3), triangleMaterials[t]);
        seen.ranges += new Set(triangleMaterials).size > 1;
      }
      const expected = Uint32Array.from(due, (value) => value >>> 0);
      const out = buffer(STORAGE | COPY_SRC, new Uint32Array(expected.length));
      const bytes = asset.pageBytes(page);
      const buffers = [buffer(STORAGE, bytes), buffer(STORAGE, Uint32Array.from(starts)), out,
        buffer(UNIFORM, Uint32Array.of(mesh.normalScale, mesh.uvSetCount, Number(mesh.hasColor), mesh.material))];
      const group = device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries: buffers.map((one, binding) => ({ binding, resource: { buffer: one } })) });
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(clusterCount);
      pass.end();
      device.queue.submit([encoder.finish()]);
      const said = new Uint32Array(await readBack(out, 4 * expected.length));
      seen.wrong += expected.filter((value, i) => value !== said[i]).length;
      seen.integers += expected.length;
      seen.clusters += clusterCount;
      seen.normals += mesh.normalScale !== 0;
      seen.uvs += mesh.uvSetCount !== 0;
      seen.colors += mesh.hasColor;
      buffers.forEach((one) => one.destroy());
      asset.dropPage(page);
    }
    asset.close();
    return seen;
  },

  /** Opens an asset; 'ok', or what was refused with its place. `withhold`: the share of pages that never come, whatever needs them. */
  async open(url, { withhold, ...options } = {}) {
    if (withhold) options.createWorker = () => withholding(withhold);
    test.lode?.dispose();
    test.errors = [];
    test.changes = 0;
    try {
      test.lode = await openLode(test.device ?? device, url, { format: FORMAT, depthFormat: 'depth32float', onChange: () => ++test.changes,
        onError: ({ place, message, isFatal }) => test.errors.push({ place, message, isFatal }), ...options });
    } catch (error) {
      test.lode = null;
      return { place: error.place, message: error.message };
    }
    return 'ok';
  },
  openWithout: () => openLode(null, 'none', { format: FORMAT }).then(() => 'ok', ({ place, message }) => ({ place, message })),
  setCamera(camera) {
    const [width, height] = test.size;
    test.camera = cameraOf({ width, height, ...camera });
  },
  /** A frame; its pixels where `isRead`. */
  async draw(isRead = false) {
    const [width, height] = test.size;
    const target = (format, usage) => device.createTexture({ size: [width, height], format, usage: GPUTextureUsage.RENDER_ATTACHMENT | usage });
    const [color, depth] = [target(FORMAT, GPUTextureUsage.COPY_SRC), target('depth32float', 0)];
    const encoder = device.createCommandEncoder();
    test.lode.select(encoder, test.camera);
    const pass = encoder.beginRenderPass({
      colorAttachments: [{ view: color.createView(), clearValue: GROUND, loadOp: 'clear', storeOp: 'store' }],
      depthStencilAttachment: { view: depth.createView(), depthClearValue: 1, depthLoadOp: 'clear', depthStoreOp: 'discard' },
    });
    test.lode.draw(pass);
    pass.end();
    const bytesPerRow = 256 * Math.ceil((4 * width) / 256);
    const out = device.createBuffer({ size: bytesPerRow * height, usage: GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST });
    if (isRead) encoder.copyTextureToBuffer({ texture: color }, { buffer: out, bytesPerRow }, [width, height]);
    device.queue.submit([encoder.finish()]);
    let pixels;
    if (isRead) {
      const bytes = new Uint8Array(await readBack(out, bytesPerRow * height));
      pixels = new Uint8ClampedArray(4 * width * height);
      for (let y = 0; y < height; ++y) pixels.set(bytes.subarray(y * bytesPerRow, y * bytesPerRow + 4 * width), 4 * width * y);
    } else {
      await device.queue.onSubmittedWorkDone();
    }
    for (const one of [color, depth, out]) one.destroy();
    return pixels;
  },
  /** Draws until the view is complete, or an error is fatal; false after so many seconds. */
  async settle(seconds = 90) {
    for (const end = performance.now() + 1000 * seconds; performance.now() < end; await new Promise((done) => setTimeout(done, 5))) {
      const encoder = device.createCommandEncoder();
      test.lode.select(encoder, test.camera);
      device.queue.submit([encoder.finish()]);
      if (test.lode.isSettled || test.errors.some(({ isFatal }) => isFatal)) return true;
    }
    return false;
  },
  /** What is selected now, and by what, as the native judge takes it: eye, kind, lens, near, height, pixel error, no planes, pages. */
  async drawn() {
    await test.draw();
    const { view: v } = test.camera;
    const { instances, clusters } = await test.lode.readDrawn();
    const head = [...v.eye, Number(v.isOrthographic), v.fovyRadians ?? 0, v.orthoHeight ?? 0, v.nearDistance, v.heightPx, test.lode.pixelError];
    return { head: head.join(' '), resident: [...test.lode.resident].join(' '), items: Array.from(clusters, (c, i) => `${instances[i]}:${c}`).join(' ') };
  },
  /** Of a picture: 1 where it is not the background. */
  async coverage() {
    const pixels = await test.draw(true);
    [canvas.width, canvas.height] = test.size;
    canvas.getContext('2d').putImageData(new ImageData(pixels, ...test.size), 0, 0);
    return covered(pixels, GROUND.map((value) => 255 * value));
  },
  async coverageOf(url) {
    const image = await createImageBitmap(await (await fetch(url)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    return covered(data, data.slice(0, 3));
  },
};
function covered(bytes, ground) {
  let text = '';
  for (let at = 0; at < bytes.length; at += 4) text += [0, 1, 2].every((k) => bytes[at + k] === ground[k]) ? '0' : '1';
  return text;
}
window.test = test;
