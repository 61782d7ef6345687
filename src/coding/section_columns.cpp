// SPDX-License-Identifier: MIT
#include "coding/section_columns.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "coding/bit_source.h"

namespace meshlode {

namespace {

/// Symbols between two looks at the code's end, and what the buffer must be longer for that.
constexpr std::size_t kChunk = 256;
constexpr std::size_t kPaddingBytes = kChunk * kMaxCodeBits / 8 + 16;

class SectionDecoder {
 public:
  SectionDecoder(std::span<const std::uint8_t> stored, std::uint32_t record_bytes, std::span<std::uint8_t> out)
      : size_(stored.size()), columns_(record_bytes == 0 ? 1 : record_bytes), out_(out), buffer_(stored.begin(), stored.end()) {
    buffer_.resize(size_ + kPaddingBytes);
  }

  bool run(bool has_differences) {
    const std::size_t count = out_.size() / columns_;
    for (std::size_t column = 0; column < columns_; ++column) {
      if (at_ >= size_ || !read_column(out_.data() + column, count)) return false;
    }
    if (has_differences) add_up(count);
    return at_ == size_;
  }

 private:
  /// The bytes of a column lie one record apart.
  bool read_column(std::uint8_t* out, std::size_t count) {
    const auto mode = static_cast<ColumnMode>(buffer_[at_++]);
    if (mode == ColumnMode::kRaw) {
      if (count > size_ - at_) return false;
      for (std::size_t i = 0; i < count; ++i) out[i * columns_] = buffer_[at_ + i];
      at_ += count;
      return true;
    }
    if (mode == ColumnMode::kSame) {
      if (at_ == size_) return false;
      for (std::size_t i = 0; i < count; ++i) out[i * columns_] = buffer_[at_];
      ++at_;
      return true;
    }
    return mode == ColumnMode::kPrefix && read_codes(out, count);
  }

  bool read_codes(std::uint8_t* out, std::size_t count) {
    if (size_ - at_ < 2) return false;
    const std::size_t first = buffer_[at_];
    const std::size_t symbols = std::size_t{buffer_[at_ + 1]} + 1;
    at_ += 2;
    if (first + symbols > 256 || size_ - at_ < (symbols + 1) / 2 + 4) return false;
    std::array<std::uint8_t, 256> lengths{};
    for (std::size_t s = 0; s < symbols; ++s) lengths[first + s] = buffer_[at_ + s / 2] >> s % 2 * 4 & 15U;
    at_ += (symbols + 1) / 2;
    std::uint32_t code_bytes;
    std::memcpy(&code_bytes, &buffer_[at_], sizeof(code_bytes));
    at_ += sizeof(code_bytes);
    if (code_bytes > size_ - at_ || !fill_code_table(lengths, false, table_)) return false;
    std::uint64_t bit = at_ * 8;
    at_ += code_bytes;
    for (std::size_t done = 0; done < count;) {
      const std::size_t chunk_end = std::min(done + kChunk, count);
      for (; done < chunk_end; ++done) {
        out[done * columns_] = static_cast<std::uint8_t>(take_symbol(buffer_.data(), bit, table_));
      }
      if (bit > at_ * 8) return false;
    }
    return true;
  }

  void add_up(std::size_t count) {
    for (std::size_t lane = 0; lane < columns_; lane += 2) {
      std::uint16_t value = 0;
      for (std::size_t i = 0; i < count; ++i) {
        std::uint8_t* const bytes = out_.data() + i * columns_ + lane;
        std::uint16_t folded;
        std::memcpy(&folded, bytes, sizeof(folded));
        value = static_cast<std::uint16_t>(value + unfold16(folded));
        std::memcpy(bytes, &value, sizeof(value));
      }
    }
  }

  std::size_t size_, columns_, at_ = 0;
  std::span<std::uint8_t> out_;
  std::vector<std::uint8_t> buffer_;  ///< padded
  CodeTable table_;
};

}  // namespace

bool decode_section(std::span<const std::uint8_t> stored, std::uint32_t record_bytes, std::span<std::uint8_t> out) {
  if (out.empty() || record_bytes % 2 != 0 || (record_bytes != 0 && out.size() % record_bytes != 0)) return false;
  return SectionDecoder(stored, record_bytes, out).run(record_bytes != 0);
}

}  // namespace meshlode
