// SPDX-License-Identifier: MIT
// Arrays that are written whole after they are given their size, by several threads: std::vector clears them first, on
// one thread, which for large ones is the first touch of new memory and takes longer than what is written then.
#pragma once

#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace meshlode {

template <class T>
struct UnsetAllocator : std::allocator<T> {
  static_assert(std::is_trivially_destructible_v<T>);

  UnsetAllocator() = default;
  template <class U>
  UnsetAllocator(const UnsetAllocator<U>& /*other*/) noexcept {}

  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) > 0) ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }
};

/// A vector whose new elements hold nothing that may be read until they are written: those of resize(n) and of the
/// constructor that takes a size alone. Given a value they have it.
template <class T>
using UnsetVector = std::vector<T, UnsetAllocator<T>>;

}  // namespace meshlode
