// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras on the command line (docs/reference/selection.md): `--camera ex,ey,ez,tx,ty,tz[,fovy_deg[,near]]`, `--ortho
// HEIGHT`,
// `--size WxH`, `--pixel-error t`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <meshlode/result.h>

#include "options.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::cli {

struct CameraOptions {
  std::optional<std::string> camera;   ///< not given: an orbit that frames the scene
  std::optional<double> ortho_height;  ///< world units that the picture's height spans
  std::string size = "1280x720";
  double pixel_error = 1.0;
};
void add_camera_options(OptionParser& parser, CameraOptions& options);
/// The same, with `--camera` added by the caller.
void add_camera_options(OptionParser& parser, CameraOptions& options,
                        const std::function<void(const char* name, const std::string& help)>& add_camera);

/// "1280x720", each 1 to 16384; false for anything else.
[[nodiscard]] bool parse_size(std::string_view text, std::uint32_t& width, std::uint32_t& height);

/// The camera that the options mean for this asset. Errors: kUsage.
[[nodiscard]] Result<run::Camera> make_camera(const CameraOptions& options, const run::Asset& asset);

/// A camera from the front, above and right that frames every instance that can be drawn.
[[nodiscard]] run::Camera frame_scene(const run::Asset& asset, std::uint32_t width, std::uint32_t height);

}  // namespace meshlode::cli
