// SPDX-License-Identifier: GPL-3.0-or-later
// Validate: every structural rule of the format, each finding with a stable id. Needs the asset alone.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshlode::judge {

/// One broken rule. Ids are stable and listed in docs/reference/rules.md: "L0xx" container, "L1xx" tables, "L2xx"
/// pages, "L3xx" DAG (I4, I5), "L4xx" hierarchy (I8), "L5xx" geometry (I2, I3, I6), "V…" verify against the source.
struct Finding {
  std::string id;         ///< "L301"
  std::string invariant;  ///< "I4", empty for container rules
  std::string where;      ///< "mesh 0, group 17"
  std::string detail;
};

struct ValidationReport {
  std::vector<Finding> findings;     ///< at most kMaxFindingsPerRule of each id are kept…
  std::uint64_t finding_count = 0;   ///< …all are counted
  std::vector<std::string> checked;  ///< ids of the rules that ran
};

/// Never fails: a file that cannot even be opened yields a finding.
[[nodiscard]] ValidationReport validate_asset(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::judge
