// SPDX-License-Identifier: GPL-3.0-or-later
// Attribute bounds on the command line: `--normal-error DEG`, `--uv-error UV`, beside an error or a camera.
#pragma once

#include <optional>

#include <meshlode/result.h>

#include "options.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::cli {

struct BoundsOptions {
  std::optional<double> normal_error;  ///< degrees
  std::optional<double> uv_error;      ///< UV units
  [[nodiscard]] bool has_any() const { return normal_error || uv_error; }
};
void add_bounds_options(OptionParser& parser, BoundsOptions& options);

/// Errors: kUsage for numbers that make no sense; kUnsupported where a mesh has the attribute and the asset does not
/// say how far it deviates.
[[nodiscard]] Result<run::AttributeBounds> make_bounds(const BoundsOptions& options, const run::Asset& asset);

}  // namespace meshlode::cli
