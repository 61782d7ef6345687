// SPDX-License-Identifier: MIT
// A cluster of a decoded page, read as it lies in a buffer of 32-bit words (docs/reference/format.md, sections 12 and 13): any vertex
// and any triangle alone, in one thread, to the same integers as on the CPU (I9). GLSL 4.5, integers only.
//
// Before including: #define LODE_WORD(i) … - word i of whatever holds the page; i is counted from where the caller says
// the page starts. Words up to and with the page's last (zero) one are read, for any sound page.
//
//   LodeMesh mesh = …;                                 // from MeshRecord: the four numbers below
//   LodeCluster c = lode_read_cluster(mesh, page_word, cluster - first cluster of the page);
//   uvec3 raw = lode_raw_position(c, v);               // v < c.vertex_count
//   ivec3 q = lode_position(c, raw);                   // grid units
//   ivec2 uv = lode_uv(c, 0u, v, raw);                 // units of 2^uv_log2[0]
//   uvec3 corners = lode_triangle(c, t);               // t < c.triangle_count: vertices of the cluster
#ifndef MESHLODE_DECODE_GLSL
#define MESHLODE_DECODE_GLSL

const uint kLodeNone = 0xFFFFFFFFu;
const uint kLodeShearShift = 7u;
const uint kLodeMaxUvSets = 4u;

struct LodeMesh {
  uint normal_scale;  // 0: no normals are stored
  uint uv_set_count;
  uint has_color;
  uint material;      // kLodeNone: the clusters say
};

// Words are counted from the start of LODE_WORD, bits from the start of the page.
struct LodeCluster {
  uint page;
  uint vertex_count;
  uint triangle_count;
  uint head;
  uint normal_scale;
  uint uv_set_count;
  uint material;
  uint material_word;
  uint uv_word[4];     // first UV range of each set
  uint uv_bit[4];
  uint color_word;
  uint position_bit;
  uint normal_bit;
  uint color_bit;
  uint turn_bit;
  uint fresh_bit;
  uint restart_bit;
  uint reference_bit;
  uint strip_count;
  uint restart_bits;
  uint reference_bits;
};

uint lode_field(uint word, uint shift, uint bits) { return bitfieldExtract(LODE_WORD(word), int(shift), int(bits)); }
int lode_signed_field(uint word, uint shift, uint bits) {
  return bitfieldExtract(int(LODE_WORD(word)), int(shift), int(bits));
}

// `count` <= 25 bits from `bit` of the page.
uint lode_bits(uint page, uint bit, uint count) {
  uint shift = bit & 31u;
  uint low = LODE_WORD(page + (bit >> 5)) >> shift;
  uint high = shift == 0u ? 0u : LODE_WORD(page + (bit >> 5) + 1u) << (32u - shift);
  return (low | high) & ((1u << count) - 1u);
}

// Ones in the `count` <= 32 bits from `bit`, and in any range of them.
uint lode_mask(uint page, uint bit, uint count) {
  uint shift = bit & 31u;
  uint low = LODE_WORD(page + (bit >> 5)) >> shift;
  uint high = shift == 0u ? 0u : LODE_WORD(page + (bit >> 5) + 1u) << (32u - shift);
  return count >= 32u ? low | high : (low | high) & ((1u << count) - 1u);
}
uint lode_count_ones(uint page, uint bit, uint count) {
  uint ones = 0u;
  for (uint done = 0u; done < count; done += 32u) {
    ones += uint(bitCount(lode_mask(page, bit + done, min(count - done, 32u))));
  }
  return ones;
}

// The last i in [first, end) whose bit (bit + i) equals `value`, or `none`.
uint lode_find_last(uint page, uint bit, uint first, uint end, bool value, uint none) {
  while (end > first) {
    uint count = min(end - first, 32u);
    uint mask = lode_mask(page, bit + end - count, count);
    if (!value) mask = ~mask & (count >= 32u ? 0xFFFFFFFFu : (1u << count) - 1u);
    if (mask != 0u) return end - count + uint(findMSB(mask));
    end -= count;
  }
  return none;
}

LodeCluster lode_read_cluster(LodeMesh mesh, uint page_word, uint index) {
  LodeCluster c;
  bool has_normal = mesh.normal_scale != 0u;
  uint head = page_word + 2u + index * (has_normal ? 6u : 5u);
  c.page = page_word;
  c.head = head;
  c.uv_set_count = mesh.uv_set_count;
  c.normal_scale = mesh.normal_scale;
  c.material = mesh.material;
  c.vertex_count = lode_field(head, 0u, 8u) + 1u;
  c.triangle_count = lode_field(head, 8u, 8u) + 1u;
  uint position_bits = lode_field(head + 1u, 24u, 5u) + lode_field(head + 2u, 24u, 5u) + lode_field(head + 3u, 24u, 5u);
  uint normal_bits = has_normal ? lode_field(head + 4u, 28u, 4u) + lode_field(head + 5u, 28u, 4u) : 0u;
  c.strip_count = lode_field(head + 4u, 16u, 8u) + 1u;
  c.reference_bits = lode_field(head + 4u, 24u, 4u);
  c.restart_bits = uint(findMSB(c.triangle_count - 1u) + 1);

  uint word = page_word + lode_field(head, 16u, 16u);
  c.material_word = word;
  if (mesh.material == kLodeNone) {
    for (uint covered = 0u; covered < c.triangle_count; ++word) covered += lode_field(word, 0u, 8u) + 1u;
  }
  uint uv_bits[4];
  for (uint set = 0u; set < kLodeMaxUvSets; ++set) {
    c.uv_word[set] = word;
    uv_bits[set] = 0u;
    if (set >= mesh.uv_set_count) continue;
    for (uint covered = 0u; covered < c.vertex_count;) {
      uint count = lode_field(word, 0u, 8u) + 1u;
      covered += count;
      uv_bits[set] += count * (lode_field(word, 8u, 5u) + lode_field(word, 13u, 5u));
      word += lode_field(word, 28u, 1u) != 0u ? 5u : 3u;
    }
  }
  c.color_word = word;
  uint color_bits = 0u;
  if (mesh.has_color != 0u) {
    for (uint k = 0u; k < 4u; ++k) color_bits += lode_field(word + 1u, 4u * k, 4u);
    word += 2u;
  }

  uint bit = 32u * (word - page_word);
  c.position_bit = bit;
  bit += c.vertex_count * position_bits;
  c.normal_bit = bit;
  bit += c.vertex_count * normal_bits;
  for (uint set = 0u; set < kLodeMaxUvSets; ++set) {
    c.uv_bit[set] = bit;
    bit += uv_bits[set];
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

uvec3 lode_raw_position(LodeCluster c, uint vertex) {
  uint bits_x = lode_field(c.head + 1u, 24u, 5u);
  uint bits_y = lode_field(c.head + 2u, 24u, 5u);
  uint bits_z = lode_field(c.head + 3u, 24u, 5u);
  uint bit = c.position_bit + vertex * (bits_x + bits_y + bits_z);
  return uvec3(lode_bits(c.page, bit, bits_x), lode_bits(c.page, bit + bits_x, bits_y), lode_bits(c.page, bit + bits_x + bits_y, bits_z));
}

ivec3 lode_position(LodeCluster c, uvec3 raw) {
  ivec3 q = ivec3(raw) + ivec3(lode_signed_field(c.head + 1u, 0u, 24u), lode_signed_field(c.head + 2u, 0u, 24u),
                               lode_signed_field(c.head + 3u, 0u, 24u));
  uint axis = lode_field(c.head + 2u, 29u, 2u);
  uint u = axis == 0u ? raw.y : raw.x;
  uint v = axis == 2u ? raw.y : raw.z;
  int shear = int(uint(lode_signed_field(c.head + 4u, 0u, 8u)) * u + uint(lode_signed_field(c.head + 4u, 8u, 8u)) * v) >>
              int(kLodeShearShift);
  if (axis == 0u) q.x += shear;
  else if (axis == 1u) q.y += shear;
  else q.z += shear;
  return q;
}

// The point (X, Y, Z) with |X| + |Y| + |Z| = normal_scale whose direction is the normal.
ivec3 lode_normal(LodeCluster c, uint vertex) {
  uint bits_a = lode_field(c.head + 4u, 28u, 4u);
  uint bits_b = lode_field(c.head + 5u, 28u, 4u);
  uint bit = c.normal_bit + vertex * (bits_a + bits_b);
  int scale = int(c.normal_scale);
  int a = int(lode_field(c.head + 5u, 0u, 14u) + lode_bits(c.page, bit, bits_a)) - scale;
  int b = int(lode_field(c.head + 5u, 14u, 14u) + lode_bits(c.page, bit + bits_a, bits_b)) - scale;
  int z = scale - abs(a) - abs(b);
  if (z < 0) {
    int folded = a < 0 ? abs(b) - scale : scale - abs(b);
    b = b < 0 ? abs(a) - scale : scale - abs(a);
    a = folded;
  }
  uint chart = lode_field(c.head + 1u, 29u, 3u);
  if ((chart & 1u) != 0u) z = -z;
  return chart < 2u ? ivec3(z, a, b) : chart < 4u ? ivec3(b, z, a) : ivec3(a, b, z);
}

int lode_fit(uint word, uvec3 raw, uint shift) {
  return int(uint(lode_signed_field(word, 0u, 10u)) * raw.x + uint(lode_signed_field(word, 10u, 10u)) * raw.y +
             uint(lode_signed_field(word, 20u, 10u)) * raw.z) >> int(shift);
}

// `raw` is lode_raw_position of the same vertex. set < uv_set_count
ivec2 lode_uv(LodeCluster c, uint set, uint vertex, uvec3 raw) {
  uint word = c.uv_word[set];
  uint bit = c.uv_bit[set];
  while (true) {
    uint count = lode_field(word, 0u, 8u) + 1u;
    uint bits_u = lode_field(word, 8u, 5u);
    uint bits_v = lode_field(word, 13u, 5u);
    bool has_fit = lode_field(word, 28u, 1u) != 0u;
    if (vertex < count) {
      bit += vertex * (bits_u + bits_v);
      ivec2 uv = ivec2(LODE_WORD(word + 1u), LODE_WORD(word + 2u)) +
                 ivec2(lode_bits(c.page, bit, bits_u), lode_bits(c.page, bit + bits_u, bits_v));
      if (has_fit) {
        uv += ivec2(lode_fit(word + 3u, raw, lode_field(word, 18u, 5u)),
                    lode_fit(word + 4u, raw, lode_field(word, 23u, 5u)));
      }
      return uv;
    }
    vertex -= count;
    bit += count * (bits_u + bits_v);
    word += has_fit ? 5u : 3u;
  }
}

// 0 … 255 each. Only where the mesh has colours.
uvec4 lode_color(LodeCluster c, uint vertex) {
  uint row = 0u;
  for (uint k = 0u; k < 4u; ++k) row += lode_field(c.color_word + 1u, 4u * k, 4u);
  uint bit = c.color_bit + vertex * row;
  uvec4 color;
  for (uint k = 0u; k < 4u; ++k) {
    uint bits = lode_field(c.color_word + 1u, 4u * k, 4u);
    color[k] = lode_field(c.color_word, 8u * k, 8u) + lode_bits(c.page, bit, bits);
    bit += bits;
  }
  return color;
}

// The vertex that a slot of the strips names.
uint lode_slot(LodeCluster c, uint slot) {
  uint fresh = lode_count_ones(c.page, c.fresh_bit, slot);
  if (lode_bits(c.page, c.fresh_bit + slot, 1u) != 0u) return fresh;
  return fresh - 1u - lode_bits(c.page, c.reference_bit + (slot - fresh) * c.reference_bits, c.reference_bits);
}

// The corners of a triangle, counter-clockwise.
uvec3 lode_triangle(LodeCluster c, uint triangle) {
  uint strip = 0u;
  uint first = 0u;
  while (strip + 1u < c.strip_count) {
    uint next = lode_bits(c.page, c.restart_bit + strip * c.restart_bits, c.restart_bits);
    if (next > triangle) break;
    first = next;
    ++strip;
  }
  uint base = 2u * strip + 2u;  // the last corner of triangle t is in slot t + base
  uint p;
  uint q;
  if (lode_bits(c.page, c.turn_bit + triangle, 1u) == 0u) {
    q = triangle + base - 1u;
    uint turn = lode_find_last(c.page, c.turn_bit, first + 1u, max(triangle, first + 1u), true, kLodeNone);
    p = turn == kLodeNone ? first + base - 2u : turn + base - 1u;
  } else {
    p = triangle + base - 1u;
    q = lode_find_last(c.page, c.turn_bit, first, triangle, false, first) + base - 1u;
  }
  return uvec3(lode_slot(c, p), lode_slot(c, q), lode_slot(c, triangle + base));
}

// Into the asset's materials.
uint lode_material(LodeCluster c, uint triangle) {
  if (c.material != kLodeNone) return c.material;
  uint word = c.material_word;
  for (uint covered = lode_field(word, 0u, 8u) + 1u; covered <= triangle;) {
    ++word;
    covered += lode_field(word, 0u, 8u) + 1u;
  }
  return lode_field(word, 8u, 24u);
}

#endif
