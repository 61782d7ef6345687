// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/metrics.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace meshlode::lab {

namespace {

constexpr std::array<Metric, 23> kMetrics{{
    {"build_user_seconds", "build, processor time", "seconds", true, "build", true,
     "user time of all threads of a build in a process of its own"},
    {"build_wall_seconds", "build, wall time", "seconds", true, "build", true,
     "from the start of the build's process to its end"},
    {"build_peak_bytes", "build, peak memory", "bytes", true, "build", true,
     "high-water mark of the build's process, read every 10 ms"},
    {"file_bytes", "file", "bytes", true, "size", false, "size of the asset on disk"},
    {"geometry_bytes", "geometry on disk", "bytes", true, "size", false,
     "pages and the tables that they need, as info counts them"},
    {"decoded_bytes", "geometry in memory", "bytes", true, "size", false, "pages as a GPU holds them, decoded"},
    {"deviation", "deviation, largest", "share", true, "accuracy", false,
     "finest cut against the source, both ways, over the diagonal, worst mesh: true maximum over samples and vertices"},
    {"deviation_rms", "deviation, RMS", "share", true, "accuracy", false,
     "finest cut against the source, the worse way, over the diagonal, worst mesh"},
    {"normal_rms", "normals, RMS", "degrees", true, "accuracy", false,
     "finest cut against the source, the worse way, worst mesh"},
    {"normal_max", "normals, largest", "degrees", true, "accuracy", false,
     "finest cut against the source, over samples and vertices, worst mesh"},
    {"uv_rms", "UVs, RMS", "UV", true, "accuracy", false, "finest cut against the source, the worse way, worst mesh"},
    {"uv_max", "UVs, largest", "UV", true, "accuracy", false,
     "finest cut against the source, over samples and vertices, worst mesh"},
    {"triangles_at_max", "triangles at largest deviation 0.001", "triangles", true, "triangles", false,
     "fewest over all uniform cuts whose true maximum is within 0.001 of the diagonal, all meshes"},
    {"triangles_at_rms", "triangles at RMS deviation 0.0003", "triangles", true, "triangles", false,
     "fewest over all uniform cuts whose true RMS is within 0.0003 of the diagonal, all meshes"},
    {"load_seconds", "load", "seconds", true, "load", true, "opening the file and checking its tables, file cached"},
    {"decode_seconds", "decode", "seconds", true, "load", true,
     "loading and decoding every cluster with the runtime, one thread"},
    {"cut_triangles", "triangles of the first view", "triangles", true, "picture", false,
     "of the cut at the pixel error, all instances"},
    {"frame_cpu_seconds", "frame, reference rasterizer", "seconds", true, "picture", true,
     "cut and visibility of the first view, all threads, without reading textures"},
    {"frame_vulkan_seconds", "frame, Vulkan", "seconds", true, "picture", true,
     "passes of a frame of the first view by the device's clock"},
    {"psnr", "PSNR", "dB", false, "picture", false,
     "worst view against the full resolution of the baseline; not there where all views are equal"},
    {"flip", "FLIP, mean", "", true, "picture", false, "worst view against the full resolution of the baseline"},
    {"flip_median", "FLIP, weighted median", "", true, "picture", false,
     "worst view against the full resolution of the baseline"},
    {"flip_max", "FLIP, largest", "", true, "picture", false,
     "worst view against the full resolution of the baseline, of one pixel"},
}};

struct ShortWord {
  std::string_view word, key;
};
constexpr std::array<ShortWord, 10> kShortWords{{{"bytes", "file_bytes"},
                                                 {"memory", "decoded_bytes"},
                                                 {"peak", "build_peak_bytes"},
                                                 {"time", "build_user_seconds"},
                                                 {"build", "build_wall_seconds"},
                                                 {"rms", "deviation_rms"},
                                                 {"normal", "normal_rms"},
                                                 {"uv", "uv_rms"},
                                                 {"triangles", "triangles_at_max"},
                                                 {"frame", "frame_cpu_seconds"}}};

}  // namespace

std::span<const Metric> all_metrics() {
  return kMetrics;
}

const Metric* find_metric(std::string_view word) {
  for (const ShortWord& one : kShortWords) {
    if (one.word == word) word = one.key;
  }
  for (const Metric& metric : kMetrics) {
    if (metric.key == word) return &metric;
  }
  return nullptr;
}

std::vector<std::string> metric_words() {
  std::vector<std::string> words;
  words.reserve(kMetrics.size() + kShortWords.size());
  for (const Metric& metric : kMetrics) words.emplace_back(metric.key);
  for (const ShortWord& one : kShortWords) words.emplace_back(one.word);
  return words;
}

Figure figure_of(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {median, values.front(), values.back(), static_cast<std::uint32_t>(values.size())};
}

bool is_assumed(const Metric& metric, const Figure& figure) {
  return metric.is_timed && figure.count < 2 && std::string_view(metric.key) == "build_user_seconds";
}

std::optional<FigureRange> range_of(const Metric& metric, const Figure& figure) {
  if (!metric.is_timed || figure.count >= 2) return FigureRange{figure.min, figure.max};
  if (!is_assumed(metric, figure)) return std::nullopt;  // waiting is in it, and nobody knows how much
  return FigureRange{std::max(0.0, figure.value * (1.0 - kAssumedSpread) - kAssumedSeconds),
                     figure.value * (1.0 + kAssumedSpread) + kAssumedSeconds};
}

bool is_clearly_better(const Metric& metric, const Figure& a, const Figure& b) {
  const auto of_a = range_of(metric, a), of_b = range_of(metric, b);
  if (!of_a || !of_b) return false;
  return metric.is_less_better ? of_a->high < of_b->low : of_a->low > of_b->high;
}

}  // namespace meshlode::lab
