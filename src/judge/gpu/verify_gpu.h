// SPDX-License-Identifier: GPL-3.0-or-later
// All that `verify --gpu` checks on one asset.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/output_files.h"
#include "draw/gpu/vulkan/vulkan.h"
#include "judge/gpu/judge_picture.h"
#include "judge/metrics/metrics.h"
#include "judge/pictures/cameras.h"
#include "judge/pictures/id_judge.h"
#include "judge/validate/rules.h"
#include "run/read/limits.h"

namespace meshlode::judge {

struct PictureSize {
  std::uint32_t width = 0, height = 0;
};

struct GpuVerifyOptions {
  draw::DeviceOptions device;
  std::uint32_t orbits = 6;       ///< cameras around the scene, beside the adversarial ones
  std::vector<NamedCamera> path;  ///< a fly-through, judged as the others are
  double pixel_error = 1.0;
  /// Pictures of each camera; hardware raster draws the first. One has odd sides. \pre not empty
  std::vector<PictureSize> sizes = {{640, 360}, {321, 243}, {128, 512}};
  std::uint64_t max_decoded = run::kDefaultMaxDecoded;  ///< bytes of decoded images
  /// Heat maps (PNG) of the camera with the largest share of its allowance at each size, and of each that failed;
  /// empty: none.
  std::string out_folder;
  OutputFiles* files = nullptr;  ///< what they are written by; null: by an object of their own
};

/// One picture against the source.
struct JudgedCamera {
  NamedCamera camera;
  PictureReport picture;          ///< without its maps
  std::vector<std::string> maps;  ///< files in out_folder
};

struct GpuCheck {
  Rule rule{};
  std::string what;
  std::uint64_t items = 0, failures = 0;
  bool is_skipped = false;
  std::string first{};  ///< the first failure, in words
};

struct GpuVerifyReport {
  draw::DeviceInfo device;
  std::vector<GpuCheck> checks;
  double largest_px = 0.0, largest_share = 0.0;  ///< of all cameras: PictureReport's
  IdTotals surfaces;                             ///< V211, by the device's pictures
  std::vector<JudgedCamera> cameras;
  std::vector<std::string> warnings;  ///< images that could not be read
  std::string plan;                   ///< which passes draw the asset and why, a line each
};

/// `source`: what the asset was built from; without meshes no picture is judged by it. Cuts are chosen, and judged, by
/// the asset's chosen promise. Errors: kUnsupported without a
/// device, kInvalid for a broken page.
[[nodiscard]] Result<GpuVerifyReport> verify_on_gpu(const run::Asset& asset, const scene::Scene& source,
                                                    const GpuVerifyOptions& options);

struct StreamFrameOptions {
  draw::DeviceOptions device;
  std::uint32_t frames = 600;  ///< along a spiral around the scene, from far to close
  double pixel_error = 1.0;    ///< of a picture of 1080 lines, so that as many pages are wanted as there
  double pool_share = 0.25;    ///< slots over pages, at least those of the roots
  /// Small: each frame is drawn by the CPU too.
  PictureSize size = {160, 120};
  std::uint32_t loads_per_frame = 2;  ///< so that frames lack pages
  std::uint64_t max_decoded = run::kDefaultMaxDecoded;
};

struct StreamFramesReport {
  draw::DeviceInfo device;
  GpuCheck check{Rule::kV410, {}};  ///< items: frames; failures: frames with a difference
  std::uint32_t frames = 0, slots = 0, pages = 0;
  std::uint64_t loads = 0, incomplete = 0;  ///< pages; frames that lacked a page
  std::uint64_t spared = 0;                 ///< pages wanted only without culling, over all frames
};
/// Draws from a pool of pages that follows the device's requests in the view volume, and holds every frame, culled and
/// not, against ResidentSelector with the same pages and against the CPU's picture. Errors: as verify_on_gpu().
[[nodiscard]] Result<StreamFramesReport> verify_streaming_on_gpu(const run::Asset& asset,
                                                                 const StreamFrameOptions& options);

}  // namespace meshlode::judge
