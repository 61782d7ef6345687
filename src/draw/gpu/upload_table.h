// SPDX-License-Identifier: GPL-3.0-or-later
// A table of plain structs as a buffer of the device.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/try.h"
#include "draw/gpu/vulkan/vulkan.h"

namespace meshlode::draw {

/// The bytes of `table` as they are: what shaders read as `scalar` layout. Errors: those of the device.
template <class T>
[[nodiscard]] std::span<const std::uint8_t> bytes_of_table(const std::vector<T>& table) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const std::uint8_t*>(table.data()), table.size() * sizeof(T)};
}

template <class T>
[[nodiscard]] Result<Buffer> make_table(Device& device, const std::vector<T>& table) {
  TRY_LET(buffer, device.make_buffer(table.size() * sizeof(T), Memory::kDevice));
  TRY(device.upload(*buffer, bytes_of_table(table)));
  return buffer;
}

}  // namespace meshlode::draw
