// SPDX-License-Identifier: GPL-3.0-or-later
// The cut of a frame, and the memory for it. One per thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/stream/simulate.h"
#include "run/select/resident.h"

namespace meshlode::app {

/// Which pages are there: as bits for the selection and, to look at, as bytes.
struct ResidentPages {
  std::vector<std::uint32_t> words;
  std::vector<std::uint8_t> is_there;

  explicit ResidentPages(std::size_t count, bool all = false)
      : words((count + 31) / 32, all ? ~0U : 0U), is_there(count, all ? 1 : 0) {}
  void set(std::uint32_t page, bool there) {
    is_there[page] = there ? 1 : 0;
    const std::uint32_t bit = 1U << page % 32;
    words[page / 32] = there ? words[page / 32] | bit : words[page / 32] & ~bit;
  }
};

[[nodiscard]] inline run::Camera camera_of(const StreamScene& scene, const StreamView& view, const PathFrame& frame) {
  run::Camera camera;
  camera.eye = frame.eye;
  camera.target = frame.target;
  camera.fovy = frame.fovy;
  camera.near_distance = view.near_distance > 0.0 ? view.near_distance : 0.01 * scene.object_radius;
  camera.width = view.width;
  camera.height = view.height;
  return camera;
}

class FrameCut {
 public:
  FrameCut(const StreamScene& scene, const StreamView& view)
      : tables_(scene.tables()), pixel_error_(view.pixel_error), selector_(tables_), items_(1024) {}

  /// What is drawn, until the next call. Ascending.
  std::span<const run::ClusterInstance> select(const run::Camera& camera, const ResidentPages& pages, bool is_culled) {
    const run::Frustum frustum = run::frustum_of(camera);
    const run::ResidentQuery query{camera, pixel_error_, pages.words, is_culled ? &frustum : nullptr};
    std::size_t count = selector_.select(tables_, query, items_);
    if (count > items_.size()) {
      items_.resize(count + count / 4);
      count = selector_.select(tables_, query, items_);
    }
    return std::span(items_).first(count);
  }
  [[nodiscard]] const run::ResidentSelector& selector() const { return selector_; }
  [[nodiscard]] const run::SelectTables& tables() const { return tables_; }

 private:
  run::SelectTables tables_;
  double pixel_error_;
  run::ResidentSelector selector_;
  std::vector<run::ClusterInstance> items_;
};

/// The pages of terminal groups of what is drawn.
[[nodiscard]] std::vector<std::uint32_t> root_pages(const StreamScene& scene);

[[nodiscard]] Demand measure_demand(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view,
                                    bool checks, std::vector<std::string>& findings, std::uint64_t& finding_count);
[[nodiscard]] RunResult run_stream(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view,
                                   const RunSpec& spec, const Watch& watch);

/// Counts all, keeps the first ones.
inline void add_finding(std::string text, std::vector<std::string>& findings, std::uint64_t& count) {
  constexpr std::size_t kMostFindings = 20;
  if (count++ < kMostFindings) findings.push_back(std::move(text));
}

}  // namespace meshlode::app
