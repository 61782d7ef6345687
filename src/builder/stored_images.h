// SPDX-License-Identifier: GPL-3.0-or-later
// The blobs as the asset has them: the scene's, or with images that --textures made smaller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/options.h"
#include "builder/plan/plan.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// An image that is not stored as the source has it.
struct SourceImage {
  std::uint32_t blob = 0;
  std::uint64_t bytes = 0;
  std::uint32_t width = 0, height = 0;
  std::string mime_type;
};

struct StoredImages {
  std::vector<scene::SceneBlob> blobs;  ///< empty: the scene's
  std::vector<SourceImage> replaced;    ///< what the source had
};

/// What became of each image is added to `decisions`. Errors: the converter's; kUnsupported where there is none.
[[nodiscard]] Result<StoredImages> store_images(const scene::Scene& scene, const PipelineOptions& options,
                                                std::vector<PlanDecision>& decisions);

}  // namespace meshlode::builder
