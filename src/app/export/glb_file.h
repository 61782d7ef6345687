// SPDX-License-Identifier: GPL-3.0-or-later
// The binary half of a GLB: one BIN chunk that grows by aligned pieces, and the container around it (glTF 2.0, 4).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::app {

/// The BIN chunk. Every piece starts at a multiple of 4, which is what any accessor's component asks for.
class GlbBinary {
 public:
  struct Range {
    std::size_t offset = 0, bytes = 0;
  };
  Range append(std::span<const std::uint8_t> bytes);
  /// Values as they lie in memory; the project's machines are little-endian, as glTF is.
  template <class T>
  Range append_values(std::span<const T> values) {
    static_assert(std::is_standard_layout_v<T>);  // GLM's vectors are that, though not trivially copyable
    return append({reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()});
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// What vertex data and indices are for a view.
enum class ViewTarget : int { kNone = 0, kVertices = 34962, kIndices = 34963 };

/// Header, JSON chunk (padded with spaces), BIN chunk (padded with zeros; absent where empty).
/// Errors: kUnsupported beyond the 4 GiB that a GLB can hold.
[[nodiscard]] Result<std::vector<std::uint8_t>> assemble_glb(std::string_view json,
                                                             std::span<const std::uint8_t> binary);

}  // namespace meshlode::app
