// SPDX-License-Identifier: MIT
// Reads clusters out of a page as it lies in the file (docs/format.md). The only shader text that knows the page layout.

struct ClusterData {
  uint page;            // word index of the page
  uint vertex_count, triangle_count, range_count;
  uint vertex_bits;
  uint channels;        // word index of the channel table
  uint ranges;          // of the material ranges
  uint vertices;        // of the vertex bit stream
  uint triangles;       // of the triangle bytes
  uint position_minimum_x, position_minimum_y, position_minimum_z;
  uint bits_x, bits_y, bits_z;
};

uint page_word(uint at) { return frame.pages.at[at]; }

// `count` bits from bit `bit` of the stream at word `stream`. \pre count <= 25; a word behind the last is readable
uint page_bits(uint stream, uint bit, uint count) {
  const uint at = stream + (bit >> 5u);
  const uint shift = bit & 31u;
  uint value = page_word(at) >> shift;
  if (shift + count > 32u) value |= page_word(at + 1u) << (32u - shift);
  return value & ((1u << count) - 1u);
}

ClusterData open_cluster(GpuMesh mesh, uint page, uint cluster) {
  ClusterData c;
  c.page = page;
  const uint head = page + (page_word(page + 2u + cluster - page_word(page)) >> 2u);
  const uint counts = page_word(head);
  const uint more = page_word(head + 1u);
  c.vertex_count = counts & 0xFFFFu;
  c.triangle_count = counts >> 16u;
  c.range_count = more >> 16u;
  c.vertex_bits = page_word(head + 2u);
  c.vertices = page + (page_word(head + 3u) >> 2u);
  c.triangles = page + (page_word(head + 4u) >> 2u);
  c.channels = head + 5u;
  c.ranges = c.channels + 2u * (more & 0xFFFFu);
  c.position_minimum_x = page_word(c.channels);
  c.bits_x = page_word(c.channels + 1u);
  c.position_minimum_y = page_word(c.channels + 2u);
  c.bits_y = page_word(c.channels + 3u);
  c.position_minimum_z = page_word(c.channels + 4u);
  c.bits_z = page_word(c.channels + 5u);
  return c;
}

ivec3 cluster_position(ClusterData c, uint vertex) {
  const uint bit = vertex * c.vertex_bits;
  const uint x = page_bits(c.vertices, bit, c.bits_x);
  const uint y = page_bits(c.vertices, bit + c.bits_x, c.bits_y);
  const uint z = page_bits(c.vertices, bit + c.bits_x + c.bits_y, c.bits_z);
  return ivec3(int(c.position_minimum_x + x), int(c.position_minimum_y + y), int(c.position_minimum_z + z));
}

// Any channel of a vertex, in the order of format::MeshRecord.
int cluster_channel(ClusterData c, uint vertex, uint channel) {
  uint bit = vertex * c.vertex_bits;
  for (uint i = 0u; i < channel; ++i) bit += page_word(c.channels + 2u * i + 1u);
  return int(page_word(c.channels + 2u * channel) +
             page_bits(c.vertices, bit, page_word(c.channels + 2u * channel + 1u)));
}

uvec3 cluster_triangle(ClusterData c, uint triangle) {
  const uint byte = 3u * triangle;
  const uint at = c.triangles + (byte >> 2u);
  const uint shift = 8u * (byte & 3u);
  uint value = page_word(at) >> shift;
  if (shift > 8u) value |= page_word(at + 1u) << (32u - shift);
  return uvec3(value & 255u, (value >> 8u) & 255u, (value >> 16u) & 255u);
}

uint cluster_material(ClusterData c, uint triangle) {
  uint first = 0u;
  for (uint r = 0u; r + 1u < c.range_count; ++r) {
    first += page_word(c.ranges + 2u * r + 1u);
    if (triangle < first) return page_word(c.ranges + 2u * r);
  }
  return page_word(c.ranges + 2u * (c.range_count - 1u));
}
