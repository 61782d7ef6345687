// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan saves, measured: the scene is built by it and with everything kept, in turn, and both assets are counted
// and drawn.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <meshlode/result.h>

#include "base/json_writer.h"
#include "builder/builder.h"
#include "scene/scene.h"

namespace meshlode::cli {

/// One of the two assets.
struct MeasuredAsset {
  std::string name;  ///< "plan", "keep_all"
  std::uint64_t file_bytes = 0, geometry_bytes = 0;
  std::vector<std::pair<std::string, std::uint64_t>> sections;  ///< stored bytes, in the file's order
  std::vector<std::pair<std::string, double>> streams;          ///< bytes of decoded pages by what they say
  std::uint64_t frame_triangles = 0;                            ///< of the cut that is drawn
  std::vector<double> build_seconds;                            ///< wall time, import left out; a round each
  std::vector<double> cpu_frame_ms;                             ///< selection, rasterizer and shading of the CPU
  std::vector<double> gpu_frame_ms;  ///< of the device, without resolving colours; empty without one
};

struct PlanMeasurement {
  std::array<MeasuredAsset, 2> assets;
  std::uint32_t width = 0, height = 0;
  std::string device;            ///< name of the Vulkan device; empty without one
  std::string no_device;         ///< why there is none
  bool is_same_content = false;  ///< nothing is left out: the content hashes are equal
};

struct MeasureOptions {
  std::uint32_t rounds = 3;
  std::string device;                                     ///< draw::GpuRenderOptions::device
  std::uint64_t max_decoded = std::uint64_t{512} << 20U;  ///< of images
};

/// Errors: those of a build.
[[nodiscard]] Result<PlanMeasurement> measure_plan(const scene::Scene& scene, const builder::PipelineOptions& options,
                                                   const MeasureOptions& measure);

[[nodiscard]] std::string describe_measurement(const PlanMeasurement& measured);
/// An object.
void write_measurement(JsonWriter& json, const PlanMeasurement& measured);

}  // namespace meshlode::cli
