// SPDX-License-Identifier: GPL-3.0-or-later
// Reads elements of a checked accessor one by one: strides, component types, normalization and sparse parts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

/// 1 SCALAR … 4 VEC4; 4, 9, 16 for matrices.
[[nodiscard]] std::uint32_t component_count_of(const tinygltf::Accessor& accessor);
/// Elements that its sparse part replaces.
[[nodiscard]] std::uint64_t sparse_count_of(const tinygltf::Accessor& accessor);

/// One integer or float component as it is stored, as a double. Normalized: c / (2^bits - 1), clamped to -1 where
/// signed (glTF 2.0, section 3.6.2.2).
[[nodiscard]] double read_component(const std::uint8_t* bytes, std::uint32_t component_type, bool normalized);

/// A view of an accessor; it points into the asset's buffers.
class AccessorReader {
 public:
  /// Errors: kInvalid where sparse indices do not increase or are out of range, or where the buffer has no data.
  [[nodiscard]] static Result<AccessorReader> open(const GltfAsset& asset, std::size_t accessor);

  /// A tightly packed array, as a decoder leaves it. \pre bytes hold count elements
  [[nodiscard]] static AccessorReader over(std::span<const std::uint8_t> bytes, std::uint64_t count,
                                           std::uint32_t component_type, std::uint32_t component_count,
                                           bool normalized);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint32_t component_type() const { return component_type_; }
  [[nodiscard]] std::uint32_t component_count() const { return component_count_; }
  [[nodiscard]] bool is_normalized() const { return normalized_; }
  /// The components of an element, up to 4. \pre i < count()
  [[nodiscard]] std::array<double, 4> element(std::uint64_t i) const { return element(i, normalized_); }
  /// The same, normalized or not whatever the accessor says.
  [[nodiscard]] std::array<double, 4> element(std::uint64_t i, bool normalized) const;
  /// The stored bytes of an element, or nullptr where they are all zero. \pre i < count()
  [[nodiscard]] const std::uint8_t* raw(std::uint64_t i) const { return bytes_of(i); }
  /// A scalar unsigned integer. \pre i < count()
  [[nodiscard]] std::uint32_t index(std::uint64_t i) const;

 private:
  [[nodiscard]] const std::uint8_t* bytes_of(std::uint64_t i) const;

  std::uint64_t count_ = 0;
  std::uint32_t component_type_ = 0;
  bool normalized_ = false;
  const std::uint8_t* base_ = nullptr;  ///< nullptr: all zero
  std::uint64_t stride_ = 0;
  std::uint32_t component_size_ = 0;
  std::uint32_t component_count_ = 0;
  // The sparse part. Its indices increase, so an element is found by bisection and nothing needs to be copied.
  const std::uint8_t* sparse_indices_ = nullptr;
  const std::uint8_t* sparse_values_ = nullptr;
  std::uint64_t sparse_count_ = 0;
  std::uint32_t sparse_index_type_ = 0;
};

}  // namespace meshlode::scene
