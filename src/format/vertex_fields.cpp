// SPDX-License-Identifier: MIT
#include "format/vertex_fields.h"

namespace meshlode::format {

namespace {

/// All arithmetic of the format is modulo 2^32, >> is arithmetic.
std::uint32_t shift_right(std::uint32_t value, std::uint32_t bits) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(value) >> bits);
}
std::uint32_t product(std::int32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>(a) * b;
}
std::uint32_t absolute(std::uint32_t value) {
  return value >> 31U != 0 ? 0U - value : value;
}
std::uint32_t with_sign(std::uint32_t magnitude, std::uint32_t sign) {
  return sign >> 31U != 0 ? 0U - magnitude : magnitude;
}

std::uint32_t shear(const ClusterLayout& layout, const std::uint32_t* raw) {
  const std::uint32_t u = raw[layout.shear_axis == 0 ? 1 : 0];
  const std::uint32_t v = raw[layout.shear_axis == 2 ? 1 : 2];
  return shift_right(product(layout.shear_u, u) + product(layout.shear_v, v), kShearShift);
}

std::uint32_t uv_fit(const UvRangeFields& range, std::size_t side, const std::uint32_t* raw) {
  const std::int32_t* slope = range.slope[side];
  return shift_right(product(slope[0], raw[0]) + product(slope[1], raw[1]) + product(slope[2], raw[2]),
                     range.shift[side]);
}

const UvRangeFields& range_of_vertex(const FieldContext& context, const ClusterFields& cluster, std::uint32_t set,
                                     std::uint32_t vertex) {
  std::uint32_t range = cluster.first_range[set];
  while (context.ranges[range].end_vertex <= vertex) ++range;
  return context.ranges[range];
}

/// Another pole and the same point: the map is its own inverse but for the offset by M.
void unfold_far_half(std::uint32_t a, std::uint32_t b, std::uint32_t scale, std::uint32_t& out_a,
                     std::uint32_t& out_b) {
  out_a = with_sign(scale - absolute(b), a);
  out_b = with_sign(scale - absolute(a), b);
}

}  // namespace

void read_cluster_fields(const MeshRecord& mesh, const std::uint32_t* page, ClusterFields& fields,
                         std::vector<UvRangeFields>& ranges) {
  namespace f = format::uv_range;
  const ClusterLayout& layout = fields.layout;
  const auto get = [](const std::uint32_t* words, BitField field) {
    return static_cast<std::uint32_t>(get_field(words, field));
  };
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    fields.first_range[set] = static_cast<std::uint32_t>(ranges.size());
    const std::uint32_t* word = page + layout.uv_word[set];
    std::uint32_t vertex = 0;
    std::uint32_t bit = layout.uv_bit[set];
    for (std::uint32_t i = 0; i < layout.uv_range_count[set]; ++i) {
      UvRangeFields range;
      const std::uint32_t count = get(word, f::kVerticesLess1) + 1U;
      range.bits[0] = get(word, f::kBitsU);
      range.bits[1] = get(word, f::kBitsV);
      range.minimum[0] = get(word, f::kMinimumU);
      range.minimum[1] = get(word, f::kMinimumV);
      range.shift[0] = get(word, f::kShiftU);
      range.shift[1] = get(word, f::kShiftV);
      const bool has_fit = get(word, f::kHasFit) != 0;
      for (std::size_t k = 0; has_fit && k < 3; ++k) {
        range.slope[0][k] = get_field(word, f::kFitU[k]);
        range.slope[1][k] = get_field(word, f::kFitV[k]);
      }
      range.first_vertex = vertex;
      range.end_vertex = vertex += count;
      range.first_bit = bit;
      bit += count * (range.bits[0] + range.bits[1]);
      word += f::kWords + (has_fit ? f::kFitWords : 0U);
      ranges.push_back(range);
    }
  }
  if (mesh.has_color != 0) {
    for (std::size_t k = 0; k < 4; ++k) {
      fields.color_bits[k] = get(page + layout.color_word, color_range::kBits[k]);
      fields.color_minimum[k] = get(page + layout.color_word, color_range::kMinimum[k]);
    }
  }
}

RawVertex first_field_bits(const FieldContext& context, const ClusterFields& cluster) {
  const MeshRecord& mesh = context.mesh;
  RawVertex bits{};
  std::size_t at = 0;
  for (const std::uint32_t b : cluster.layout.bits) bits[at++] = b;
  if (mesh.normal_mode == NormalMode::kStored) {
    for (const std::uint32_t b : cluster.layout.normal_bits) bits[at++] = b;
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    for (const std::uint32_t b : context.ranges[cluster.first_range[set]].bits) bits[at++] = b;
  }
  if (mesh.has_color != 0) {
    for (const std::uint32_t b : cluster.color_bits) bits[at++] = b;
  }
  return bits;
}

void read_raw_vertex(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex, RawVertex& raw) {
  const MeshRecord& mesh = context.mesh;
  const ClusterLayout& layout = cluster.layout;
  std::size_t field = 0;
  const auto take = [&](std::uint32_t bit, std::uint32_t count) {
    raw[field++] = get_bits(context.page, bit, count);
    return bit + count;
  };
  std::uint32_t bit = layout.position_bit + vertex * (layout.bits[0] + layout.bits[1] + layout.bits[2]);
  for (const std::uint32_t bits : layout.bits) bit = take(bit, bits);
  if (mesh.normal_mode == NormalMode::kStored) {
    bit = layout.normal_bit + vertex * (layout.normal_bits[0] + layout.normal_bits[1]);
    for (const std::uint32_t bits : layout.normal_bits) bit = take(bit, bits);
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    const UvRangeFields& range = range_of_vertex(context, cluster, set, vertex);
    bit = range.first_bit + (vertex - range.first_vertex) * (range.bits[0] + range.bits[1]);
    for (const std::uint32_t bits : range.bits) bit = take(bit, bits);
  }
  if (mesh.has_color != 0) {
    const std::uint32_t* const bits = cluster.color_bits;
    bit = layout.color_bit + vertex * (bits[0] + bits[1] + bits[2] + bits[3]);
    for (const std::uint32_t b : cluster.color_bits) bit = take(bit, b);
  }
}

void full_from_raw(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex,
                   const RawVertex& raw, FullVertex& full) {
  const MeshRecord& mesh = context.mesh;
  const ClusterLayout& layout = cluster.layout;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    full[axis] = static_cast<std::uint32_t>(layout.minimum[axis]) + raw[axis];
  }
  full[layout.shear_axis] += shear(layout, raw.data());
  std::size_t from = 3;
  std::size_t to = 3;
  if (mesh.normal_mode == NormalMode::kStored) {
    const auto scale = static_cast<std::uint32_t>(mesh.normal_scale);
    const std::uint32_t pole = layout.chart / 2;
    std::uint32_t a = static_cast<std::uint32_t>(layout.normal_minimum[0]) + raw[from++] - scale;
    std::uint32_t b = static_cast<std::uint32_t>(layout.normal_minimum[1]) + raw[from++] - scale;
    const std::uint32_t c = scale - absolute(a) - absolute(b);
    if (c >> 31U != 0) unfold_far_half(a, b, scale, a, b);
    full[to + pole] = layout.chart % 2 == 0 ? c : 0U - c;
    full[to + (pole + 1) % 3] = a;
    full[to + (pole + 2) % 3] = b;
    to += 3;
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    const UvRangeFields& range = range_of_vertex(context, cluster, set, vertex);
    for (std::size_t side = 0; side < 2; ++side) {
      full[to++] = range.minimum[side] + raw[from++] + uv_fit(range, side, raw.data());
    }
  }
  if (mesh.has_color != 0) {
    for (const std::uint32_t minimum : cluster.color_minimum) full[to++] = minimum + raw[from++];
  }
}

void raw_from_full(const FieldContext& context, const ClusterFields& cluster, std::uint32_t vertex,
                   const FullVertex& full, RawVertex& raw) {
  const MeshRecord& mesh = context.mesh;
  const ClusterLayout& layout = cluster.layout;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    raw[axis] = full[axis] - static_cast<std::uint32_t>(layout.minimum[axis]);
  }
  raw[layout.shear_axis] -= shear(layout, raw.data());
  std::size_t from = 3;
  std::size_t to = 3;
  if (mesh.normal_mode == NormalMode::kStored) {
    const auto scale = static_cast<std::uint32_t>(mesh.normal_scale);
    const std::uint32_t pole = layout.chart / 2;
    std::uint32_t a = full[from + (pole + 1) % 3];
    std::uint32_t b = full[from + (pole + 2) % 3];
    const std::uint32_t c = layout.chart % 2 == 0 ? full[from + pole] : 0U - full[from + pole];
    if (c >> 31U != 0) unfold_far_half(a, b, scale, a, b);
    raw[to++] = a + scale - static_cast<std::uint32_t>(layout.normal_minimum[0]);
    raw[to++] = b + scale - static_cast<std::uint32_t>(layout.normal_minimum[1]);
    from += 3;
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    const UvRangeFields& range = range_of_vertex(context, cluster, set, vertex);
    for (std::size_t side = 0; side < 2; ++side) {
      raw[to++] = full[from++] - range.minimum[side] - uv_fit(range, side, raw.data());
    }
  }
  if (mesh.has_color != 0) {
    for (const std::uint32_t minimum : cluster.color_minimum) raw[to++] = full[from++] - minimum;
  }
}

}  // namespace meshlode::format
