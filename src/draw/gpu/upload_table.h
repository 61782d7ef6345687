// SPDX-License-Identifier: GPL-3.0-or-later
// A table of plain structs as a buffer of the device.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "draw/gpu/vulkan/vulkan.h"

namespace meshlode::draw {

/// The bytes of `table` as they are: what shaders read as `scalar` layout. Errors: those of the device.
template <class T>
[[nodiscard]] Result<Buffer> make_table(Device& device, const std::vector<T>& table) {
  static_assert(std::is_trivially_copyable_v<T>);
  auto buffer = device.make_buffer(table.size() * sizeof(T), Memory::kDevice);
  if (!buffer) return buffer.error();
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(table.data()),
                                            table.size() * sizeof(T));
  if (const Status done = device.upload(*buffer, bytes); !done) return done.error();
  return buffer;
}

}  // namespace meshlode::draw
