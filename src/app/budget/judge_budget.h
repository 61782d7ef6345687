// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions against a document: `info`'s or `compare`'s. Which keys there are is what the document's published schema
// says, so that a key that is misspelt is found before there is a document, and in lists that are empty too.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/budget/conditions.h"

namespace meshlode::app {

/// docs/schemas/info.schema.json, compare.schema.json and golden.schema.json, as they were when the program was built.
[[nodiscard]] std::string_view info_schema();
[[nodiscard]] std::string_view compare_schema();
[[nodiscard]] std::string_view golden_schema();

/// parse_conditions(), and each path leads to a value of the schema. Errors: kUsage; for a key that there is not, with
/// the nearest that there is.
[[nodiscard]] Result<std::vector<Condition>> read_budget(std::string_view text, std::string_view schema);

/// A condition that holds, which for a budget is the bad news.
struct BrokenCondition {
  std::string condition;     ///< as it was written
  std::string where;         ///< the first place where it holds: `meshes[3].stuck_groups`
  std::string name;          ///< of the innermost element of a list on the way there that has one; may be empty
  std::string value;         ///< what is there, as JSON
  std::uint64_t others = 0;  ///< further elements for which it holds

  /// "budget exceeded: any(meshes).stuck_groups>0: meshes[3].stuck_groups (rock) is 2, and 1 more"
  [[nodiscard]] std::string message() const;
};

/// Those of the conditions that hold. What is null, or not there, is larger than any number, and equal to null alone:
/// a figure that is infinite or not known breaks the budget that bounds it.
/// Errors: kUsage for an index or a name in square brackets that the document has not (an element of any(…) or all(…)
/// that has not does not hold); kInvalid for text that is no JSON.
[[nodiscard]] Result<std::vector<BrokenCondition>> judge_budget(const std::vector<Condition>& conditions,
                                                                std::string_view document);

/// All of them as one failure of a check. \pre not empty
[[nodiscard]] Error budget_error(const std::vector<BrokenCondition>& broken, std::string where);

}  // namespace meshlode::app
