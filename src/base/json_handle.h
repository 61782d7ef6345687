// SPDX-License-Identifier: MIT
// A JsonHandle (base/gltf_textures.h) over a tree of nlohmann-json's, which this header does not see.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace meshlode {

template <class Tree>
class TreeHandle {
 public:
  TreeHandle() = default;
  explicit TreeHandle(const Tree& tree) : tree_(&tree) {}

  [[nodiscard]] const Tree* get() const { return tree_; }
  [[nodiscard]] bool is_object() const { return tree_ != nullptr && tree_->is_object(); }
  [[nodiscard]] TreeHandle find(std::string_view key) const {
    if (!is_object()) return {};
    const auto found = tree_->find(key);
    return found == tree_->end() ? TreeHandle() : TreeHandle(*found);
  }
  /// Elements of an array.
  [[nodiscard]] std::size_t size() const { return tree_ != nullptr && tree_->is_array() ? tree_->size() : 0; }
  [[nodiscard]] TreeHandle item(std::size_t i) const { return i < size() ? TreeHandle((*tree_)[i]) : TreeHandle(); }
  [[nodiscard]] std::optional<std::uint64_t> index() const {
    if (tree_ == nullptr) return std::nullopt;
    if (tree_->is_number_unsigned()) return tree_->template get<std::uint64_t>();
    if (!tree_->is_number_float()) return std::nullopt;
    // 3.0 counts as 3, as it does for the importer (scene/import/json.h).
    const auto value = tree_->template get<double>();
    const bool is_whole = value >= 0.0 && value <= 0x1p53 && value == std::floor(value);
    return is_whole ? std::optional(static_cast<std::uint64_t>(value)) : std::nullopt;
  }
  [[nodiscard]] std::optional<double> number() const {
    if (tree_ == nullptr || !tree_->is_number()) return std::nullopt;
    return tree_->template get<double>();
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < size(); ++i) visit(std::string_view(), TreeHandle((*tree_)[i]));
    if (!is_object()) return;
    for (auto member = tree_->begin(); member != tree_->end(); ++member) {
      visit(std::string_view(member.key()), TreeHandle(*member));
    }
  }
  bool operator==(const TreeHandle&) const = default;

 private:
  const Tree* tree_ = nullptr;
};

}  // namespace meshlode
