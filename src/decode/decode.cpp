// SPDX-License-Identifier: MIT
#include "decode/decode.h"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include <meshlode/page.h>

#include "decode/octahedral.h"

namespace meshlode {

namespace {

static_assert(std::endian::native == std::endian::little, "pages are read as they lie in memory");

using format::ClusterLayout;

/// Fields one after the other. A page ends with a word of its own, so that eight bytes can always be read.
class BitReader {
 public:
  BitReader(const std::uint32_t* words, std::uint32_t bit) : words_(words), bit_(bit) {}
  /// \pre count <= 32
  std::uint32_t take(std::uint32_t count) {
    std::uint64_t pair;
    std::memcpy(&pair, words_ + bit_ / 32, sizeof(pair));
    const auto value = static_cast<std::uint32_t>(pair >> bit_ % 32 & ((std::uint64_t{1} << count) - 1U));
    bit_ += count;
    return value;
  }

 private:
  const std::uint32_t* words_;
  std::uint32_t bit_;
};

std::int32_t wrap(std::uint32_t value) { return static_cast<std::int32_t>(value); }
std::uint32_t bits_of(std::int32_t value) { return static_cast<std::uint32_t>(value); }

/// Leaves the raw values behind: texture coordinates are predicted from them.
void decode_positions(const ClusterLayout& layout, const std::uint32_t* words, std::size_t stride, std::uint32_t* raw,
                      std::int32_t* out) {
  BitReader reader(words, layout.position_bit);
  const std::uint32_t axis = layout.shear_axis;
  const std::uint32_t u = axis == 0 ? 1 : 0;
  const std::uint32_t v = axis == 2 ? 1 : 2;
  for (std::uint32_t i = 0; i < layout.vertex_count; ++i, raw += 3, out += stride) {
    for (std::size_t k = 0; k < 3; ++k) {
      raw[k] = reader.take(layout.bits[k]);
      out[k] = wrap(bits_of(layout.minimum[k]) + raw[k]);
    }
    const std::int32_t shear =
        wrap(bits_of(layout.shear_u) * raw[u] + bits_of(layout.shear_v) * raw[v]) >> format::kShearShift;
    out[axis] = wrap(bits_of(out[axis]) + bits_of(shear));
  }
}

void decode_normals(const ClusterLayout& layout, const std::uint32_t* words, std::int32_t scale, std::size_t stride,
                    std::int32_t* out) {
  BitReader reader(words, layout.normal_bit);
  for (std::uint32_t i = 0; i < layout.vertex_count; ++i, out += stride) {
    const std::int32_t a = layout.normal_minimum[0] + wrap(reader.take(layout.normal_bits[0]));
    const std::int32_t b = layout.normal_minimum[1] + wrap(reader.take(layout.normal_bits[1]));
    const auto point = octahedral_point(a, b, layout.chart, scale);
    for (std::size_t k = 0; k < 3; ++k) out[k] = point[k];
  }
}

void decode_uvs(const ClusterLayout& layout, const std::uint32_t* words, std::uint32_t set, std::size_t stride,
                const std::uint32_t* raw, std::int32_t* out) {
  namespace f = format::uv_range;
  BitReader reader(words, layout.uv_bit[set]);
  const std::uint32_t* range = words + layout.uv_word[set];
  for (std::uint32_t r = 0; r < layout.uv_range_count[set]; ++r) {
    const auto get = [range](format::BitField field) { return bits_of(format::get_field(range, field)); };
    const std::uint32_t count = get(f::kVerticesLess1) + 1U;
    const std::uint32_t bits[2] = {get(f::kBitsU), get(f::kBitsV)};
    const std::uint32_t minimum[2] = {get(f::kMinimumU), get(f::kMinimumV)};
    if (get(f::kHasFit) != 0) {
      const std::uint32_t shift[2] = {get(f::kShiftU), get(f::kShiftV)};
      std::uint32_t slope[2][3];
      for (std::size_t k = 0; k < 3; ++k) {
        slope[0][k] = get(f::kFitU[k]);
        slope[1][k] = get(f::kFitV[k]);
      }
      for (std::uint32_t i = 0; i < count; ++i, raw += 3, out += stride) {
        for (std::size_t c = 0; c < 2; ++c) {
          const std::uint32_t sum = slope[c][0] * raw[0] + slope[c][1] * raw[1] + slope[c][2] * raw[2];
          out[c] = wrap(minimum[c] + reader.take(bits[c]) + bits_of(wrap(sum) >> shift[c]));
        }
      }
      range += f::kWords + f::kFitWords;
    } else {
      for (std::uint32_t i = 0; i < count; ++i, raw += 3, out += stride) {
        for (std::size_t c = 0; c < 2; ++c) out[c] = wrap(minimum[c] + reader.take(bits[c]));
      }
      range += f::kWords;
    }
  }
}

void decode_colors(const ClusterLayout& layout, const std::uint32_t* words, std::size_t stride, std::int32_t* out) {
  BitReader reader(words, layout.color_bit);
  const std::uint32_t* const range = words + layout.color_word;
  std::int32_t minimum[4];
  std::uint32_t bits[4];
  for (std::size_t k = 0; k < 4; ++k) {
    minimum[k] = format::get_field(range, format::color_range::kMinimum[k]);
    bits[k] = bits_of(format::get_field(range, format::color_range::kBits[k]));
  }
  for (std::uint32_t i = 0; i < layout.vertex_count; ++i, out += stride) {
    for (std::size_t k = 0; k < 4; ++k) out[k] = minimum[k] + wrap(reader.take(bits[k]));
  }
}

/// Slot by slot, keeping the edge that the next triangle enters by; docs/format.md says the same for one triangle alone.
void decode_topology(const ClusterLayout& layout, const std::uint32_t* words,
                     std::vector<std::array<std::uint8_t, 3>>& out) {
  BitReader turns(words, layout.turn_bit);
  BitReader fresh(words, layout.fresh_bit);
  BitReader restarts(words, layout.restart_bit);
  BitReader references(words, layout.reference_bit);
  std::uint32_t named = 0;
  const auto next_slot = [&]() -> std::uint8_t {
    if (fresh.take(1) != 0) return static_cast<std::uint8_t>(named++);
    return static_cast<std::uint8_t>(named - 1U - references.take(layout.reference_bits));
  };
  std::uint32_t strips_left = layout.strip_count - 1;
  std::uint32_t next_start = 0;
  std::uint8_t p = 0;
  std::uint8_t q = 0;
  std::uint8_t newest = 0;
  out.resize(layout.triangle_count);
  for (std::uint32_t t = 0; t < layout.triangle_count; ++t) {
    const bool turns_right = turns.take(1) != 0;
    if (t == next_start) {
      p = next_slot();
      q = next_slot();
      if (strips_left > 0) {
        next_start = restarts.take(layout.restart_bits);
        --strips_left;
      }
    } else {
      (turns_right ? p : q) = newest;
    }
    newest = next_slot();
    out[t] = {p, q, newest};
  }
}

void decode_materials(const format::MeshRecord& mesh, const ClusterLayout& layout, const std::uint32_t* words,
                      std::vector<std::uint32_t>& out) {
  out.clear();
  if (mesh.material != format::kNone) out.assign(layout.triangle_count, mesh.material);
  for (std::uint32_t r = 0; r < layout.material_count; ++r) {
    const std::uint32_t* const range = words + layout.material_word + std::size_t{r} * format::material_range::kWords;
    out.insert(out.end(), bits_of(format::get_field(range, format::material_range::kTrianglesLess1)) + 1U,
               bits_of(format::get_field(range, format::material_range::kMaterial)));
  }
}

}  // namespace

Vec3f octahedral_normal(const std::array<std::int32_t, 3>& point) {
  const double x = point[0];
  const double y = point[1];
  const double z = point[2];
  const double length = std::sqrt(x * x + y * y + z * z);  // the sum of squares is an integer: exact
  return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

void decode_cluster(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out) {
  const std::span<const std::uint32_t> words = page.words();
  const format::MeshRecord& mesh = asset.meshes()[asset.groups()[asset.clusters()[cluster.value].coarser_group].mesh];
  assert(cluster.value >= words[0] && cluster.value - words[0] < words[1]);
  ClusterLayout layout;
  [[maybe_unused]] const char* const wrong = format::read_cluster_layout(mesh, words, cluster.value - words[0], layout);
  assert(wrong == nullptr);  // load_page has looked at every cluster

  const std::size_t stride = format::channel_count(mesh);
  out.vertex_count = layout.vertex_count;
  out.triangle_count = layout.triangle_count;
  out.channel_count = static_cast<std::uint32_t>(stride);
  out.channels.resize(layout.vertex_count * stride);
  std::array<std::uint32_t, 3 * format::kMaxClusterVertices> raw;
  std::int32_t* channel = out.channels.data();
  decode_positions(layout, words.data(), stride, raw.data(), channel);
  channel += 3;
  if (mesh.normal_mode == format::NormalMode::kStored) {
    decode_normals(layout, words.data(), static_cast<std::int32_t>(mesh.normal_scale), stride, channel);
    channel += 3;
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set, channel += 2) {
    decode_uvs(layout, words.data(), set, stride, raw.data(), channel);
  }
  if (mesh.has_color != 0) decode_colors(layout, words.data(), stride, channel);
  decode_topology(layout, words.data(), out.triangles);
  decode_materials(mesh, layout, words.data(), out.triangle_material);
}

void decode_attributes(const format::MeshRecord& mesh, const DecodedCluster& cluster, ClusterAttributes& out) {
  const std::size_t count = cluster.vertex_count;
  const bool has_normal = mesh.normal_mode == format::NormalMode::kStored;
  out.positions.resize(count);
  out.normals.resize(has_normal ? count : 0);
  for (std::uint32_t set = 0; set < format::kMaxUvSets; ++set) out.uvs[set].resize(set < mesh.uv_set_count ? count : 0);
  out.colors.resize(mesh.has_color != 0U ? count : 0);

  // mantissa · q has at most 49 bits and the power of two is exact, so this product of doubles is exact; the one
  // rounding is to float, and it too is exact while |mantissa · q| < 2^24.
  const double step = std::ldexp(1.0, mesh.grid.log2) * mesh.grid.mantissa;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t* value = &cluster.channels[i * cluster.channel_count];
    for (int axis = 0; axis < 3; ++axis) out.positions[i][axis] = static_cast<float>(step * *value++);
    if (has_normal) {
      out.normals[i] = octahedral_normal({value[0], value[1], value[2]});
      value += 3;
    }
    for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
      const double uv_step = std::ldexp(1.0, mesh.uv_log2[set]);
      out.uvs[set][i] = {static_cast<float>(uv_step * value[0]), static_cast<float>(uv_step * value[1])};
      value += 2;
    }
    if (mesh.has_color != 0U) {
      for (int k = 0; k < 4; ++k) out.colors[i][k] = static_cast<float>(value[k]) / 255.0F;
    }
  }
}

Result<std::vector<DecodedCluster>> decode_all(const Asset& asset) {
  std::vector<DecodedCluster> clusters(asset.clusters().size());
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const auto page = load_page(asset, PageId{p});
    if (!page) return page.error();
    const format::PageRecord& record = asset.pages()[p];
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      const ClusterId id{record.first_cluster + i};
      decode_cluster(asset, *page, id, clusters[id.value]);
    }
  }
  return clusters;
}

}  // namespace meshlode
