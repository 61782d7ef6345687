// SPDX-License-Identifier: MIT
// Values one after another in bytes, and back: for what this program stores for itself. As the machine has them, so
// only for readers that look at a hash of the bytes and at who wrote them; the reader meets any bytes all the same.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace meshlode {

class ByteWriter {
 public:
  /// `T`: numbers, enums, and structs of them.
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&v);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  void text(std::string_view s) {
    value(std::uint64_t{s.size()});
    bytes_.insert(bytes_.end(), s.begin(), s.end());
  }
  template <class T>
  void list(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(std::uint64_t{items.size()});
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(items.data());
    bytes_.insert(bytes_.end(), bytes, bytes + items.size() * sizeof(T));
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Every read is false where the bytes end before it; what it would have filled is then as it was. Counts are believed
/// only as far as there are bytes for them.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  [[nodiscard]] bool value(T& v) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    if (bytes_.size() < sizeof(T)) return false;
    std::memcpy(static_cast<void*>(&v), bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return true;
  }
  [[nodiscard]] bool text(std::string& s) {
    std::uint64_t size = 0;
    if (!count(size, 1)) return false;
    s.assign(reinterpret_cast<const char*>(bytes_.data()), size);
    bytes_ = bytes_.subspan(size);
    return true;
  }
  template <class T>
  [[nodiscard]] bool list(std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    std::uint64_t size = 0;
    if (!count(size, sizeof(T))) return false;
    items.resize(size);
    if (size > 0) std::memcpy(static_cast<void*>(items.data()), bytes_.data(), size * sizeof(T));
    bytes_ = bytes_.subspan(size * sizeof(T));
    return true;
  }
  /// How many things follow, of at least so many bytes each. \pre item_bytes > 0
  [[nodiscard]] bool count(std::uint64_t& size, std::size_t item_bytes) {
    const auto before = bytes_;
    if (value(size) && size <= bytes_.size() / item_bytes) return true;
    bytes_ = before;
    return false;
  }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace meshlode
