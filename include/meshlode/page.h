// SPDX-License-Identifier: MIT
/// \file
/// Where everything of a cluster lies in a decoded page (docs/reference/format.md, Pages). Header-only, C++ runtime
/// only; decode.glsl is the same for GPUs. A layout that was read without complaint lies inside the page, so that code
/// behind it needs no checks of its own, whatever the bytes were; what the numbers mean is left to decoding.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include <meshlode/format.h>

namespace meshlode::format {

/// Where the parts of one cluster lie in its page, and the numbers of its head (docs/reference/format.md, sections 12
/// and 13). Words and bits are counted from the first word of the page.
struct ClusterLayout {
  std::uint32_t vertex_count = 0;                 ///< vertices, 1 to 256
  std::uint32_t triangle_count = 0;               ///< triangles, 1 to 256
  std::uint32_t head_word = 0;                    ///< first word of the head
  std::uint32_t data_word = 0;                    ///< first word of the data
  std::int32_t minimum[3] = {};                   ///< of the positions, grid units
  std::uint32_t bits[3] = {};                     ///< per vertex and axis of positions, 0 to 24
  std::uint32_t shear_axis = 0;                   ///< the axis that is sheared, 0 to 2
  std::int32_t shear_u = 0;                       ///< shear by the first other axis
  std::int32_t shear_v = 0;                       ///< shear by the second other axis
  std::uint32_t chart = 0;                        ///< of the normals, 0 to 5
  std::int32_t normal_minimum[2] = {};            ///< of the stored normals
  std::uint32_t normal_bits[2] = {};              ///< per vertex and value of normals, 0 to 14
  std::uint32_t strip_count = 0;                  ///< strips of triangles
  std::uint32_t slot_count = 0;                   ///< vertices that the strips name
  std::uint32_t reference_count = 0;              ///< slots that refer to an earlier vertex
  std::uint32_t reference_bits = 0;               ///< per reference, 1 to 8
  std::uint32_t restart_bits = 0;                 ///< per first triangle of a strip
  std::uint32_t material_word = 0;                ///< first material range
  std::uint32_t material_count = 0;               ///< material ranges; 0 if the mesh has one material
  std::uint32_t uv_word[kMaxUvSets] = {};         ///< first UV range of each set
  std::uint32_t uv_range_count[kMaxUvSets] = {};  ///< UV ranges of each set
  std::uint32_t color_word = 0;                   ///< the colour range
  std::uint32_t stream_word = 0;                  ///< first word of the bit stream
  std::uint32_t position_bit = 0;                 ///< first bit of the positions
  std::uint32_t normal_bit = 0;                   ///< first bit of the normals
  std::uint32_t uv_bit[kMaxUvSets] = {};          ///< first bit of each UV set
  std::uint32_t color_bit = 0;                    ///< first bit of the colours
  std::uint32_t turn_bit = 0;                     ///< first bit of the turns
  std::uint32_t fresh_bit = 0;                    ///< first bit of the flags of fresh vertices
  std::uint32_t restart_bit = 0;                  ///< first bit of the strips' first triangles
  std::uint32_t reference_bit = 0;                ///< first bit of the references
  std::uint32_t end_bit = 0;                      ///< after the last bit of the stream
  std::uint32_t end_word = 0;                     ///< after the cluster's data: the next one's, or the zero word
};

/// Reads `count` bits from bit `at`. \pre count <= 32, and the word after the field's first word can be read
[[nodiscard]] constexpr std::uint32_t get_bits(const std::uint32_t* words, std::uint32_t at, std::uint32_t count) {
  const std::uint64_t pair = words[at / 32] | std::uint64_t{words[at / 32 + 1]} << 32;
  return static_cast<std::uint32_t>(pair >> at % 32 & ((std::uint64_t{1} << count) - 1U));
}

/// Computes where the parts of cluster number `index` of a decoded page lie.
/// \return nullptr on success; otherwise the name of the first invalid field (static storage), and `out` is
/// unspecified. After success every offset in `out` lies inside `page`, whatever the bytes were.
[[nodiscard]] constexpr const char* read_cluster_layout(const MeshRecord& mesh, std::span<const std::uint32_t> page,
                                                        std::uint32_t index, ClusterLayout& out) {
  constexpr std::uint32_t kPageHeaderWords = sizeof(PageHeader) / 4;
  const bool has_normal = mesh.normal_mode == NormalMode::kStored;
  const std::uint64_t head_word = kPageHeaderWords + std::uint64_t{index} * head_words(mesh);
  if (head_word + head_words(mesh) >= page.size()) return "cluster_count";
  const std::uint64_t last_word = page.size() - 1;  // the zero word
  out.head_word = static_cast<std::uint32_t>(head_word);
  const std::uint32_t* const head = page.data() + head_word;
  const auto get = [](const std::uint32_t* words, BitField field) {
    return static_cast<std::uint32_t>(get_field(words, field));
  };
  const std::uint32_t vertices = get(head, head::kVerticesLess1) + 1U;
  const std::uint32_t triangles = get(head, head::kTrianglesLess1) + 1U;
  out.vertex_count = vertices;
  out.triangle_count = triangles;
  out.data_word = get(head, head::kDataWord);
  std::uint64_t position_bits = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.minimum[axis] = get_field(head, head::kMinimum[axis]);
    out.bits[axis] = get(head, head::kBits[axis]);
    if (out.bits[axis] > 24) return "bits";
    position_bits += out.bits[axis];
  }
  out.chart = get(head, head::kChart);
  if (out.chart > (has_normal ? 5U : 0U)) return "chart";
  out.shear_axis = get(head, head::kShearAxis);
  if (out.shear_axis > 2) return "shear_axis";
  out.shear_u = get_field(head, head::kShearU);
  out.shear_v = get_field(head, head::kShearV);
  out.strip_count = get(head, head::kStripsLess1) + 1U;
  if (out.strip_count > triangles) return "strip_count";
  out.reference_bits = get(head, head::kReferenceBits);
  if (out.reference_bits < 1 || out.reference_bits > 8) return "reference_bits";
  out.normal_bits[0] = get(head, head::kNormalBitsA);
  out.normal_bits[1] = 0;
  out.normal_minimum[0] = out.normal_minimum[1] = 0;
  if (has_normal) {
    out.normal_bits[1] = get(head, head::kNormalBitsB);
    out.normal_minimum[0] = get_field(head, head::kNormalMinimumA);
    out.normal_minimum[1] = get_field(head, head::kNormalMinimumB);
  }
  if (out.normal_bits[0] > (has_normal ? 14U : 0U) || out.normal_bits[1] > 14) return "normal_bits";
  out.slot_count = triangles + 2U * out.strip_count;
  if (out.slot_count < vertices) return "vertex_count";
  out.reference_count = out.slot_count - vertices;
  out.restart_bits = static_cast<std::uint32_t>(std::bit_width(triangles - 1U));

  std::uint64_t at = out.data_word;
  if (at > last_word) return "data_word";
  out.material_word = static_cast<std::uint32_t>(at);
  out.material_count = 0;
  if (mesh.material == kNone) {
    for (std::uint32_t covered = 0; covered < triangles; at += material_range::kWords, ++out.material_count) {
      if (at + material_range::kWords > last_word) return "material_range";
      covered += get(&page[at], material_range::kTrianglesLess1) + 1U;
      if (covered > triangles) return "material_range";
    }
  }
  std::uint64_t uv_bits[kMaxUvSets] = {};
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    out.uv_word[set] = static_cast<std::uint32_t>(at);
    out.uv_range_count[set] = 0;
    for (std::uint32_t covered = 0; covered < vertices; ++out.uv_range_count[set]) {
      if (at + uv_range::kWords > last_word) return "uv_range";
      const std::uint32_t* const range = &page[at];
      const std::uint32_t count = get(range, uv_range::kVerticesLess1) + 1U;
      covered += count;
      if (covered > vertices) return "uv_range";
      if (get(range, uv_range::kBitsU) > 25 || get(range, uv_range::kBitsV) > 25) return "uv_range.bits";
      uv_bits[set] += std::uint64_t{count} * (get(range, uv_range::kBitsU) + get(range, uv_range::kBitsV));
      at += uv_range::kWords + (get(range, uv_range::kHasFit) != 0 ? uv_range::kFitWords : 0U);
    }
    if (at > last_word) return "uv_range";
  }
  out.color_word = static_cast<std::uint32_t>(at);
  std::uint64_t color_bits = 0;
  if (mesh.has_color != 0) {
    if (at + color_range::kWords > last_word) return "color_range";
    for (const BitField& field : color_range::kBits) {
      if (get(&page[at], field) > 8) return "color_range.bits";
      color_bits += get(&page[at], field);
    }
    at += color_range::kWords;
  }

  // At most 256 vertices of a few hundred bits: no sum comes near 2^32.
  out.stream_word = static_cast<std::uint32_t>(at);
  std::uint64_t bit = at * 32;
  const auto take = [&bit](std::uint64_t count) {
    const std::uint64_t start = bit;
    bit += count;
    return static_cast<std::uint32_t>(start);
  };
  out.position_bit = take(vertices * position_bits);
  out.normal_bit = take(std::uint64_t{vertices} * (out.normal_bits[0] + out.normal_bits[1]));
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) out.uv_bit[set] = take(uv_bits[set]);
  out.color_bit = take(vertices * color_bits);
  out.turn_bit = take(triangles);
  out.fresh_bit = take(out.slot_count);
  out.restart_bit = take(std::uint64_t{out.strip_count - 1U} * out.restart_bits);
  out.reference_bit = take(std::uint64_t{out.reference_count} * out.reference_bits);
  out.end_bit = static_cast<std::uint32_t>(bit);
  const std::uint64_t end_word = (bit + 31) / 32;
  if (end_word > last_word) return "data_word";
  out.end_word = static_cast<std::uint32_t>(end_word);
  return nullptr;
}

}  // namespace meshlode::format
