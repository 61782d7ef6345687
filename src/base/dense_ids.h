// SPDX-License-Identifier: MIT
// Dense ids: the members of a set of numbers become 0, 1, 2 … in ascending order. A bit for each number that could be
// in, and how many are in before each word of them, so that what is cleared and looked at is an eighth of a byte for
// each, and not a table as long as they are many.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshlode {

class DenseIds {
 public:
  DenseIds() = default;
  /// For numbers below `limit`.
  explicit DenseIds(std::size_t limit) : words_(limit / kBits + 1) {}

  /// \pre number < limit, and not after finish()
  void add(std::uint32_t number) { words_[number / kBits].bits |= std::uint64_t{1} << number % kBits; }
  /// Before the first question.
  void finish() {
    for (Word& word : words_) {
      word.before = count_;
      count_ += static_cast<std::uint32_t>(std::popcount(word.bits));
    }
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// How many smaller numbers are in the set. \pre the number is in it
  [[nodiscard]] std::uint32_t operator[](std::uint32_t number) const {
    const Word& word = words_[number / kBits];
    const std::uint64_t smaller = word.bits & ((std::uint64_t{1} << number % kBits) - 1);
    return word.before + static_cast<std::uint32_t>(std::popcount(smaller));
  }

 private:
  static constexpr std::uint32_t kBits = 64;
  struct Word {
    std::uint64_t bits = 0;
    std::uint32_t before = 0;
  };
  std::vector<Word> words_;
  std::uint32_t count_ = 0;
};

}  // namespace meshlode
