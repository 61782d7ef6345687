// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between the JSON texts of two assets. They come from files: nothing in them is trusted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshlode::app {

struct SettingChange {
  std::string key;
  std::string before, after;  ///< as JSON; "null" where it is not there
};

/// Keys of two JSON objects whose values differ: those of the old one by name, then those that the new one alone has.
[[nodiscard]] std::vector<SettingChange> compare_settings(std::string_view before, std::string_view after);

/// Of each pair of materials (old, new index in the glTF documents' `materials`) the members that differ, in
/// alphabetical order; `name` is none of them. An index that a document has not, format::kNone too, is a material
/// without members. Each material is looked at once: a pair with an index that an earlier pair had has no changes, so
/// that the work is in proportion to the texts.
[[nodiscard]] std::vector<std::vector<std::string>> compare_document_materials(
    std::string_view before, std::string_view after, const std::vector<std::pair<std::size_t, std::size_t>>& pairs);

}  // namespace meshlode::app
