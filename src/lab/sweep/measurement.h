// SPDX-License-Identifier: GPL-3.0-or-later
// One finished measurement: what the state file holds, and what the report is made of.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace meshlode::lab {

enum class MeasurementKind : std::uint8_t {
  kBuild,   ///< timed, of one round: a build and loading its asset
  kAsset,   ///< of an asset, the same whenever it is measured
  kDraw,    ///< of a point's pictures, the same whenever they are drawn
  kFrames,  ///< timed, of one round: frames of a point
};

struct SectionBytes {
  std::string name;
  std::uint64_t bytes = 0, bytes_decoded = 0;
};

/// What an asset holds, as info says it.
struct AssetFacts {
  std::string content_hash;
  std::string settings = "{}";  ///< JSON object of META
  std::uint64_t clusters = 0, groups = 0, levels = 0, stuck_groups = 0, stored_triangles = 0, stored_vertices = 0;
  std::vector<std::uint64_t> level_triangles;
  std::vector<SectionBytes> sections;
};

/// A uniform cut of all meshes. Shares of each mesh's diagonal, the worst mesh.
struct CutRow {
  double threshold = 0.0;
  std::uint64_t triangles = 0;
  double stored = 0.0, max = 0.0, rms = 0.0;
  std::optional<double> normal;  ///< degrees
  std::optional<double> uv;      ///< UV units
};

/// The fewest triangles at an equal true deviation.
struct EqualRow {
  std::string figure;                      ///< "max" or "rms"
  double x = 0.0;                          ///< over each mesh's diagonal
  std::optional<std::uint64_t> triangles;  ///< of all meshes; nothing where some mesh has no such cut
  std::optional<double> threshold;         ///< the largest over the meshes, over the diagonal
};

struct PictureRow {
  std::string view;
  std::uint64_t triangles = 0, clusters = 0;
  std::optional<double> psnr;  ///< dB; nothing for equal pictures
  double flip_mean = 0.0, flip_median = 0.0, flip_max = 0.0;
  std::string picture, heat;  ///< paths below the report's folder; empty: none
};

struct Measurement {
  MeasurementKind kind = MeasurementKind::kBuild;
  std::string key;          ///< of the settings: build_key() of kBuild and kAsset, settings_key() of the others
  std::uint32_t round = 0;  ///< of timed ones
  double seconds = 0.0;     ///< wall time that it took to measure
  std::string error;        ///< not empty: it failed, and will again
  std::map<std::string, double> figures;  ///< by the metric's key
  AssetFacts asset;                       ///< of kAsset
  std::vector<CutRow> cuts;               ///< of kAsset
  std::vector<EqualRow> equal;            ///< of kAsset
  std::vector<PictureRow> pictures;       ///< of kDraw
  bool is_stored = false;                 ///< from an earlier run; not written
};

}  // namespace meshlode::lab
