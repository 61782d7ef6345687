// SPDX-License-Identifier: GPL-3.0-or-later
// Assets under the same cameras, by the reference rasterizer, and the pictures held against others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/compare/compare.h"
#include "camera_options.h"
#include "draw/raster/raster.h"
#include "run/read/asset.h"

namespace meshlode::cli {

/// `--camera` any number of times; none: the one that frames the asset. The rest are those of one camera.
struct ViewOptions {
  std::vector<std::string> cameras;
  CameraOptions common;
  std::uint64_t max_decoded = 0;  ///< bytes that the images of one asset may take decoded
};

/// The options that add_camera_options() adds, `--camera` as one that may be repeated.
void add_view_options(OptionParser& parser, ViewOptions& options);

/// Errors: kUsage for options that make no sense.
[[nodiscard]] Result<std::vector<run::Camera>> make_cameras(const ViewOptions& options, const run::Asset& asset);

struct DrawnView {
  draw::Image image;
  std::uint64_t triangles = 0, clusters = 0;  ///< of the cut
};

/// The asset as `render` draws it, once per camera. What could not be drawn of an image is added to `warnings`.
/// Errors: kInvalid for a broken page; kUnsupported for a cut that is too large.
[[nodiscard]] Result<std::vector<DrawnView>> draw_views(const run::Asset& asset,
                                                        const std::vector<run::Camera>& cameras,
                                                        const ViewOptions& options, std::vector<std::string>& warnings);

struct ComparedPicture {
  app::PictureChange change;
  draw::Image heat;  ///< FLIP per pixel; of no size for equal pictures
};
/// \pre both have one size
[[nodiscard]] ComparedPicture compare_images(const draw::Image& before, const draw::Image& after);

}  // namespace meshlode::cli
