// SPDX-License-Identifier: MIT
// The numbers of a stored page between its codec and the model that turns them into fields.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/stored_page.h"

namespace meshlode {

/// Four fields of a vertex: one vector register.
union Quad {
  using Lanes = std::uint32_t __attribute__((vector_size(16)));
  std::uint32_t lane[4];
  Lanes lanes;
};

/// Position fields are lanes 0 to 2 of quad 0, in the order of their streams; the others follow each other from quad 1 on.
constexpr std::uint32_t kMaxQuads = 1 + (kMaxFields - 3 + 3) / 4;
[[nodiscard]] constexpr std::uint32_t quad_of(std::uint32_t field) { return field < 3 ? 0U : 1U + (field - 3U) / 4U; }
[[nodiscard]] constexpr std::uint32_t lane_of(std::uint32_t field) { return field < 3 ? field : (field - 3U) % 4U; }

struct StripValues {
  std::array<std::vector<std::uint32_t>, kFieldStreams> streams;  ///< as stored: symbols, folded numbers
  std::array<std::vector<Quad>, kMaxQuads> errors;                ///< folded, of each new vertex
};

/// How many numbers each stream holds: the heads say it, and of twins the stored header.
struct StreamCounts {
  std::array<std::uint32_t, kMaxStreams> count{};
};

/// The streams' bytes, one behind the other.
struct StreamBytes {
  std::span<const std::uint8_t> bytes;
  std::array<std::uint32_t, kMaxStreams> size{};  ///< together at most bytes.size()
};

/// `code_lengths` as in the side information. False where the streams are broken or end early.
[[nodiscard]] bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                                       const StreamBytes& streams, const StreamCounts& counts, StripValues& out);

/// Bytes of code lengths.
[[nodiscard]] std::uint32_t code_length_bytes(const format::MeshRecord& mesh);

}  // namespace meshlode
