// SPDX-License-Identifier: MIT
// Sections whose codec is `columns`: tables and texts in prefix codes of their own, without any library
// (docs/reference/format.md, Stored sections).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/bit_source.h"

namespace meshlode::format {

/// SectionEntry::codec. Values are stable.
enum class SectionCodec : std::uint32_t {
  kPlain = 0,    ///< as it is
  kColumns = 1,  ///< see above
};

/// How the bytes of a column are stored.
enum class ColumnMode : std::uint8_t {
  kRaw = 0,   ///< as they are
  kSame = 1,  ///< one byte, which all of them are
  kPrefix =
      2,  ///< first symbol, number of symbols - 1, their code lengths (4 bits each), bytes of the code (u32), code
};

/// Differences of 16-bit words from record to record are folded.
[[nodiscard]] constexpr std::uint16_t fold16(std::uint16_t value) {
  return static_cast<std::uint16_t>(value << 1U ^ (0U - (value >> 15U)));
}
[[nodiscard]] constexpr std::uint16_t unfold16(std::uint16_t value) {
  return static_cast<std::uint16_t>(value >> 1U ^ (0U - (value & 1U)));
}

/// A section never shrinks by more than this: what is decoded must be justified by what is stored.
constexpr std::uint64_t kMaxSectionRatio = 256;

/// Columns, one after another.
class ColumnSource {
 public:
  explicit ColumnSource(std::span<const std::uint8_t> stored);
  /// Fills `count` bytes that lie `stride` apart. False where the stored bytes do not say them.
  [[nodiscard]] bool read(std::uint8_t* out, std::size_t count, std::size_t stride);
  [[nodiscard]] bool is_at_end() const { return at_ == size_; }

 private:
  bool read_codes(std::uint8_t* out, std::size_t count, std::size_t stride);

  std::size_t size_, at_ = 0;
  std::vector<std::uint8_t> buffer_;  ///< padded
  CodeTable table_;
};

/// Whether the stored bytes are whole columns of `decoded_bytes` together, without decoding any: what they ask for is
/// looked at before room is made for it.
[[nodiscard]] bool is_section_sound(std::span<const std::uint8_t> stored, std::uint32_t record_bytes,
                                    std::uint64_t decoded_bytes);

/// Fills `out`, a whole number of records; `record_bytes` 0: a text, one column without differences. False where the
/// bytes do not say exactly that. \pre record_bytes is even
[[nodiscard]] bool decode_section(std::span<const std::uint8_t> stored, std::uint32_t record_bytes,
                                  std::span<std::uint8_t> out);

}  // namespace meshlode::format
