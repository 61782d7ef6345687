// SPDX-License-Identifier: GPL-3.0-or-later
// Edges whose collapse was refused, noted at both ends: what stood in the way depends on what is around them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/ids.h"

namespace meshlode::builder {

class RefusedEdges {
 public:
  void start(std::size_t vertex_count, std::size_t edge_count) {
    notes_.clear();
    first_.assign(vertex_count, kNoId);
    is_refused_.assign(edge_count, 0);
  }
  void add(std::uint32_t edge, const std::array<std::uint32_t, 2>& ends) {
    is_refused_[edge] = 1;
    for (const std::uint32_t v : ends) {
      notes_.push_back({edge, first_[v]});
      first_[v] = static_cast<std::uint32_t>(notes_.size() - 1);
    }
  }
  /// Those at the vertex are refused no more, and are appended to `out`.
  void take(std::uint32_t vertex, std::vector<std::uint32_t>& out) {
    for (std::uint32_t k = first_[vertex]; k != kNoId; k = notes_[k].next) {
      std::uint8_t& is_refused = is_refused_[notes_[k].edge];
      if (is_refused != 0) out.push_back(notes_[k].edge);
      is_refused = 0;
    }
    first_[vertex] = kNoId;
  }

 private:
  struct Note {
    std::uint32_t edge, next;
  };
  std::vector<Note> notes_;           ///< a list for each vertex
  std::vector<std::uint32_t> first_;  ///< per vertex
  std::vector<std::uint8_t> is_refused_;
};

}  // namespace meshlode::builder
