// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a point against those of the full resolution, and how long a frame takes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/raster.h"
#include "draw/textures/image_budget.h"
#include "lab/flip/flip.h"
#include "lab/sweep/measurement.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::lab {

struct View {
  std::string name;
  run::Camera camera;
};
/// The camera that frames the asset, and the same direction from three times as far.
[[nodiscard]] std::vector<View> make_views(const run::Camera& framing);

/// Puts a PNG at a path below the report's folder. Errors: as the file's.
using WritePicture = std::function<Status(const std::string& path, const draw::Image& image)>;

/// What every point is drawn with, and held against.
struct ViewSet {
  std::vector<View> views;
  std::vector<draw::Image> full;          ///< of the baseline, the finest cut
  std::vector<FlipReference> references;  ///< the same
  std::uint64_t max_decoded = 0;          ///< bytes of decoded images
};

/// Draws `full`. Errors: as draw_cut().
[[nodiscard]] Status draw_full(const run::Asset& baseline, ViewSet& set);

/// Fills figures and pictures of `out`; pictures are named after `id`.
[[nodiscard]] Status draw_point(const run::Asset& asset, const ViewSet& set, double pixel_error, const std::string& id,
                                const WritePicture& write, Measurement& out);

/// Frames of the first view: one on the CPU, and the last of four on a device where there is one.
[[nodiscard]] Status time_frames(const run::Asset& asset, const ViewSet& set, double pixel_error, bool has_device,
                                 Measurement& out);

struct DeviceAnswer {
  std::string name;    ///< empty: none
  std::string reason;  ///< why there is none
};
/// Asked by drawing: a device that cannot draw this asset is none.
[[nodiscard]] DeviceAnswer ask_device(const run::Asset& asset, const ViewSet& set);

}  // namespace meshlode::lab
