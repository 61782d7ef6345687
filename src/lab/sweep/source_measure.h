// SPDX-License-Identifier: GPL-3.0-or-later
// What an asset is worth, against its source: the same figures that bench_quality, verify and info have.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "lab/sweep/measurement.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::lab {

/// At how many true deviations the fewest triangles are looked for: most of the time of a measurement.
enum class Searches : std::uint8_t { kAll, kFew };

/// A scene's meshes made ready to be measured from, each when it is first asked for.
class SourceMeasure {
 public:
  /// `samples`: area-uniform ones each way, all vertices on top. \pre the scene outlives this
  SourceMeasure(const scene::Scene& source, std::uint64_t samples, Searches searches = Searches::kAll);
  ~SourceMeasure();
  SourceMeasure(SourceMeasure&&) noexcept;

  /// Fills figures, asset, cuts and equal of `out`. Errors: kInvalid for a broken page or where scene and asset have
  /// different numbers of meshes; kUnsupported where the asset decodes to more than it may.
  [[nodiscard]] Status measure(const run::Asset& asset, Measurement& out);

 private:
  struct Mesh;
  const scene::Scene& source_;
  std::uint64_t samples_;
  Searches searches_;
  std::vector<std::unique_ptr<Mesh>> meshes_;
};

/// Hexadecimal: of what an asset decodes to.
[[nodiscard]] std::string content_hash_of(const run::Asset& asset);

/// What an asset holds, as info says it, and its sizes alone: fills asset and those figures of `out`.
void describe_sizes(const run::Asset& asset, Measurement& out);

/// Takes what does not depend on how pages are stored from a measurement of an asset with the same content.
void take_content_figures(const Measurement& from, Measurement& out);

}  // namespace meshlode::lab
