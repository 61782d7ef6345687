// SPDX-License-Identifier: MIT
// A cluster's topology in shared memory, by a whole workgroup: every slot of the strips is resolved once, and a triangle is
// found without walking along its strip. The same corners as lode_triangle(), which one invocation can call alone
// (docs/reference/format.md, section 13).
//
// Before including: kMaxTriangles of a cluster. The cluster's bits go by LodeCluster of <meshlode/decode.glsl>.

const uint kMaxSlots = 3u * kMaxTriangles;  // a strip of one triangle has three
const uint kSlotWords = (kMaxSlots + 31u) / 32u;

shared uint strip_turns[8], strip_starts[8], strips_before[8];
shared uint fresh_words[kSlotWords], fresh_before[kSlotWords];
shared uint slot_vertex[kMaxSlots];

uint bits_below(uint bit) { return (1u << bit) - 1u; }  // bit < 32

// Three steps with a barrier() behind each; all invocations call them. What else has to be done goes between.
void begin_strips(LodeCluster c, uint lane, uint lanes) {
  for (uint i = lane; i < 8u; i += lanes) {
    const uint first = 32u * i;
    strip_starts[i] = i == 0u ? 1u : 0u;
    strip_turns[i] = first < c.triangle_count
                         ? lode_mask(c.page, c.turn_bit + first, min(c.triangle_count - first, 32u)) : 0u;
  }
  const uint slots = min(c.triangle_count + 2u * c.strip_count, kMaxSlots);
  for (uint i = lane; 32u * i < slots; i += lanes) {
    fresh_words[i] = lode_mask(c.page, c.fresh_bit + 32u * i, min(slots - 32u * i, 32u));
  }
}

void count_strips(LodeCluster c, uint lane, uint lanes) {
  for (uint k = lane; k + 1u < c.strip_count; k += lanes) {
    const uint first = lode_bits(c.page, c.restart_bit + k * c.restart_bits, c.restart_bits);
    atomicOr(strip_starts[first >> 5u & 7u], 1u << (first & 31u));
  }
  const uint slots = min(c.triangle_count + 2u * c.strip_count, kMaxSlots);
  for (uint i = lane; 32u * i < slots; i += lanes) {
    uint ones = 0u;
    for (uint j = 0u; j < i; ++j) ones += uint(bitCount(fresh_words[j]));
    fresh_before[i] = ones;
  }
}

void resolve_slots(LodeCluster c, uint lane, uint lanes) {
  for (uint i = lane; i < 8u; i += lanes) {
    uint ones = 0u;
    for (uint j = 0u; j < i; ++j) ones += uint(bitCount(strip_starts[j]));
    strips_before[i] = ones;
  }
  const uint slots = min(c.triangle_count + 2u * c.strip_count, kMaxSlots);
  for (uint s = lane; s < slots; s += lanes) {
    const uint word = fresh_words[s >> 5u], bit = s & 31u;
    const uint fresh = fresh_before[s >> 5u] + uint(bitCount(word & bits_below(bit)));
    uint vertex = fresh;
    if ((word >> bit & 1u) == 0u) {
      vertex = fresh - 1u - lode_bits(c.page, c.reference_bit + (s - fresh) * c.reference_bits, c.reference_bits);
    }
    slot_vertex[s] = min(vertex, c.vertex_count - 1u);
  }
}

// The last i in [first, end) whose turn is `value`, or `none`. \pre first < 256, end <= 256
uint last_turn(uint first, uint end, bool value, uint none) {
  while (end > first) {
    const uint word = (end - 1u) >> 5u;
    const uint low = max(first, 32u * word) & 31u;
    uint mask = value ? strip_turns[word] : ~strip_turns[word];
    mask &= (0xFFFFFFFFu << low) & (0xFFFFFFFFu >> (31u - ((end - 1u) & 31u)));
    if (mask != 0u) return 32u * word + uint(findMSB(mask));
    end = 32u * word;
  }
  return none;
}

// The corners of a triangle, counter-clockwise.
uvec3 strip_triangle(uint triangle) {
  uint word = triangle >> 5u;
  uint starts = strip_starts[word] & (0xFFFFFFFFu >> (31u - (triangle & 31u)));
  const uint strip = strips_before[word] + uint(bitCount(starts)) - 1u;
  while (starts == 0u && word > 0u) starts = strip_starts[--word];
  const uint first = 32u * word + uint(findMSB(starts));  // bit 0 of word 0 is always set
  const uint base = 2u * strip + 2u;                      // the last corner of triangle t is in slot t + base
  uint p = triangle + base - 1u, q = p;
  if ((strip_turns[triangle >> 5u] >> (triangle & 31u) & 1u) == 0u) {
    const uint turn = last_turn(first + 1u, max(triangle, first + 1u), true, kNone);
    p = turn == kNone ? first + base - 2u : turn + base - 1u;
  } else {
    q = last_turn(first, triangle, false, first) + base - 1u;
  }
  const uint last = kMaxSlots - 1u;
  return uvec3(slot_vertex[min(p, last)], slot_vertex[min(q, last)], slot_vertex[min(triangle + base, last)]);
}
