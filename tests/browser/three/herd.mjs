// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that no file of data/ is: many instances of a few models as one GLB, and colours of vertices as a glTF.
import { readFileSync } from 'node:fs';

/** The chunks of a GLB: [document, bytes]. */
function readGlb(path) {
  const file = readFileSync(path);
  const size = file.readUInt32LE(12);
  return [JSON.parse(file.subarray(20, 20 + size).toString()), file.subarray(28 + size, 28 + size + file.readUInt32LE(20 + size))];
}

/** `count` instances of the models' first meshes on a square, each turned by its number and of about one size. */
export function herd(paths, count) {
  const out = { asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [] }], nodes: [], meshes: [], accessors: [], bufferViews: [],
    buffers: [{ byteLength: 0 }], materials: [] };
  const parts = [];
  let bytes = 0;
  const scales = [];
  for (const path of paths) {
    const [model, chunk] = readGlb(path);
    const [views, accessors] = [out.bufferViews.length, out.accessors.length];
    for (const view of model.bufferViews) out.bufferViews.push({ ...view, buffer: 0, byteOffset: (view.byteOffset ?? 0) + bytes });
    for (const accessor of model.accessors) out.accessors.push({ ...accessor, bufferView: accessor.bufferView + views });
    out.materials.push({ name: `model ${out.materials.length}`, pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 0.8,
      baseColorFactor: [[0.8, 0.5, 0.4, 1], [0.5, 0.7, 0.5, 1], [0.5, 0.6, 0.8, 1]][out.materials.length % 3] } });
    const primitives = model.meshes[0].primitives.map(({ indices, attributes: { POSITION, NORMAL } }) => ({
      indices: indices + accessors,
      attributes: { POSITION: POSITION + accessors, ...(NORMAL === undefined ? {} : { NORMAL: NORMAL + accessors }) },
      material: out.materials.length - 1,
    }));
    const { min, max } = model.accessors[model.meshes[0].primitives[0].attributes.POSITION];
    scales.push(1 / Math.max(...max.map((value, k) => value - min[k])));
    out.meshes.push({ primitives });
    parts.push(chunk, Buffer.alloc((4 - (chunk.length % 4)) % 4));
    bytes += chunk.length + ((4 - (chunk.length % 4)) % 4);
  }
  const side = Math.ceil(Math.sqrt(count));
  for (let i = 0; i < count; ++i) {
    const angle = i * 2.4;
    const scale = scales[i % paths.length];
    out.nodes.push({ mesh: i % paths.length, scale: [scale, scale, scale], rotation: [0, Math.sin(angle / 2), 0, Math.cos(angle / 2)],
      translation: [1.5 * (i % side), 0, 1.5 * Math.floor(i / side)] });
    out.scenes[0].nodes.push(i);
  }
  out.buffers[0].byteLength = bytes;
  let text = Buffer.from(JSON.stringify(out));
  text = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const head = Buffer.alloc(20);
  head.write('glTF', 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(28 + text.length + bytes, 8);
  head.writeUInt32LE(text.length, 12);
  head.write('JSON', 16);
  const second = Buffer.alloc(8);
  second.writeUInt32LE(bytes, 0);
  second.write('BIN\0', 4);
  return Buffer.concat([head, text, second, ...parts]);
}

/** A wavy sheet whose vertices have colours and whose normals are stored, mirrored once beside itself. */
export function colouredSheet() {
  const side = 40;
  const [positions, normals, colors, indices] = [[], [], [], []];
  for (let y = 0; y < side; ++y) {
    for (let x = 0; x < side; ++x) {
      positions.push(x / side, 0.1 * Math.sin((6 * x) / side) * Math.cos((4 * y) / side), y / side);
      normals.push(0, 1, 0);
      colors.push(x / side, y / side, (x ^ y) & 8 ? 1 : 0.2, 1);
      const at = y * side + x;
      if (x > 0 && y > 0) indices.push(at, at - side, at - side - 1, at, at - side - 1, at - 1);
    }
  }
  const parts = [Float32Array.from(positions), Float32Array.from(normals), Float32Array.from(colors), Uint16Array.from(indices)];
  const bytes = Buffer.concat(parts.map((part) => Buffer.from(part.buffer)));
  let at = 0;
  const bufferViews = parts.map(({ byteLength }) => ({ buffer: 0, byteOffset: (at += byteLength) - byteLength, byteLength }));
  const vertices = side * side;
  const accessors = [
    { bufferView: 0, componentType: 5126, count: vertices, type: 'VEC3', min: [0, -0.1, 0], max: [1, 0.1, 1] },
    { bufferView: 1, componentType: 5126, count: vertices, type: 'VEC3' },
    { bufferView: 2, componentType: 5126, count: vertices, type: 'VEC4' },
    { bufferView: 3, componentType: 5123, count: indices.length, type: 'SCALAR' },
  ];
  const attributes = { POSITION: 0, NORMAL: 1, COLOR_0: 2 };
  return JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0, 1] }], nodes: [{ mesh: 0 }, { mesh: 0, scale: [-1, 1, 1], translation: [-0.1, 0, 0] }],
    meshes: [{ primitives: [{ attributes, indices: 3, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 0.7, baseColorFactor: [1, 0.9, 0.8, 1] }, emissiveFactor: [0.1, 0, 0.2] }],
    accessors, bufferViews, buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
  });
}
