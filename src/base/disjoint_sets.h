// SPDX-License-Identifier: MIT
// Disjoint sets (union by size, path halving; Tarjan 1975): a find takes O(log n) steps for any order of joins, and
// nothing recurses, so that a file cannot choose the depth.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace meshlode {

class DisjointSets {
 public:
  /// Each of 0 … count - 1 alone.
  explicit DisjointSets(std::size_t count) : parent_(count), size_(count, 1) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  /// The member that stands for x's set: the same for all of them until the next join.
  [[nodiscard]] std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }

  /// Whether two sets became one. Of equal sizes the lower name stays.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    if (size_[a] < size_[b] || (size_[a] == size_[b] && b < a)) std::swap(a, b);
    link(a, b);
    return true;
  }

  /// Whether two sets became one. What stood for a's set stands for both: for callers who go by that name. By path
  /// halving alone a find then takes O(log n) steps on average over all calls.
  bool join_to(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    link(a, b);
    return true;
  }

 private:
  void link(std::uint32_t root, std::uint32_t child) {
    parent_[child] = root;
    size_[root] += size_[child];
  }

  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> size_;  ///< of the set, at its root
};

}  // namespace meshlode
