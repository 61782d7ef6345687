// SPDX-License-Identifier: GPL-3.0-or-later
// The materials of a growing list of triangles. Most meshes have one: it takes no memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

class TriangleMaterials {
 public:
  /// How many there will be, about.
  void expect(std::size_t triangles) { expected_ = triangles; }
  /// Makes room for triangles behind the others. Which of them has which of `materials` is for set() to say.
  void add(std::span<const std::uint32_t> materials) {
    if (materials.empty()) return;
    if (size_ == 0) one_ = materials.front();
    const bool is_one = std::all_of(materials.begin(), materials.end(), [&](std::uint32_t m) { return m == one_; });
    size_ += materials.size();
    is_one_ = is_one_ && is_one;
    if (is_one_) return;
    if (each_.empty()) each_.reserve(expected_);
    each_.resize(size_, one_);
  }
  /// Side by side for different triangles. \pre what add() was last given has `material`
  void set(std::size_t triangle, std::uint32_t material) {
    if (!is_one_) each_[triangle] = material;
  }
  [[nodiscard]] std::uint32_t operator[](std::size_t triangle) const { return is_one_ ? one_ : each_[triangle]; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0, expected_ = 0;
  std::uint32_t one_ = 0;  ///< of all triangles, or of the first
  bool is_one_ = true;
  std::vector<std::uint32_t> each_;  ///< where they have more than one
};

}  // namespace meshlode::builder
