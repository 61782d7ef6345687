// SPDX-License-Identifier: GPL-3.0-or-later
// The pages that a cut needs, loaded once.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "run/decode/decode.h"
#include "run/select/select.h"

namespace meshlode::draw {

class CutPages {
 public:
  /// Errors: kUsage for an id that the asset does not have, or a cluster of another mesh than the instance's; kInvalid
  /// for a broken page.
  [[nodiscard]] static Result<CutPages> load(const run::Asset& asset, std::span<const run::ClusterInstance> cut);

  /// \pre `cluster` is of the cut
  void decode(const run::Asset& asset, ClusterId cluster, run::DecodedCluster& out) const;

 private:
  std::vector<std::optional<run::PageBytes>> pages_;
};

}  // namespace meshlode::draw
