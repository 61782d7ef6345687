// SPDX-License-Identifier: MIT
// Wrapper of xxHash, inlined so that the runtime half links nothing.
#include "base/hash.h"

#define XXH_INLINE_ALL
#define XXH_NO_STREAM_DEPRECATED
#include <xxhash.h>

namespace meshlode {

struct Hasher::State {
  XXH3_state_t xxh;
};

namespace {

Hash128 canonical(const XXH128_hash_t& hash) {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, hash);
  Hash128 out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = bytes.digest[i];
  return out;
}

}  // namespace

std::uint64_t hash64(std::span<const std::uint8_t> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

Hash128 hash128(std::span<const std::uint8_t> bytes) {
  return canonical(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string to_hex(const Hash128& hash) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * hash.size());
  for (const std::uint8_t byte : hash) {
    text.push_back(kDigits[byte >> 4U]);
    text.push_back(kDigits[byte & 15U]);
  }
  return text;
}

Hasher::Hasher() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->xxh);
}
Hasher::~Hasher() = default;
void Hasher::update(std::span<const std::uint8_t> bytes) {
  XXH3_128bits_update(&state_->xxh, bytes.data(), bytes.size());
}
Hash128 Hasher::digest() const {
  return canonical(XXH3_128bits_digest(&state_->xxh));
}

}  // namespace meshlode
