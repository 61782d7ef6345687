// SPDX-License-Identifier: MIT
// The numbers of a stored page between its codec and the model that turns them into fields.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "format/page_streams.h"

namespace meshlode::run {

/// The fields of a vertex as lanes of 16-byte vectors. Position fields are slots 0 to 2, in the order of their streams;
/// slot 3 is not used; the others follow from slot 4 on, so that the pairs of normals and UVs never part.
[[nodiscard]] constexpr std::uint32_t slot_of(std::uint32_t field) {
  return field < 3 ? field : field + 1;
}
constexpr std::uint32_t kMaxSlotsOfVertex = format::kMaxFields + 1;
constexpr std::uint32_t kNormalSlot = 4;

/// Any page.
struct WideLanes {
  using Word = std::uint32_t;
  using Vector = std::uint32_t __attribute__((vector_size(16)));
  using SignedVector = std::int32_t __attribute__((vector_size(16)));
  static constexpr std::uint32_t kLanes = 4;
};

/// Pages whose fields have few bits (kMaxNarrowBits): twice as many to a vector. Everything but the half of a normal's
/// prediction is right modulo 2^16, and that has six times a field at most; a folded error has two bits more than a
/// field.
struct NarrowLanes {
  using Word = std::uint16_t;
  using Vector = std::uint16_t __attribute__((vector_size(16)));
  using SignedVector = std::int16_t __attribute__((vector_size(16)));
  static constexpr std::uint32_t kLanes = 8;
};
constexpr std::uint32_t kMaxNarrowBits = 14;
constexpr std::uint32_t kMaxNarrowNormalBits = 12;

template <class L>
union Quad {
  typename L::Word lane[L::kLanes];
  typename L::Vector vector;
};
template <class L>
constexpr std::uint32_t kMaxQuads = (kMaxSlotsOfVertex + L::kLanes - 1) / L::kLanes;
template <class L>
[[nodiscard]] constexpr std::uint32_t quad_count(const format::MeshRecord& mesh) {
  return slot_of(format::field_count(mesh) - 1) / L::kLanes + 1;
}

/// An array that need not be filled before it is written.
template <class T>
class UnfilledArray {
 public:
  /// `behind`: items that can be read but do not count.
  void resize(std::size_t size, std::size_t behind = 0) {
    items_.reset(new T[size + behind]);  // std::make_unique_for_overwrite, which libc++ 14 lacks
    size_ = size;
  }
  [[nodiscard]] T* data() { return items_.get(); }
  [[nodiscard]] const T* data() const { return items_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<T> all() { return {items_.get(), size_}; }

 private:
  std::unique_ptr<T[]> items_;
  std::size_t size_ = 0;
};

template <class L>
struct StripValues {
  std::array<UnfilledArray<std::uint32_t>, format::kFieldStreams> streams;  ///< symbols, and numbers unfolded
  std::array<UnfilledArray<Quad<L>>, kMaxQuads<L>>
      errors;  ///< unfolded, of each new vertex; unused lanes have any value
};

/// Errors can be read one beyond the last: a walk looks at the next one before it knows whether it is called for.
constexpr std::size_t kErrorsBehind = 1;

/// Whether the numbers of a stream are folded.
[[nodiscard]] constexpr bool is_folded(std::uint32_t stream) {
  return stream >= format::kReferenceStream;
}

/// How many numbers each stream holds: the heads say it, and of twins the stored header.
struct StreamCounts {
  std::array<std::uint32_t, format::kMaxStreams> count{};
};

/// The streams' bytes, one after another.
struct StreamBytes {
  std::span<const std::uint8_t> bytes;
  std::array<std::uint32_t, format::kMaxStreams> size{};  ///< together at most bytes.size()
};

/// `code_lengths` as in the side information. False where the streams are broken or end early.
[[nodiscard]] bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                                       const StreamBytes& streams, const StreamCounts& counts,
                                       StripValues<WideLanes>& out);
[[nodiscard]] bool read_prefix_streams(const format::MeshRecord& mesh, std::span<const std::uint8_t> code_lengths,
                                       const StreamBytes& streams, const StreamCounts& counts,
                                       StripValues<NarrowLanes>& out);

/// Bytes of code lengths.
[[nodiscard]] std::uint32_t code_length_bytes(const format::MeshRecord& mesh);

}  // namespace meshlode::run
