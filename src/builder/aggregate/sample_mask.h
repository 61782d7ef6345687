// SPDX-License-Identifier: GPL-3.0-or-later
// Which samples of a picture something covers, a bit each, in a box of the picture.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/aggregate/alpha_test.h"

namespace meshlode::builder {

/// Columns are whole words of 64 samples, so that masks of one picture can be put together word by word.
struct MaskBox {
  int first_word = 0, end_word = 0;  ///< columns: 64 · first_word to 64 · end_word - 1
  int first_row = 0, end_row = 0;    ///< even numbers, so that blocks of 2 × 2 samples are whole

  [[nodiscard]] bool is_empty() const { return first_word >= end_word || first_row >= end_row; }
  [[nodiscard]] int words() const { return end_word - first_word; }
  [[nodiscard]] int rows() const { return end_row - first_row; }
  /// Grows around points, in samples, within a picture of `side` samples.
  void include(std::span<const Vec2d> points, int side);
  void include(const MaskBox& other);
};

class SampleMask {
 public:
  SampleMask() = default;
  explicit SampleMask(const MaskBox& box)
      : box_(box),
        words_(box.is_empty() ? 0 : static_cast<std::size_t>(box.words()) * static_cast<std::size_t>(box.rows())) {}

  [[nodiscard]] const MaskBox& box() const { return box_; }
  [[nodiscard]] std::uint64_t* row(int y) { return words_.data() + at(y); }
  [[nodiscard]] const std::uint64_t* row(int y) const { return words_.data() + at(y); }
  /// The word with that number, 0 outside the box.
  [[nodiscard]] std::uint64_t word(int x, int y) const {
    const bool is_inside = y >= box_.first_row && y < box_.end_row && x >= box_.first_word && x < box_.end_word;
    return is_inside ? row(y)[x - box_.first_word] : 0;
  }
  /// Adds the samples inside a triangle, whichever way round it is; of two that share an edge a sample is in one.
  /// What is outside the box is left out. \pre places are finite and within 2^20
  void add_triangle(const std::array<Vec2d, 3>& corners);
  /// The same of samples that `covers` has at their texture coordinates, of which `uv` are the corners'.
  void add_triangle(const std::array<Vec2d, 3>& corners, const std::array<Vec2d, 3>& uv, const AlphaTest& covers);
  /// Adds another mask's samples. \pre its box is within this one's
  void add(const SampleMask& other);
  [[nodiscard]] std::uint64_t count() const;
  /// Every other sample, each way: the even ones, as samples of half their coordinates.
  [[nodiscard]] SampleMask even_samples() const;

 private:
  [[nodiscard]] std::size_t at(int y) const {
    return static_cast<std::size_t>(y - box_.first_row) * static_cast<std::size_t>(box_.words());
  }

  MaskBox box_;
  std::vector<std::uint64_t> words_;
};

}  // namespace meshlode::builder
