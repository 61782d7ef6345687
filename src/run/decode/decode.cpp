// SPDX-License-Identifier: MIT
#include "run/decode/decode.h"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include <meshlode/page.h>

#include "base/byte_size.h"
#include "base/try.h"
#include "run/decode/octahedral.h"
#include "run/unpack/processor.h"

namespace meshlode::run {

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

std::int32_t wrap(std::uint32_t value) {
  return static_cast<std::int32_t>(value);
}
std::uint32_t bits_of(std::int32_t value) {
  return static_cast<std::uint32_t>(value);
}

std::uint64_t low_mask(std::uint32_t bits) {
  return (std::uint64_t{1} << bits) - 1U;
}

/// Calls use(i, first, second) with two fields of `bits` bits for each i below `count`. \pre each at most 32
template <class Use>
void each_pair(const std::uint32_t* words, std::uint32_t bit, const std::uint32_t* bits, std::uint32_t count, Use use) {
  const std::uint32_t first_bits = bits[0];
  const std::uint32_t all_bits = bits[0] + bits[1];
  const std::uint64_t first_mask = low_mask(bits[0]);
  const std::uint64_t second_mask = low_mask(bits[1]);
  if (all_bits > 32) {
    BitReader reader(words, bit);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t first = reader.take(bits[0]);
      use(i, first, reader.take(bits[1]));
    }
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i, bit += all_bits) {
    std::uint64_t pair;
    std::memcpy(&pair, words + bit / 32, sizeof(pair));
    pair >>= bit % 32;
    use(i, static_cast<std::uint32_t>(pair & first_mask), static_cast<std::uint32_t>(pair >> first_bits & second_mask));
  }
}

/// The shear axis as a constant, everything in registers: this is most of what decoding costs.
template <std::uint32_t kAxis>
void decode_sheared(const ClusterLayout& layout, const std::uint32_t* __restrict words, std::size_t stride,
                    std::uint32_t* __restrict raw, std::int32_t* __restrict out) {
  const std::uint32_t shear_u = bits_of(layout.shear_u);
  const std::uint32_t shear_v = bits_of(layout.shear_v);
  const std::uint32_t low_x = bits_of(layout.minimum[0]);
  const std::uint32_t low_y = bits_of(layout.minimum[1]);
  const std::uint32_t low_z = bits_of(layout.minimum[2]);
  const auto place = [=](std::uint32_t i, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::uint32_t u = kAxis == 0 ? y : x;
    const std::uint32_t v = kAxis == 2 ? y : z;
    const std::uint32_t shear = bits_of(wrap(shear_u * u + shear_v * v) >> format::kShearShift);
    std::uint32_t* const raw_at = raw + std::size_t{i} * 3;
    raw_at[0] = x;
    raw_at[1] = y;
    raw_at[2] = z;
    std::int32_t* const at = out + i * stride;
    at[0] = wrap(low_x + x + (kAxis == 0 ? shear : 0U));
    at[1] = wrap(low_y + y + (kAxis == 1 ? shear : 0U));
    at[2] = wrap(low_z + z + (kAxis == 2 ? shear : 0U));
  };
  const std::uint32_t x_bits = layout.bits[0];
  const std::uint32_t y_bits = layout.bits[1];
  const std::uint32_t z_bits = layout.bits[2];
  const std::uint32_t all_bits = x_bits + y_bits + z_bits;
  const std::uint32_t count = layout.vertex_count;
  if (all_bits > 32) {
    BitReader reader(words, layout.position_bit);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t x = reader.take(x_bits);
      const std::uint32_t y = reader.take(y_bits);
      place(i, x, y, reader.take(z_bits));
    }
    return;
  }
  const std::uint64_t x_mask = low_mask(x_bits);
  const std::uint64_t y_mask = low_mask(y_bits);
  const std::uint64_t z_mask = low_mask(z_bits);
  std::uint32_t bit = layout.position_bit;
  for (std::uint32_t i = 0; i < count; ++i, bit += all_bits) {
    std::uint64_t pair;
    std::memcpy(&pair, words + bit / 32, sizeof(pair));
    pair >>= bit % 32;
    place(i, static_cast<std::uint32_t>(pair & x_mask), static_cast<std::uint32_t>(pair >> x_bits & y_mask),
          static_cast<std::uint32_t>(pair >> (x_bits + y_bits) & z_mask));
  }
}

/// Leaves the raw values behind: texture coordinates are predicted from them.
void decode_positions(const ClusterLayout& layout, const std::uint32_t* words, std::size_t stride, std::uint32_t* raw,
                      std::int32_t* out) {
  switch (layout.shear_axis) {
    case 0: return decode_sheared<0>(layout, words, stride, raw, out);
    case 1: return decode_sheared<1>(layout, words, stride, raw, out);
    default: return decode_sheared<2>(layout, words, stride, raw, out);
  }
}

/// octahedral_point with its choices as masks, and the axes of the chart for all vertices at once.
void decode_normals(const ClusterLayout& layout, const std::uint32_t* words, std::int32_t scale, std::size_t stride,
                    std::int32_t* out) {
  const std::int32_t low_a = layout.normal_minimum[0] - scale;
  const std::int32_t low_b = layout.normal_minimum[1] - scale;
  const std::uint32_t pole = layout.chart / 2;
  const std::int32_t mirror = layout.chart % 2 != 0 ? -1 : 0;
  std::int32_t* const first = out + (pole + 1) % 3;
  std::int32_t* const second = out + (pole + 2) % 3;
  std::int32_t* const third = out + pole;
  each_pair(words, layout.normal_bit, layout.normal_bits, layout.vertex_count,
            [=](std::uint32_t i, std::uint32_t a, std::uint32_t b) {
              const std::int32_t x = low_a + wrap(a);
              const std::int32_t y = low_b + wrap(b);
              const std::int32_t x_sign = x >> 31;  // all ones where negative
              const std::int32_t y_sign = y >> 31;
              const std::int32_t x_size = (x ^ x_sign) - x_sign;
              const std::int32_t y_size = (y ^ y_sign) - y_sign;
              const std::int32_t z = scale - x_size - y_size;
              const std::int32_t far = z >> 31;
              const std::int32_t far_x = ((scale - y_size) ^ x_sign) - x_sign;
              const std::int32_t far_y = ((scale - x_size) ^ y_sign) - y_sign;
              first[i * stride] = x ^ ((x ^ far_x) & far);
              second[i * stride] = y ^ ((y ^ far_y) & far);
              third[i * stride] = (z ^ mirror) - mirror;
            });
}

void decode_uvs(const ClusterLayout& layout, const std::uint32_t* words, std::uint32_t set, std::size_t stride,
                const std::uint32_t* raw, std::int32_t* out) {
  namespace f = format::uv_range;
  std::uint32_t bit = layout.uv_bit[set];
  const std::uint32_t* range = words + layout.uv_word[set];
  for (std::uint32_t r = 0; r < layout.uv_range_count[set]; ++r) {
    const auto get = [range](format::BitField field) { return bits_of(format::get_field(range, field)); };
    const std::uint32_t count = get(f::kVerticesLess1) + 1U;
    const std::uint32_t bits[2] = {get(f::kBitsU), get(f::kBitsV)};
    const std::uint32_t low_u = get(f::kMinimumU);
    const std::uint32_t low_v = get(f::kMinimumV);
    if (get(f::kHasFit) != 0) {
      const std::uint32_t u_shift = get(f::kShiftU);
      const std::uint32_t v_shift = get(f::kShiftV);
      const std::uint32_t ux = get(f::kFitU[0]);
      const std::uint32_t uy = get(f::kFitU[1]);
      const std::uint32_t uz = get(f::kFitU[2]);
      const std::uint32_t vx = get(f::kFitV[0]);
      const std::uint32_t vy = get(f::kFitV[1]);
      const std::uint32_t vz = get(f::kFitV[2]);
      each_pair(words, bit, bits, count, [=](std::uint32_t i, std::uint32_t u, std::uint32_t v) {
        const std::uint32_t* const at = raw + std::size_t{i} * 3;
        out[i * stride] = wrap(low_u + u + bits_of(wrap(ux * at[0] + uy * at[1] + uz * at[2]) >> u_shift));
        out[i * stride + 1] = wrap(low_v + v + bits_of(wrap(vx * at[0] + vy * at[1] + vz * at[2]) >> v_shift));
      });
      range += f::kWords + f::kFitWords;
    } else {
      each_pair(words, bit, bits, count, [=](std::uint32_t i, std::uint32_t u, std::uint32_t v) {
        out[i * stride] = wrap(low_u + u);
        out[i * stride + 1] = wrap(low_v + v);
      });
      range += f::kWords;
    }
    bit += count * (bits[0] + bits[1]);
    raw += std::size_t{count} * 3;
    out += count * stride;
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

/// Slot by slot, keeping the edge that the next triangle enters by; docs/reference/format.md says the same for one
/// triangle alone.
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

namespace {

/// Each coordinate divided on its own: a product with the reciprocal would round once more. Two coordinates share a
/// vector.
Vec3f normal_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  using Two = double __attribute__((vector_size(16)));
  const auto dx = static_cast<double>(x);
  const auto dy = static_cast<double>(y);
  const auto dz = static_cast<double>(z);
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz);  // the sum of squares is an integer: exact
  const Two xy = Two{dx, dy} / length;
  return {static_cast<float>(xy[0]), static_cast<float>(xy[1]), static_cast<float>(dz / length)};
}

}  // namespace

Vec3f octahedral_normal(const std::array<std::int32_t, 3>& point) {
  return normal_of(point[0], point[1], point[2]);
}

namespace {

const format::MeshRecord& mesh_of(const Asset& asset, ClusterId cluster) {
  return asset.meshes()[asset.groups()[asset.clusters()[cluster.value].coarser_group].mesh];
}

ClusterLayout layout_of(const format::MeshRecord& mesh, std::span<const std::uint32_t> words, ClusterId cluster) {
  assert(cluster.value >= words[0] && cluster.value - words[0] < words[1]);
  ClusterLayout layout;
  [[maybe_unused]] const char* const wrong = format::read_cluster_layout(mesh, words, cluster.value - words[0], layout);
  assert(wrong == nullptr);  // load_page has looked at every cluster
  return layout;
}

void decode_fields(const format::MeshRecord& mesh, const ClusterLayout& layout, std::span<const std::uint32_t> words,
                   DecodedCluster& out) {
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
}

#if MESHLODE_HAS_BMI2_PATH
MESHLODE_FOR_BMI2 void decode_fields_with_bmi2(const format::MeshRecord& mesh, const ClusterLayout& layout,
                                               std::span<const std::uint32_t> words, DecodedCluster& out) {
  decode_fields(mesh, layout, words, out);
}
#endif

void decode_channels(const format::MeshRecord& mesh, const ClusterLayout& layout, std::span<const std::uint32_t> words,
                     DecodedCluster& out) {
#if MESHLODE_HAS_BMI2_PATH
  if (has_bmi2()) return decode_fields_with_bmi2(mesh, layout, words, out);
#endif
  decode_fields(mesh, layout, words, out);
}

}  // namespace

void decode_vertices(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out) {
  const format::MeshRecord& mesh = mesh_of(asset, cluster);
  decode_channels(mesh, layout_of(mesh, page.words(), cluster), page.words(), out);
}

void decode_cluster(const Asset& asset, const PageBytes& page, ClusterId cluster, DecodedCluster& out) {
  const std::span<const std::uint32_t> words = page.words();
  const format::MeshRecord& mesh = mesh_of(asset, cluster);
  const ClusterLayout layout = layout_of(mesh, words, cluster);
  decode_channels(mesh, layout, words, out);
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

  const std::size_t stride = cluster.channel_count;
  const std::int32_t* value = cluster.channels.data();
  // mantissa · q has at most 49 bits and the power of two is exact, so this product of doubles is exact; the one
  // rounding is to float, and it too is exact while |mantissa · q| < 2^24.
  const double step = std::ldexp(1.0, mesh.grid.log2) * mesh.grid.mantissa;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t* const q = value + i * stride;
    out.positions[i] = {static_cast<float>(step * q[0]), static_cast<float>(step * q[1]),
                        static_cast<float>(step * q[2])};
  }
  value += 3;
  if (has_normal) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t* const q = value + i * stride;
      out.normals[i] = normal_of(q[0], q[1], q[2]);
    }
    value += 3;
  }
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set, value += 2) {
    const double uv_step = std::ldexp(1.0, mesh.uv_log2[set]);
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t* const q = value + i * stride;
      out.uvs[set][i] = {static_cast<float>(uv_step * q[0]), static_cast<float>(uv_step * q[1])};
    }
  }
  if (mesh.has_color != 0U) {
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < 4; ++k)
        out.colors[i][k] = static_cast<float>(value[i * stride + static_cast<std::size_t>(k)]) / 255.0F;
    }
  }
}

namespace {

std::uint64_t decoded_bytes(const Asset& asset, ClusterId id) {
  const format::ClusterRecord& cluster = asset.clusters()[id.value];
  constexpr std::uint64_t kTriangleBytes = sizeof(std::array<std::uint8_t, 3>) + sizeof(std::uint32_t);
  return sizeof(DecodedCluster) + kTriangleBytes * cluster.triangle_count() +
         sizeof(std::int32_t) * format::channel_count(mesh_of(asset, id)) * std::uint64_t{cluster.vertex_count()};
}

}  // namespace

std::uint64_t count_decoded_bytes(const Asset& asset) {
  std::uint64_t sum = 0;
  for (const format::PageRecord& page : asset.pages()) sum += page.bytes;
  for (std::size_t c = 0; c < asset.clusters().size(); ++c) sum += decoded_bytes(asset, ClusterId(c));
  return sum;
}

std::uint64_t count_decoded_bytes(const Asset& asset, std::span<const ClusterId> clusters) {
  std::uint64_t sum = 0;
  for (const ClusterId id : clusters) sum += decoded_bytes(asset, id);
  return sum;
}

Status check_decoded_bytes(const Asset& asset, std::uint64_t bytes) {
  if (bytes <= asset.max_decoded_bytes()) return Ok{};
  return Error{ErrorCode::kUnsupported, "geometry",
               byte_size_text(bytes) + " decoded, at most " + byte_size_text(asset.max_decoded_bytes()) +
                   " are read: the larger of --max-decoded and " + std::to_string(kJustifiedRatio) + " times the file"};
}

Result<std::vector<DecodedCluster>> decode_all(const Asset& asset) {
  TRY(check_decoded_bytes(asset, count_decoded_bytes(asset)));
  std::vector<DecodedCluster> clusters(asset.clusters().size());
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    TRY_LET(page, load_page(asset, PageId{p}));
    const format::PageRecord& record = asset.pages()[p];
    for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
      const ClusterId id{record.first_cluster + i};
      decode_cluster(asset, *page, id, clusters[id.value]);
    }
  }
  return clusters;
}

}  // namespace meshlode::run
