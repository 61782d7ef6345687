// SPDX-License-Identifier: GPL-3.0-or-later
// Two assets under one camera, by the reference rasterizer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/compare/compare.h"
#include "camera_options.h"
#include "run/read/asset.h"

namespace meshlode::cli {

struct PairToDraw {
  const run::Asset& before;
  const run::Asset& after;
  std::uint64_t max_decoded = 0;  ///< bytes that the images of one asset may take decoded
};

/// The camera is the options' or, where they name none, the one that frames the old asset; each asset is drawn as
/// `render` draws it, at the same pixel error. What could not be drawn of an image is added to `warnings`.
/// Errors: kUsage for options that make no sense; kInvalid for a broken page; kUnsupported for a cut that is too large.
[[nodiscard]] Result<app::PictureChange> draw_pair(const PairToDraw& pair, const CameraOptions& options,
                                                   std::vector<std::string>& warnings);

}  // namespace meshlode::cli
