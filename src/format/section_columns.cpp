// SPDX-License-Identifier: MIT
#include "format/section_columns.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "format/bit_source.h"

namespace meshlode::format {

namespace {

/// Symbols between two looks at the code's end, and what the buffer must be longer for that.
constexpr std::size_t kChunk = 256;
/// Symbols from one look at the code.
constexpr std::size_t kAtOnce = 4;
static_assert(kAtOnce * kMaxCodeBits <= 57);
constexpr std::size_t kPaddingBytes = kChunk * kMaxCodeBits / 8 + 16;

void add_up(std::span<std::uint8_t> records, std::size_t record_bytes) {
  for (std::size_t lane = 0; lane < record_bytes; lane += 2) {
    std::uint16_t value = 0;
    for (std::size_t at = lane; at < records.size(); at += record_bytes) {
      std::uint16_t folded;
      std::memcpy(&folded, &records[at], sizeof(folded));
      value = static_cast<std::uint16_t>(value + unfold16(folded));
      std::memcpy(&records[at], &value, sizeof(value));
    }
  }
}

}  // namespace

ColumnSource::ColumnSource(std::span<const std::uint8_t> stored) : size_(stored.size()) {
  buffer_.reserve(size_ + kPaddingBytes);
  buffer_.assign(stored.begin(), stored.end());
  buffer_.resize(size_ + kPaddingBytes);
}

bool ColumnSource::read(std::uint8_t* out, std::size_t count, std::size_t stride) {
  if (at_ >= size_) return false;
  const auto mode = static_cast<ColumnMode>(buffer_[at_++]);
  if (mode == ColumnMode::kRaw) {
    if (count > size_ - at_) return false;
    for (std::size_t i = 0; i < count; ++i) out[i * stride] = buffer_[at_ + i];
    at_ += count;
    return true;
  }
  if (mode == ColumnMode::kSame) {
    if (at_ == size_) return false;
    for (std::size_t i = 0; i < count; ++i) out[i * stride] = buffer_[at_];
    ++at_;
    return true;
  }
  return mode == ColumnMode::kPrefix && read_codes(out, count, stride);
}

bool ColumnSource::read_codes(std::uint8_t* out, std::size_t count, std::size_t stride) {
  if (size_ - at_ < 2) return false;
  const std::size_t first = buffer_[at_];
  const std::size_t symbols = std::size_t{buffer_[at_ + 1]} + 1;
  at_ += 2;
  if (first + symbols > 256 || size_ - at_ < (symbols + 1) / 2 + 4) return false;
  std::array<std::uint8_t, 256> lengths;
  for (std::size_t s = 0; s < symbols; ++s) lengths[s] = buffer_[at_ + s / 2] >> s % 2 * 4 & 15U;
  at_ += (symbols + 1) / 2;
  std::uint32_t code_bytes;
  std::memcpy(&code_bytes, &buffer_[at_], sizeof(code_bytes));
  at_ += sizeof(code_bytes);
  if (code_bytes > size_ - at_ || !fill_code_table(std::span(lengths).first(symbols), Meaning::kSymbol, table_))
    return false;
  std::uint64_t bit = std::uint64_t{at_} * 8;
  at_ += code_bytes;
  for (std::size_t done = 0; done < count;) {
    const std::size_t chunk_end = std::min(done + kChunk, count);
    for (; done + kAtOnce <= chunk_end; done += kAtOnce) {
      std::uint64_t bits = load_bits(buffer_.data(), bit);
      for (std::size_t i = 0; i < kAtOnce; ++i) {
        out[(done + i) * stride] = static_cast<std::uint8_t>(first + next_symbol(bits, bit, table_));
      }
    }
    for (; done < chunk_end; ++done) {
      out[done * stride] = static_cast<std::uint8_t>(first + take_symbol(buffer_.data(), bit, table_));
    }
    if (bit > std::uint64_t{at_} * 8) return false;
  }
  return true;
}

bool is_section_sound(std::span<const std::uint8_t> stored, std::uint32_t record_bytes, std::uint64_t decoded_bytes) {
  if (decoded_bytes == 0 || (record_bytes != 0 && decoded_bytes % record_bytes != 0)) return false;
  const std::uint64_t columns = record_bytes == 0 ? 1 : record_bytes;
  const std::uint64_t count = decoded_bytes / columns;
  std::uint64_t at = 0;
  const auto skip = [&](std::uint64_t bytes) {
    if (bytes > stored.size() - at) return false;
    at += bytes;
    return true;
  };
  for (std::uint64_t column = 0; column < columns; ++column) {
    if (!skip(1)) return false;
    const auto mode = static_cast<ColumnMode>(stored[at - 1]);
    if (mode == ColumnMode::kRaw) {
      if (!skip(count)) return false;
    } else if (mode == ColumnMode::kSame) {
      if (!skip(1)) return false;
    } else if (mode == ColumnMode::kPrefix) {
      const std::uint64_t head = at;
      if (!skip(2) || !skip((std::uint64_t{stored[head + 1]} + 2) / 2 + 4)) return false;
      std::uint32_t code_bytes;
      std::memcpy(&code_bytes, &stored[at - 4], sizeof(code_bytes));
      // No code is shorter than a bit.
      if (count > std::uint64_t{8} * code_bytes || !skip(code_bytes)) return false;
    } else {
      return false;
    }
  }
  return at == stored.size();
}

bool decode_section(std::span<const std::uint8_t> stored, std::uint32_t record_bytes, std::span<std::uint8_t> out) {
  if (out.empty() || record_bytes % 2 != 0 || (record_bytes != 0 && out.size() % record_bytes != 0)) return false;
  ColumnSource source(stored);
  const std::size_t columns = record_bytes == 0 ? 1 : record_bytes;
  for (std::size_t column = 0; column < columns; ++column) {
    if (!source.read(out.data() + column, out.size() / columns, columns)) return false;
  }
  if (record_bytes != 0) add_up(out, record_bytes);
  return source.is_at_end();
}

}  // namespace meshlode::format
