// SPDX-License-Identifier: MIT
// XXH3, the one hash of the project (content, sections, pages, sources).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace meshlode {

using Hash128 = std::array<std::uint8_t, 16>;  ///< canonical (big-endian) order, as XXH3-128 prints

[[nodiscard]] std::uint64_t hash64(std::span<const std::uint8_t> bytes);
[[nodiscard]] Hash128 hash128(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::string to_hex(const Hash128& hash);

/// XXH3-128 of a stream given in pieces.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  void update(std::span<const std::uint8_t> bytes);
  [[nodiscard]] Hash128 digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace meshlode
