// SPDX-License-Identifier: MIT
// Heads and range words of a stored page go back to where they stand in the page.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <meshlode/format.h>

#include "format/page_streams.h"

namespace meshlode::run {

/// Columns of bytes, taken one after the other.
class ColumnReader {
 public:
  explicit ColumnReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  /// Empty and a remembered failure where fewer are left.
  std::span<const std::uint8_t> take(std::uint64_t count);
  std::uint32_t take_u32();
  [[nodiscard]] bool is_short() const { return is_short_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_short_ = false;
};

/// Puts a page together from the front. Everything is checked against the page's size, nothing against the rules of the
/// format: format::read_cluster_layout does that on what has been placed.
class PageColumns {
 public:
  PageColumns(const format::MeshRecord& mesh, std::uint32_t cluster_count, std::span<std::uint32_t> page)
      : mesh_(mesh), cluster_count_(cluster_count), page_(page) {}

  /// Takes all that is left of `columns` and writes the heads. False where it does not fit.
  bool read(ColumnReader& columns);

  /// Says in the head that the cluster's data starts at `word`, and puts its range words there. Null where that cannot
  /// be, else the word behind them.
  bool place_cluster(std::uint32_t cluster, std::uint32_t& word);

  [[nodiscard]] std::uint32_t first_data_word() const { return 2 + cluster_count_ * format::head_words(mesh_); }
  [[nodiscard]] std::uint32_t vertex_count(std::uint32_t cluster) const { return (head(cluster)[0] & 0xFFU) + 1U; }
  [[nodiscard]] std::uint32_t triangle_count(std::uint32_t cluster) const {
    return (head(cluster)[0] >> 8U & 0xFFU) + 1U;
  }

 private:
  [[nodiscard]] std::uint32_t* head(std::uint32_t cluster) const {
    return page_.data() + 2 + cluster * format::head_words(mesh_);
  }
  bool read_heads(ColumnReader& columns);
  bool place_word(format::RangeWord kind, std::uint32_t& word);

  const format::MeshRecord& mesh_;
  std::uint32_t cluster_count_;
  std::span<std::uint32_t> page_;
  std::array<std::uint32_t, format::kRangeWordKinds> counts_{}, next_{}, before_{};
  std::array<std::array<std::span<const std::uint8_t>, 4>, format::kRangeWordKinds> planes_;
};

}  // namespace meshlode::run
