// SPDX-License-Identifier: GPL-3.0-or-later
// The table of rules and the log that findings go into. An id never changes its meaning; docs/reference/rules.md lists
// all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "judge/validate/validate.h"

namespace meshlode::judge {

constexpr std::uint32_t kMaxFindingsPerRule = 16;  ///< kept in a report; all are counted

// clang-format off
/// The rules of validate ("L…") and verify ("V…"), ascending by id. rules.cpp has a row for each.
enum class Rule : std::uint8_t {
  // container
  kL001, kL002, kL003, kL004, kL005, kL006, kL007, kL008, kL009, kL010, kL011, kL012, kL013, kL014, kL099,
  // tables
  kL101, kL102, kL103, kL104, kL105, kL106, kL107, kL108, kL109, kL110, kL111, kL112, kL113, kL114, kL115, kL116,
  kL117,
  // pages
  kL201, kL202, kL203, kL204, kL205, kL206, kL207, kL208, kL209, kL210, kL211, kL212, kL213, kL214, kL215, kL216,
  kL217,
  // DAG
  kL301, kL302, kL303, kL304, kL305, kL306, kL307, kL308, kL309, kL310, kL311, kL312, kL313,
  // hierarchy
  kL401, kL402, kL403, kL404,
  // geometry
  kL501, kL502, kL503, kL504, kL505, kL506, kL507, kL508, kL509,
  // verify: against the source
  kV101, kV102, kV103, kV104, kV105, kV106, kV107, kV108, kV109, kV110, kV111, kV112, kV113, kV114, kV115,
  // verify: cuts
  kV201, kV202, kV203, kV204, kV205, kV206, kV207, kV208, kV209, kV210, kV211,
  kV212,
  // verify --gpu
  kV401, kV402, kV403, kV404, kV405, kV406, kV409, kV410,  // V407 and V408 are retired, and no other rule gets their ids
};
// clang-format on

struct RuleInfo {
  Rule rule;
  std::string_view id;         ///< "L301"
  std::string_view invariant;  ///< "I4", empty where no invariant is named
  std::string_view text;       ///< one line
};

[[nodiscard]] std::span<const RuleInfo> all_rules();  ///< by Rule
[[nodiscard]] const RuleInfo& info_of(Rule rule);
[[nodiscard]] Finding make_finding(Rule rule, std::string where, std::string detail);

/// Collects findings. Not for several threads: parallel checks fill slots of their own and are logged in order.
class RuleLog {
 public:
  RuleLog();
  /// Notes that the rule was applied.
  void check(Rule rule);
  /// Notes that the rule was applied and broken.
  void add(Rule rule, std::string where, std::string detail);
  /// check(), and add() where `holds` is false. `where` and `detail` are callables, so that good files cost no strings.
  template <class Where, class Detail>
  bool expect(bool holds, Rule rule, const Where& where, const Detail& detail) {
    if (holds)
      check(rule);
    else
      add(rule, where(), detail());
    return holds;
  }

  [[nodiscard]] std::uint64_t finding_count() const { return finding_count_; }
  [[nodiscard]] std::uint64_t count_of(Rule rule) const;
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
