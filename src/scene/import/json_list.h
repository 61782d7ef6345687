// SPDX-License-Identifier: GPL-3.0-or-later
// A list that takes one pointer where it is held and one block of memory, none while it is empty. Of [0],[0],… a
// std::vector's three pointers, and a block's own header, would be most of what a document takes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <utility>

namespace meshlode::scene {

template <class T>
class JsonList {
 public:
  JsonList() = default;
  JsonList(const T* first, std::size_t count) : JsonList() {
    reserve(count);
    for (std::size_t i = 0; i < count; ++i) push_back(first[i]);
  }
  JsonList(const JsonList& other) : JsonList(other.data(), other.size()) {}
  JsonList(JsonList&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  JsonList& operator=(JsonList other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~JsonList() {
    for (T& item : *this) item.~T();
    ::operator delete(block_);
  }

  [[nodiscard]] std::size_t size() const { return block_ != nullptr ? block_->size : 0; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] T* data() { return block_ != nullptr ? reinterpret_cast<T*>(block_ + 1) : nullptr; }
  [[nodiscard]] const T* data() const { return block_ != nullptr ? reinterpret_cast<const T*>(block_ + 1) : nullptr; }
  [[nodiscard]] T* begin() { return data(); }
  [[nodiscard]] T* end() { return data() + size(); }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size(); }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }
  [[nodiscard]] T& back() { return end()[-1]; }

  /// Room for exactly this many, where there is less.
  void reserve(std::size_t count) {
    if (count <= capacity()) return;
    if (count > std::numeric_limits<std::uint32_t>::max()) throw std::bad_alloc();
    static_assert(alignof(T) <= sizeof(Block));
    auto* const block = static_cast<Block*>(::operator new(sizeof(Block) + count * sizeof(T)));
    block->size = static_cast<std::uint32_t>(size());
    block->capacity = static_cast<std::uint32_t>(count);
    T* to = reinterpret_cast<T*>(block + 1);
    for (T& item : *this) new (to++) T(std::move(item));
    for (T& item : *this) item.~T();
    ::operator delete(block_);
    block_ = block;
  }
  T& push_back(T item) {
    if (size() == capacity()) reserve(std::max<std::size_t>(1, 2 * size()));
    T* const at = new (end()) T(std::move(item));
    ++block_->size;
    return *at;
  }
  T& emplace_back(T item = {}) { return push_back(std::move(item)); }
  template <class IsGone>
  void erase_if(const IsGone& is_gone) {
    T* const kept = std::remove_if(begin(), end(), is_gone);
    const auto count = static_cast<std::uint32_t>(kept - begin());
    for (T* item = kept; item != end(); ++item) item->~T();
    if (block_ != nullptr) block_->size = count;
  }

 private:
  struct alignas(8) Block {
    std::uint32_t size;
    std::uint32_t capacity;
  };
  [[nodiscard]] std::size_t capacity() const { return block_ != nullptr ? block_->capacity : 0; }

  Block* block_ = nullptr;
};

}  // namespace meshlode::scene
