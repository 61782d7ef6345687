// SPDX-License-Identifier: MIT
// decode.glsl in WGSL: a cluster of a decoded page, read as it lies in a buffer of 32-bit words (docs/reference/format.md, sections 12
// and 13). Any vertex and any triangle alone, in one invocation, to the same integers as on the CPU (I9). Integers only.
//
// The module that this text is put into declares
//   fn lode_word(i: u32) -> u32       // word i of whatever holds the page; i is counted from where the caller says the page starts
// Words up to and with the page's last (zero) one are read, for any sound page.
//
//   let mesh = LodeMesh(…);                             // from MeshRecord: the four numbers below
//   let c = lode_read_cluster(mesh, page_word, cluster - first cluster of the page);
//   let raw = lode_raw_position(c, v);                  // v < c.vertex_count
//   let q = lode_position(c, raw);                      // grid units
//   let uv = lode_uv(c, 0u, v, raw);                    // units of 2^uv_log2[0]
//   let corners = lode_triangle(c, t);                  // t < c.triangle_count: vertices of the cluster

const LODE_NONE = 0xFFFFFFFFu;
const LODE_SHEAR_SHIFT = 7u;
const LODE_MAX_UV_SETS = 4u;

struct LodeMesh {
  normal_scale: u32,  // 0: no normals are stored
  uv_set_count: u32,
  has_color: u32,
  material: u32,  // LODE_NONE: the clusters say
}

// Words are counted from the start of lode_word(), bits from the start of the page.
struct LodeCluster {
  page: u32,
  vertex_count: u32,
  triangle_count: u32,
  head: u32,
  normal_scale: u32,
  uv_set_count: u32,
  material: u32,
  material_word: u32,
  uv_word: array<u32, 4>,  // first UV range of each set
  uv_bit: array<u32, 4>,
  color_word: u32,
  position_bit: u32,
  normal_bit: u32,
  color_bit: u32,
  turn_bit: u32,
  fresh_bit: u32,
  restart_bit: u32,
  reference_bit: u32,
  strip_count: u32,
  restart_bits: u32,
  reference_bits: u32,
}

fn lode_field(word: u32, shift: u32, bits: u32) -> u32 { return extractBits(lode_word(word), shift, bits); }
fn lode_signed_field(word: u32, shift: u32, bits: u32) -> i32 { return extractBits(bitcast<i32>(lode_word(word)), shift, bits); }

// 32 bits from `bit` of the page.
fn lode_window(page: u32, bit: u32) -> u32 {
  let shift = bit & 31u;
  let low = lode_word(page + (bit >> 5u)) >> shift;
  if (shift == 0u) { return low; }
  return low | (lode_word(page + (bit >> 5u) + 1u) << (32u - shift));
}
// The lowest `count` <= 32 bits set.
fn lode_low_bits(count: u32) -> u32 { return select((1u << (count & 31u)) - 1u, 0xFFFFFFFFu, count >= 32u); }

// `count` <= 32 bits from `bit` of the page, and the ones in any range of them.
fn lode_bits(page: u32, bit: u32, count: u32) -> u32 { return lode_window(page, bit) & lode_low_bits(count); }
fn lode_count_ones(page: u32, bit: u32, count: u32) -> u32 {
  var ones = 0u;
  for (var done = 0u; done < count; done += 32u) {
    ones += countOneBits(lode_bits(page, bit + done, min(count - done, 32u)));
  }
  return ones;
}

// The last i in [first, end) whose bit (bit + i) equals `value`, or `none`.
fn lode_find_last(page: u32, bit: u32, first: u32, end: u32, value: bool, none: u32) -> u32 {
  var rest = end;
  while (rest > first) {
    let count = min(rest - first, 32u);
    var mask = lode_bits(page, bit + rest - count, count);
    if (!value) { mask = ~mask & lode_low_bits(count); }
    if (mask != 0u) { return rest - count + firstLeadingBit(mask); }
    rest -= count;
  }
  return none;
}

fn lode_read_cluster(mesh: LodeMesh, page_word: u32, index: u32) -> LodeCluster {
  var c: LodeCluster;
  let has_normal = mesh.normal_scale != 0u;
  let head = page_word + 2u + index * select(5u, 6u, has_normal);
  c.page = page_word;
  c.head = head;
  c.uv_set_count = mesh.uv_set_count;
  c.normal_scale = mesh.normal_scale;
  c.material = mesh.material;
  c.vertex_count = lode_field(head, 0u, 8u) + 1u;
  c.triangle_count = lode_field(head, 8u, 8u) + 1u;
  let position_bits = lode_field(head + 1u, 24u, 5u) + lode_field(head + 2u, 24u, 5u) + lode_field(head + 3u, 24u, 5u);
  var normal_bits = 0u;
  if (has_normal) { normal_bits = lode_field(head + 4u, 28u, 4u) + lode_field(head + 5u, 28u, 4u); }
  c.strip_count = lode_field(head + 4u, 16u, 8u) + 1u;
  c.reference_bits = lode_field(head + 4u, 24u, 4u);
  c.restart_bits = firstLeadingBit(c.triangle_count - 1u) + 1u;  // of 0: 0xFFFFFFFF + 1

  var word = page_word + lode_field(head, 16u, 16u);
  c.material_word = word;
  if (mesh.material == LODE_NONE) {
    for (var covered = 0u; covered < c.triangle_count; word++) { covered += lode_field(word, 0u, 8u) + 1u; }
  }
  var uv_bits: array<u32, 4>;
  for (var k = 0u; k < LODE_MAX_UV_SETS; k++) {
    c.uv_word[k] = word;
    uv_bits[k] = 0u;
    if (k >= mesh.uv_set_count) { continue; }
    for (var covered = 0u; covered < c.vertex_count;) {
      let count = lode_field(word, 0u, 8u) + 1u;
      covered += count;
      uv_bits[k] += count * (lode_field(word, 8u, 5u) + lode_field(word, 13u, 5u));
      word += select(3u, 5u, lode_field(word, 28u, 1u) != 0u);
    }
  }
  c.color_word = word;
  var color_bits = 0u;
  if (mesh.has_color != 0u) {
    for (var k = 0u; k < 4u; k++) { color_bits += lode_field(word + 1u, 4u * k, 4u); }
    word += 2u;
  }

  var bit = 32u * (word - page_word);
  c.position_bit = bit;
  bit += c.vertex_count * position_bits;
  c.normal_bit = bit;
  bit += c.vertex_count * normal_bits;
  for (var k = 0u; k < LODE_MAX_UV_SETS; k++) {
    c.uv_bit[k] = bit;
    bit += uv_bits[k];
  }
  c.color_bit = bit;
  bit += c.vertex_count * color_bits;
  c.turn_bit = bit;
  bit += c.triangle_count;
  c.fresh_bit = bit;
  bit += c.triangle_count + 2u * c.strip_count;
  c.restart_bit = bit;
  bit += (c.strip_count - 1u) * c.restart_bits;
  c.reference_bit = bit;
  return c;
}

fn lode_raw_position(c: LodeCluster, vertex: u32) -> vec3u {
  let bits_x = lode_field(c.head + 1u, 24u, 5u);
  let bits_y = lode_field(c.head + 2u, 24u, 5u);
  let bits_z = lode_field(c.head + 3u, 24u, 5u);
  let bit = c.position_bit + vertex * (bits_x + bits_y + bits_z);
  return vec3u(lode_bits(c.page, bit, bits_x), lode_bits(c.page, bit + bits_x, bits_y), lode_bits(c.page, bit + bits_x + bits_y, bits_z));
}

fn lode_position(c: LodeCluster, raw: vec3u) -> vec3i {
  var q = vec3i(raw) + vec3i(lode_signed_field(c.head + 1u, 0u, 24u), lode_signed_field(c.head + 2u, 0u, 24u),
                             lode_signed_field(c.head + 3u, 0u, 24u));
  let axis = lode_field(c.head + 2u, 29u, 2u);
  let u = i32(select(raw.x, raw.y, axis == 0u));
  let v = i32(select(raw.z, raw.y, axis == 2u));
  let shear = (lode_signed_field(c.head + 4u, 0u, 8u) * u + lode_signed_field(c.head + 4u, 8u, 8u) * v) >> LODE_SHEAR_SHIFT;
  if (axis == 0u) { q.x += shear; } else if (axis == 1u) { q.y += shear; } else { q.z += shear; }
  return q;
}

// The point (X, Y, Z) with |X| + |Y| + |Z| = normal_scale whose direction is the normal.
fn lode_normal(c: LodeCluster, vertex: u32) -> vec3i {
  let bits_a = lode_field(c.head + 4u, 28u, 4u);
  let bits_b = lode_field(c.head + 5u, 28u, 4u);
  let bit = c.normal_bit + vertex * (bits_a + bits_b);
  let scale = i32(c.normal_scale);
  var a = i32(lode_field(c.head + 5u, 0u, 14u) + lode_bits(c.page, bit, bits_a)) - scale;
  var b = i32(lode_field(c.head + 5u, 14u, 14u) + lode_bits(c.page, bit + bits_a, bits_b)) - scale;
  var z = scale - abs(a) - abs(b);
  if (z < 0) {
    let folded = select(scale - abs(b), abs(b) - scale, a < 0);
    b = select(scale - abs(a), abs(a) - scale, b < 0);
    a = folded;
  }
  let chart = lode_field(c.head + 1u, 29u, 3u);
  if ((chart & 1u) != 0u) { z = -z; }
  if (chart < 2u) { return vec3i(z, a, b); }
  if (chart < 4u) { return vec3i(b, z, a); }
  return vec3i(a, b, z);
}

fn lode_fit(word: u32, raw: vec3u, shift: u32) -> i32 {
  let r = vec3i(raw);
  return (lode_signed_field(word, 0u, 10u) * r.x + lode_signed_field(word, 10u, 10u) * r.y + lode_signed_field(word, 20u, 10u) * r.z) >> shift;
}

// Of the stored set k < uv_set_count. `raw` is lode_raw_position of the same vertex.
fn lode_uv(c: LodeCluster, k: u32, vertex: u32, raw: vec3u) -> vec2i {
  var word = c.uv_word[k];
  var bit = c.uv_bit[k];
  var rest = vertex;
  loop {
    let count = lode_field(word, 0u, 8u) + 1u;
    let bits_u = lode_field(word, 8u, 5u);
    let bits_v = lode_field(word, 13u, 5u);
    let has_fit = lode_field(word, 28u, 1u) != 0u;
    if (rest < count) {
      bit += rest * (bits_u + bits_v);
      var uv = vec2i(bitcast<i32>(lode_word(word + 1u)), bitcast<i32>(lode_word(word + 2u))) +
               vec2i(i32(lode_bits(c.page, bit, bits_u)), i32(lode_bits(c.page, bit + bits_u, bits_v)));
      if (has_fit) {
        uv += vec2i(lode_fit(word + 3u, raw, lode_field(word, 18u, 5u)), lode_fit(word + 4u, raw, lode_field(word, 23u, 5u)));
      }
      return uv;
    }
    rest -= count;
    bit += count * (bits_u + bits_v);
    word += select(3u, 5u, has_fit);
  }
}

// 0 … 255 each. Only where the mesh has colours.
fn lode_color(c: LodeCluster, vertex: u32) -> vec4u {
  var row = 0u;
  for (var k = 0u; k < 4u; k++) { row += lode_field(c.color_word + 1u, 4u * k, 4u); }
  var bit = c.color_bit + vertex * row;
  var color: vec4u;
  for (var k = 0u; k < 4u; k++) {
    let bits = lode_field(c.color_word + 1u, 4u * k, 4u);
    color[k] = lode_field(c.color_word, 8u * k, 8u) + lode_bits(c.page, bit, bits);
    bit += bits;
  }
  return color;
}

// The vertex that a slot of the strips names.
fn lode_slot(c: LodeCluster, slot: u32) -> u32 {
  let fresh = lode_count_ones(c.page, c.fresh_bit, slot);
  if (lode_bits(c.page, c.fresh_bit + slot, 1u) != 0u) { return fresh; }
  return fresh - 1u - lode_bits(c.page, c.reference_bit + (slot - fresh) * c.reference_bits, c.reference_bits);
}

// The slots of a triangle's corners, counter-clockwise; the vertex of each is lode_slot().
fn lode_triangle_slots(c: LodeCluster, triangle: u32) -> vec3u {
  var strip = 0u;
  var first = 0u;
  while (strip + 1u < c.strip_count) {
    let next = lode_bits(c.page, c.restart_bit + strip * c.restart_bits, c.restart_bits);
    if (next > triangle) { break; }
    first = next;
    strip++;
  }
  let base = 2u * strip + 2u;  // the last corner of triangle t is in slot t + base
  var p = triangle + base - 1u;
  var q = p;
  if (lode_bits(c.page, c.turn_bit + triangle, 1u) == 0u) {
    let turn = lode_find_last(c.page, c.turn_bit, first + 1u, max(triangle, first + 1u), true, LODE_NONE);
    p = select(turn + base - 1u, first + base - 2u, turn == LODE_NONE);
  } else {
    q = lode_find_last(c.page, c.turn_bit, first, triangle, false, first) + base - 1u;
  }
  return vec3u(p, q, triangle + base);
}
fn lode_triangle(c: LodeCluster, triangle: u32) -> vec3u {
  let slots = lode_triangle_slots(c, triangle);
  return vec3u(lode_slot(c, slots.x), lode_slot(c, slots.y), lode_slot(c, slots.z));
}

// Into the asset's materials.
fn lode_material(c: LodeCluster, triangle: u32) -> u32 {
  if (c.material != LODE_NONE) { return c.material; }
  var word = c.material_word;
  for (var covered = lode_field(word, 0u, 8u) + 1u; covered <= triangle;) {
    word++;
    covered += lode_field(word, 0u, 8u) + 1u;
  }
  return lode_field(word, 8u, 24u);
}
