// SPDX-License-Identifier: GPL-3.0-or-later
// The table of rules and the log that findings go into. An id never changes its meaning; docs/validation.md lists all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "judge/validate/validate.h"

namespace meshlode::judge {

constexpr std::uint32_t kMaxFindingsPerRule = 16;  ///< kept in a report; all are counted

struct Rule {
  std::string_view id;         ///< "L301"
  std::string_view invariant;  ///< "I4", empty where no invariant is named
  std::string_view text;       ///< one line
};

/// Every rule of validate ("L…") and of verify ("V…"), ascending by id.
[[nodiscard]] std::span<const Rule> all_rules();

/// Collects findings. Not for several threads: parallel checks fill slots of their own and are logged in order.
class RuleLog {
 public:
  RuleLog();
  /// Notes that the rule was applied. \pre `id` is in all_rules()
  void check(std::string_view id);
  /// Notes that the rule was applied and broken.
  void add(std::string_view id, std::string where, std::string detail);
  /// check(), and add() where `holds` is false. `where` and `detail` are callables, so that good files cost no strings.
  template <class Where, class Detail>
  bool expect(bool holds, std::string_view id, const Where& where, const Detail& detail) {
    if (holds)
      check(id);
    else
      add(id, where(), detail());
    return holds;
  }

  [[nodiscard]] std::uint64_t finding_count() const { return finding_count_; }
  [[nodiscard]] std::uint64_t count_of(std::string_view id) const;
  [[nodiscard]] std::vector<Finding> take_findings() { return std::move(findings_); }
  [[nodiscard]] std::vector<std::string> checked() const;

 private:
  std::vector<std::uint64_t> counts_;  ///< per rule
  std::vector<bool> checked_;          ///< per rule
  std::vector<Finding> findings_;
  std::uint64_t finding_count_ = 0;
};

/// "group 17", "mesh 0, group 17": places in the words of the format.
[[nodiscard]] std::string place(std::string_view what, std::size_t index);
[[nodiscard]] std::string place(std::string_view what, std::size_t index, std::string_view inner,
                                std::size_t inner_index);
/// "a = x, b = y" of two numbers that should agree.
[[nodiscard]] std::string differs(std::string_view a, double x, std::string_view b, double y);
[[nodiscard]] std::string differs(std::string_view a, std::uint64_t x, std::string_view b, std::uint64_t y);

}  // namespace meshlode::judge
