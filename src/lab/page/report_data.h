// SPDX-License-Identifier: GPL-3.0-or-later
// What the report of a sweep shows: what sweep.json says (docs/schemas/sweep.schema.json) as plain values, and the
// pictures that it names. Texts come from files and are nothing that may be trusted; numbers are finite.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/doctor/diagnosis.h"

namespace meshlode::lab::page {

/// One measured number. Without a spread `low` and `high` are the value.
struct Figure {
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< of the `count` measurements
  std::uint64_t count = 1;
  struct Range {
    double low = 0.0, high = 0.0;
  };
  std::optional<Range> range = std::nullopt;  ///< what a timed one is compared by; nothing: it is not compared
};

/// One thing that is measured of every point.
struct Metric {
  std::string key, title;
  std::string unit;  ///< seconds, bytes, triangles, dB, degrees, UV, share, or empty
  std::string group;
  std::string description;
  bool is_less_better = true;
  bool is_timed = false;
};

struct Knob {
  std::string name, title, option, unit, usual;
  std::vector<std::string> values;  ///< in their own order
};

struct View {
  std::string name;
  std::string picture;  ///< path below the report's folder; empty where there is none
};

/// A uniform cut; lengths over the diagonal of a mesh.
struct Cut {
  double threshold = 0.0, stored = 0.0, max = 0.0, rms = 0.0;
  std::uint64_t triangles = 0;
};

/// The fewest triangles within a true deviation; none where no cut is.
struct EqualDeviation {
  bool is_rms = false;
  double deviation = 0.0;
  std::optional<std::uint64_t> triangles;
};

struct CutPicture {
  std::string view;
  std::uint64_t triangles = 0, clusters = 0;
  std::optional<double> psnr;  ///< dB; none: the same picture
  double flip_mean = 0.0, flip_median = 0.0, flip_max = 0.0;
  std::string picture, heat;  ///< paths below the report's folder; empty where there is none
};

/// A part of an asset's file.
struct ByteShare {
  std::string name;
  std::uint64_t bytes = 0, decoded_bytes = 0;
};

/// One asset that was built and measured.
struct Point {
  std::string id, label, why, command, draw_command;
  std::map<std::string, std::string> settings;  ///< by the knob's name
  std::vector<std::string> changed;             ///< knobs
  std::optional<std::string> error;             ///< why it failed
  std::string content_hash, same_asset_as;      ///< empty where there is none
  std::string error_tier;                       ///< as the asset records it, whatever the setting left open
  bool is_experimental = false;
  std::map<std::string, Figure> figures;  ///< by the metric's key
  std::vector<ByteShare> sections;
  std::vector<Cut> cuts;
  std::vector<EqualDeviation> equal;
  std::vector<CutPicture> pictures;
  std::vector<std::string> dominated_by;  ///< ids
};

struct LeftOut {
  std::string label, reason, command;
  double estimated_seconds = 0.0;
};

/// Points that no other beats in both metrics.
struct Frontier {
  std::string x, y;                 ///< keys of metrics
  std::vector<std::string> points;  ///< ids, by ascending x
};

struct Recommendation {
  std::string want, goal, why;
  std::optional<std::string> point, command;
  std::optional<double> value;
  std::vector<std::string> as_good, not_compared = {};  ///< ids
};

/// What doctor finds in the scene. A cost beyond what a number can say is infinite.
struct SceneFaults {
  std::string command;                 ///< that tells more of them
  std::vector<app::Diagnosis> ranked;  ///< without their triangles
};

struct ReportData {
  std::string scene_file, scene_hash;
  std::uint64_t meshes = 0, instances = 0, triangles = 0, vertices = 0;
  std::string program_version, program_id;
  std::string machine, system, vulkan, vulkan_reason;
  std::uint64_t threads = 0, memory_bytes = 0;
  std::string command;
  std::optional<double> budget_seconds;
  double spent_seconds = 0.0;
  std::uint64_t rounds = 0, samples = 0, seed = 0;
  bool is_complete = true;
  std::string baseline;  ///< id
  std::vector<Knob> knobs;
  std::vector<Metric> metrics;
  std::vector<View> views;
  std::vector<Point> points;
  std::vector<LeftOut> left_out;
  std::vector<Frontier> frontiers;
  std::vector<Recommendation> recommendations;
  std::optional<SceneFaults> scene_faults;  ///< none: the scene was not examined

  /// PNG files by their path below the report's folder. One that is named and not here is not shown.
  std::map<std::string, std::vector<std::uint8_t>> pictures;

  [[nodiscard]] const Point* find_point(const std::string& id) const {
    for (const Point& point : points) {
      if (point.id == id) return &point;
    }
    return nullptr;
  }
  [[nodiscard]] const Metric* find_metric(const std::string& key) const {
    for (const Metric& metric : metrics) {
      if (metric.key == key) return &metric;
    }
    return nullptr;
  }
};

}  // namespace meshlode::lab::page
