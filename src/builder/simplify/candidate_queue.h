// SPDX-License-Identifier: GPL-3.0-or-later
// The collapses that are waited for, cheapest first. Many are stale when they come up, and are weighed again and put
// back in their place, so that what counts is what a pop touches: a heap of four children a node over small entries.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace meshlode::builder {

struct Candidate {
  double cost;                      ///< no NaN
  std::uint32_t a, b;               ///< a < b
  std::uint32_t versions;           ///< of both vertices, summed: stale if either has changed since
  bool may_break_topology = false;  ///< the cost already counts that the link condition is broken

  bool operator==(const Candidate&) const = default;
  /// The cost as a whole number that orders as costs do: of those a processor chooses without a branch.
  [[nodiscard]] std::int64_t rank() const {
    const auto bits = std::bit_cast<std::int64_t>(cost + 0.0);  // one zero, not two
    return bits ^ (bits < 0 ? std::numeric_limits<std::int64_t>::max() : 0);
  }
  /// By cost, then by vertices: valid ones that are equal follow one another.
  [[nodiscard]] bool is_before(const Candidate& other) const {
    const std::int64_t mine = rank(), others = other.rank();
    if (mine != others) return mine < others;
    return a != other.a ? a < other.a : b < other.b;
  }
};
static_assert(sizeof(Candidate) == 24);

class CandidateQueue {
 public:
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  void clear() { heap_.clear(); }

  void push(const Candidate& candidate) {
    heap_.push_back(candidate);
    rise(heap_.size() - 1, candidate);
  }
  /// Without putting it in its place: before the next pop or push `order` must be called.
  void append(const Candidate& candidate) { heap_.push_back(candidate); }
  void order() {
    if (heap_.size() < 2) return;
    for (std::size_t i = (heap_.size() - 2) / kChildren + 1; i-- > 0;) sink(i, Candidate(heap_[i]));
  }

  /// \pre not empty
  [[nodiscard]] const Candidate& front() const { return heap_.front(); }
  /// \pre not empty
  void replace_front(const Candidate& candidate) { sink(0, candidate); }
  /// \pre not empty
  Candidate pop() {
    const Candidate first = heap_.front();
    const Candidate last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) sink(0, last);
    return first;
  }

 private:
  static constexpr std::size_t kChildren = 4;

  void rise(std::size_t at, const Candidate& candidate) {
    while (at > 0) {
      const std::size_t parent = (at - 1) / kChildren;
      if (!candidate.is_before(heap_[parent])) break;
      heap_[at] = heap_[parent];
      at = parent;
    }
    heap_[at] = candidate;
  }

  /// The first of up to four children. Which of four that cost differently is a toss: chosen without a branch.
  [[nodiscard]] std::size_t first_of(std::size_t child) const {
    if (child + kChildren <= heap_.size()) {
      const std::int64_t r0 = heap_[child].rank(), r1 = heap_[child + 1].rank(), r2 = heap_[child + 2].rank(),
                         r3 = heap_[child + 3].rank();
      const std::int64_t r01 = std::min(r0, r1), r23 = std::min(r2, r3);
      const bool are_equal = (r0 == r1) | (r2 == r3) | (r01 == r23);
      if (!are_equal) {
        const std::size_t of01 = r1 < r0 ? 1 : 0, of23 = r3 < r2 ? 3 : 2;
        return child + (r23 < r01 ? of23 : of01);
      }
    }
    const std::size_t end = std::min(child + kChildren, heap_.size());
    std::size_t first = child;
    for (++child; child < end; ++child) {
      if (heap_[child].is_before(heap_[first])) first = child;
    }
    return first;
  }

  void sink(std::size_t at, const Candidate& candidate) {
    for (std::size_t child = kChildren * at + 1; child < heap_.size(); child = kChildren * at + 1) {
      const std::size_t least = first_of(child);
      if (!heap_[least].is_before(candidate)) break;
      heap_[at] = heap_[least];
      at = least;
    }
    heap_[at] = candidate;
  }

  std::vector<Candidate> heap_;
};

}  // namespace meshlode::builder
