// SPDX-License-Identifier: GPL-3.0-or-later
// Budgets as text: `totals.clusters>1000, any(meshes).stuck_groups>0` (docs/guides/budgets.md has the grammar). A
// condition is a path into a JSON document, a relation and a value; this file knows nothing of any document.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <meshlode/result.h>

#include "base/enum_names.h"

namespace meshlode::app {

enum class StepKind : std::uint8_t {
  kKey,    ///< into an object: `totals`
  kIndex,  ///< the element of a list: `[3]`
  kName,   ///< the element of a list that has this name, or the key of an object, whatever letters it has: `["rock"]`
  kAny,    ///< what follows holds for one element of the list
  kAll,    ///< what follows holds for all elements of the list, and it has some
  kCount,  ///< how many elements the list has; always the last
};

struct Step {
  StepKind kind = StepKind::kKey;
  std::string name;         ///< of kKey and kName
  std::uint64_t index = 0;  ///< of kIndex
  bool is_count = false;    ///< the key of a map of counts, where one that is absent is 0 (read_budget() knows)
};

enum class Relation : std::uint8_t { kGreater, kGreaterEqual, kLess, kLessEqual, kEqual, kNotEqual };
/// Those of two characters first, as a parser tries them.
inline constexpr std::array<EnumName<Relation>, 6> kRelationNames{{{Relation::kGreaterEqual, ">="},
                                                                   {Relation::kLessEqual, "<="},
                                                                   {Relation::kEqual, "=="},
                                                                   {Relation::kNotEqual, "!="},
                                                                   {Relation::kGreater, ">"},
                                                                   {Relation::kLess, "<"}}};

/// Whether numbers alone can be compared so.
[[nodiscard]] constexpr bool is_ordered(Relation relation) {
  return relation != Relation::kEqual && relation != Relation::kNotEqual;
}

/// null, true or false, a number, a text.
using Literal = std::variant<std::monostate, bool, double, std::string>;

struct Condition {
  std::string text;  ///< as it was written, without spaces around it
  std::vector<Step> path;
  Relation relation = Relation::kGreater;
  Literal value;
};

constexpr std::size_t kMaxConditionsBytes = 16384;  ///< of text
constexpr std::size_t kMaxSteps = 32;               ///< of one path

/// One or more conditions between commas. The text is hostile. Errors: kUsage with what was expected and where.
[[nodiscard]] Result<std::vector<Condition>> parse_conditions(std::string_view text);

/// Whether one of the paths begins with this key.
[[nodiscard]] bool mentions(const std::vector<Condition>& conditions, std::string_view key);

}  // namespace meshlode::app
