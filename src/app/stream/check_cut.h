// SPDX-License-Identifier: GPL-3.0-or-later
// Is a cut of what is resident right? By definition, over all groups and clusters of every instance: it shares no code
// with the selection but the test whether one group passes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/stream/scene.h"
#include "run/select/select.h"

namespace meshlode::app {

class CutCheck {
 public:
  explicit CutCheck(const StreamScene& scene);

  /// What is wrong with `items`, which are ascending and not culled; nothing where all holds:
  /// every drawn cluster's page is resident; on every path from level 0 to a root exactly one cluster is drawn; no
  /// drawn cluster could be replaced by finer ones: a page of its own group or of one above that is missing, or it
  /// passes. \param is_resident  per page
  [[nodiscard]] std::optional<std::string> find_fault(const run::Camera& camera, double pixel_error,
                                                      std::span<const std::uint8_t> is_resident,
                                                      std::span<const run::ClusterInstance> items);

 private:
  [[nodiscard]] std::optional<std::string> check_paths(const format::MeshRecord& mesh, std::uint32_t instance);

  const StreamScene& scene_;
  std::vector<std::uint8_t> is_drawn_;    ///< per cluster
  std::vector<std::uint8_t> above_;       ///< per group: clusters drawn on a path from above, or kUnknown
  std::vector<std::uint8_t> is_blocked_;  ///< per group: its page or that of one above is missing
};

}  // namespace meshlode::app
