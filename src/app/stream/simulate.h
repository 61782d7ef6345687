// SPDX-License-Identifier: GPL-3.0-or-later
// A camera moves, pages arrive over a link into a pool of fixed size, and each frame draws the finest closed cut of
// what is there (run/select/resident.h). What that takes and what it shows, without a renderer.
//
// Per frame, in this order: pages that have arrived become resident; the cut is chosen, its error is measured; pages
// are requested, those first without which most is lost. A request is sent where the link is free before the next
// frame begins and the pool has room, or has a page that is worth less: pages make place by falling worth, of equal
// worth the longest unused first, then by falling id. The link sends one page after the other; a page arrives its
// latency after its last byte. Pages of terminal groups are there from the start and stay. Times are whole
// microseconds.
//
// The selection's rules alone are used. There is no occlusion: what lies behind something is loaded and drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/stream/camera_path.h"
#include "app/stream/error_shown.h"
#include "app/stream/scene.h"

namespace meshlode::app {

struct StreamView {
  std::uint32_t width = 1920, height = 1080;
  double pixel_error = 1.0;    ///< above 0
  double near_distance = 0.0;  ///< world units; 0: a hundredth of the largest object's radius
  std::uint32_t fps = 60;      ///< 1 to 1000
};

struct Link {
  double megabytes_per_second = 50.0;  ///< 10^6 bytes, above 0
  double latency_ms = 5.0;
};

struct RunSpec {
  std::optional<std::uint64_t> pool_bytes;  ///< decoded; none: room for all
  Link link;
};

/// What the frames need, whatever pool and link there are: with all pages resident.
struct Demand {
  double mean_bytes = 0.0, mean_pages = 0.0;  ///< decoded, of pages that a frame needs
  std::uint64_t max_bytes = 0, max_pages = 0;
  std::uint64_t union_bytes = 0, union_pages = 0;  ///< of the whole path
  double drawn_share = 0.0;                      ///< bytes of drawn clusters over those of needed pages, of all frames
  double whole_group_share = 0.0;                ///< the same if each group were a page
  std::uint64_t root_bytes = 0, root_pages = 0;  ///< what is always there
  std::uint64_t root_reads = 0;                  ///< that get it: neighbours in a file share one
  ErrorShown root_error;                         ///< of the path with these pages alone
};

/// How long after a jump no more than an error was shown.
struct Recovery {
  std::uint32_t jumps = 0, not_reached = 0;  ///< not before the next jump or the end
  double mean_ms = 0.0, max_ms = 0.0;        ///< of those that were
};

struct Transfer {
  std::uint32_t page = 0;
  std::int64_t sent_us = 0, arrival_us = 0;
  std::vector<std::uint32_t> evicted;  ///< for its place, in order
};

struct RunResult {
  bool fits = true;  ///< else the pool has no room for the roots, and nothing else is set
  std::uint64_t loaded_bytes = 0, requests = 0, reloads = 0;  ///< stored bytes
  double mean_megabytes = 0.0, mean_requests = 0.0;           ///< a second
  std::uint64_t worst_bytes = 0, worst_requests = 0;          ///< the worst second that begins at a whole one
  std::uint64_t peak_pool_bytes = 0;
  Recovery asked, fourfold;  ///< until the pixel error, and four times as much, is shown
  ErrorShown error;
  std::vector<float> max_px;                 ///< of each frame
  std::vector<std::uint32_t> missing_pages;  ///< of each frame, after what had arrived
  std::vector<Transfer> log;
  std::vector<std::vector<std::uint32_t>> drawn_pages;  ///< of each frame, ascending; where they are kept
  std::vector<std::string> findings;                    ///< of the checks, at most 20
  std::uint64_t finding_count = 0, checked_frames = 0;
};

struct Simulation {
  Demand demand;
  std::vector<RunResult> runs;        ///< as the specs
  std::vector<std::string> findings;  ///< of the frames with all pages resident
  std::uint64_t finding_count = 0;
};

struct Watch {
  bool checks = false;             ///< what is drawn is held against the definition in every frame (check_cut.h)
  bool keeps_drawn_pages = false;  ///< RunResult::drawn_pages
};

/// Frames and runs side by side; no byte depends on how many. Memory: docs/reference/streaming.md.
[[nodiscard]] Simulation simulate(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view,
                                  std::span<const RunSpec> specs, const Watch& watch = {});

}  // namespace meshlode::app
