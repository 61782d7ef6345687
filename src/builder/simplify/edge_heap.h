// SPDX-License-Identifier: GPL-3.0-or-later
// The edges that may be collapsed, the cheapest first. A heap of four children a node, because what comes up has mostly
// changed and goes down again: fewer levels, and the children of one are neighbours in memory. Cost and edge are one
// number, so that comparing is one instruction: floats that are not negative are in order as their bits are.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshlode::builder {

/// Of equal costs the lesser edge comes first: a total order.
class EdgeHeap {
 public:
  struct Entry {
    float cost;
    std::uint32_t edge;
  };

  void clear() { heap_.clear(); }
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] Entry top() const {
    return {std::bit_cast<float>(static_cast<std::uint32_t>(heap_[0] >> 32U)), static_cast<std::uint32_t>(heap_[0])};
  }

  /// The cost as it is compared. What is no number goes last.
  [[nodiscard]] static float key_of(double cost) {
    constexpr double kMost = 3e38;
    if (!(cost < kMost)) return static_cast<float>(kMost);
    return cost > 0.0 ? static_cast<float>(cost) : 0.0F;
  }

  /// Without order, until order() is called.
  void append(double cost, std::uint32_t edge) { heap_.push_back(word_of(cost, edge)); }
  void order() {
    if (heap_.size() < 2) return;
    for (std::size_t i = (heap_.size() - 2) / 4 + 1; i-- > 0;) sink(i, heap_[i]);
  }
  void push(double cost, std::uint32_t edge) {
    const std::uint64_t word = word_of(cost, edge);
    std::size_t at = heap_.size();
    heap_.push_back(word);
    for (; at > 0 && word < heap_[(at - 1) / 4]; at = (at - 1) / 4) heap_[at] = heap_[(at - 1) / 4];
    heap_[at] = word;
  }
  void pop() {
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) sink(0, last);
  }
  /// The edge on top has another cost.
  void replace_top(double cost) { sink(0, word_of(cost, static_cast<std::uint32_t>(heap_[0]))); }

 private:
  static std::uint64_t word_of(double cost, std::uint32_t edge) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(key_of(cost))} << 32U | edge;
  }
  [[nodiscard]] std::size_t least_child(std::size_t first) const {
    const std::size_t end = std::min(first + 4, heap_.size());
    if (end == first + 4) {  // which is the least is a toss: sums of comparisons, no branch
      const std::size_t x = first + (heap_[first + 1] < heap_[first] ? 1U : 0U);
      const std::size_t y = first + 2 + (heap_[first + 3] < heap_[first + 2] ? 1U : 0U);
      return x + (y - x) * (heap_[y] < heap_[x] ? 1U : 0U);
    }
    std::size_t least = first;
    for (std::size_t k = first + 1; k < end; ++k) {
      if (heap_[k] < heap_[least]) least = k;
    }
    return least;
  }
  void sink(std::size_t at, std::uint64_t word) {
    for (std::size_t first = 4 * at + 1; first < heap_.size(); first = 4 * at + 1) {
      const std::size_t child = least_child(first);
      if (!(heap_[child] < word)) break;
      heap_[at] = heap_[child];
      at = child;
    }
    heap_[at] = word;
  }

  std::vector<std::uint64_t> heap_;
};

}  // namespace meshlode::builder
