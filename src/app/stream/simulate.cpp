// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/simulate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "app/stream/check_cut.h"
#include "app/stream/frame_cut.h"
#include "base/parallel.h"

namespace meshlode::app {

namespace {

constexpr std::int64_t kSecond = 1000000;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

/// How long bytes are on a link, rounded up; at most a year, so that sums of times stay far from overflow.
std::int64_t transfer_us(std::uint64_t bytes, const Link& link) {
  constexpr double kYear = 365.0 * 86400.0 * 1e6;
  return static_cast<std::int64_t>(std::min(std::ceil(static_cast<double>(bytes) / link.megabytes_per_second), kYear));
}

/// Pages that are there or on their way, and the room that they take.
class Pool {
 public:
  Pool(const StreamScene& scene, const RunSpec& spec, RunResult& result)
      : scene_(scene),
        spec_(spec),
        result_(result),
        capacity_(spec.pool_bytes.value_or(std::numeric_limits<std::uint64_t>::max())),
        pages_(scene.pages.size()),
        arrival_us_(scene.pages.size(), kNever),
        last_used_(scene.pages.size(), -1),
        was_loaded_(scene.pages.size()) {}

  [[nodiscard]] const ResidentPages& resident() const { return pages_; }
  [[nodiscard]] std::int64_t arrival_us(std::uint32_t page) const { return arrival_us_[page]; }

  /// False: there is no room for it.
  bool put_root(std::uint32_t page) {
    arrival_us_[page] = 0;
    pages_.set(page, true);
    return take_room(page);
  }

  void receive(std::int64_t now_us) {
    for (; !on_the_way_.empty() && arrival_us_[on_the_way_.front()] <= now_us; on_the_way_.pop_front()) {
      pages_.set(on_the_way_.front(), true);
    }
  }

  /// The frame's requests, by falling priority, as far as the link is free before `next_us`.
  void send(std::span<const run::PageRequest> requests, std::span<const float> priorities, std::int64_t frame,
            std::int64_t now_us, std::int64_t next_us) {
    for (std::size_t p = 0; p < priorities.size(); ++p) {
      if (priorities[p] > 0.0F) last_used_[p] = frame;
    }
    victims_.clear();
    next_victim_ = 0;
    has_victims_ = false;
    link_free_us_ = std::max(link_free_us_, now_us);
    for (const run::PageRequest& request : requests) {
      if (link_free_us_ >= next_us) return;
      if (arrival_us_[request.page] != kNever) continue;  // on its way
      Transfer transfer{request.page, link_free_us_, 0, {}};
      if (!make_room(request, priorities, transfer.evicted)) return;
      const std::uint64_t stored = scene_.pages[request.page].stored_bytes;
      link_free_us_ += transfer_us(stored, spec_.link);
      transfer.arrival_us = link_free_us_ + static_cast<std::int64_t>(std::llround(spec_.link.latency_ms * 1000.0));
      arrival_us_[request.page] = transfer.arrival_us;
      on_the_way_.push_back(request.page);
      result_.loaded_bytes += stored;
      ++result_.requests;
      result_.reloads += was_loaded_[request.page];
      was_loaded_[request.page] = 1;
      result_.log.push_back(std::move(transfer));
    }
  }

 private:
  bool take_room(std::uint32_t page) {
    used_ += scene_.pages[page].bytes;
    result_.peak_pool_bytes = std::max(result_.peak_pool_bytes, used_);
    return used_ <= capacity_;
  }

  /// Takes pages away that are worth less than the request. False, and nothing is taken away: that is not enough.
  bool make_room(const run::PageRequest& request, std::span<const float> priorities,
                 std::vector<std::uint32_t>& evicted) {
    const std::uint64_t needed = scene_.pages[request.page].bytes;
    std::uint64_t free = capacity_ - used_;
    std::size_t end = next_victim_;
    while (free < needed) {
      if (!has_victims_) sort_victims(priorities);
      if (end == victims_.size() || priorities[victims_[end]] >= request.priority) return false;
      free += scene_.pages[victims_[end++]].bytes;
    }
    for (; next_victim_ < end; ++next_victim_) {
      const std::uint32_t page = victims_[next_victim_];
      pages_.set(page, false);
      arrival_us_[page] = kNever;
      used_ -= scene_.pages[page].bytes;
      evicted.push_back(page);
    }
    return take_room(request.page);
  }

  void sort_victims(std::span<const float> priorities) {
    has_victims_ = true;
    for (std::uint32_t p = 0; p < pages_.is_there.size(); ++p) {
      if (pages_.is_there[p] != 0) victims_.push_back(p);
    }
    std::sort(victims_.begin(), victims_.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (priorities[a] != priorities[b]) return priorities[a] < priorities[b];
      if (last_used_[a] != last_used_[b]) return last_used_[a] < last_used_[b];
      return a > b;
    });
  }

  const StreamScene& scene_;
  const RunSpec& spec_;
  RunResult& result_;
  std::uint64_t capacity_, used_ = 0;
  ResidentPages pages_;
  std::vector<std::int64_t> arrival_us_;  ///< of what is there or on its way; kNever
  std::vector<std::int64_t> last_used_;   ///< frame
  std::vector<std::uint8_t> was_loaded_;
  std::deque<std::uint32_t> on_the_way_;  ///< as they arrive
  std::vector<std::uint32_t> victims_;    ///< of this frame, worth least first
  std::size_t next_victim_ = 0;
  bool has_victims_ = false;
  std::int64_t link_free_us_ = 0;
};

std::vector<std::uint32_t> pages_of(const StreamScene& scene, std::span<const run::ClusterInstance> items) {
  std::vector<std::uint32_t> pages;
  for (const run::ClusterInstance& item : items) {
    const std::uint32_t page = scene.groups[scene.clusters[item.cluster.value].coarser_group].page;
    if (pages.empty() || pages.back() != page) pages.push_back(page);
  }
  std::sort(pages.begin(), pages.end());
  pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
  return pages;
}

/// From the errors of the frames: how long after each jump they are within `limit_px`.
Recovery recovery_of(std::span<const PathFrame> path, std::span<const float> max_px, double limit_px) {
  Recovery out;
  double sum = 0.0;
  for (std::size_t f = 0; f < path.size(); ++f) {
    if (!path[f].is_jump) continue;
    ++out.jumps;
    std::size_t end = f;
    while (end < path.size() && (end == f || !path[end].is_jump) && is_over(double{max_px[end]}, limit_px)) ++end;
    if (end == path.size() || (end > f && path[end].is_jump)) {
      ++out.not_reached;
      continue;
    }
    const double ms = static_cast<double>(path[end].time_us - path[f].time_us) / 1000.0;
    sum += ms;
    out.max_ms = std::max(out.max_ms, ms);
  }
  if (out.jumps > out.not_reached) out.mean_ms = sum / (out.jumps - out.not_reached);
  return out;
}

void sum_load(const StreamScene& scene, std::int64_t length_us, RunResult& result) {
  std::vector<std::uint64_t> bytes(static_cast<std::size_t>(length_us / kSecond) + 1), requests(bytes.size());
  for (const Transfer& transfer : result.log) {
    const auto second = std::min(static_cast<std::size_t>(transfer.sent_us / kSecond), bytes.size() - 1);
    bytes[second] += scene.pages[transfer.page].stored_bytes;
    ++requests[second];
  }
  result.worst_bytes = *std::max_element(bytes.begin(), bytes.end());
  result.worst_requests = *std::max_element(requests.begin(), requests.end());
  const double seconds = static_cast<double>(length_us) / kSecond;
  result.mean_megabytes = static_cast<double>(result.loaded_bytes) / 1e6 / seconds;
  result.mean_requests = static_cast<double>(result.requests) / seconds;
}

}  // namespace

RunResult run_stream(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view,
                     const RunSpec& spec, const Watch& watch) {
  RunResult result;
  Pool pool(scene, spec, result);
  for (const std::uint32_t page : root_pages(scene)) {
    if (pool.put_root(page)) continue;
    result.fits = false;
    return result;
  }
  FrameCut cut(scene, view);
  std::optional<CutCheck> check;
  if (watch.checks) check.emplace(scene);
  ErrorMeter meter(view.pixel_error);
  const std::int64_t frame_us = kSecond / view.fps;
  for (std::size_t f = 0; f < path.size(); ++f) {
    const std::int64_t now_us = path[f].time_us;
    const std::int64_t next_us = f + 1 < path.size() ? path[f + 1].time_us : now_us + frame_us;
    pool.receive(now_us);
    const run::Camera camera = camera_of(scene, view, path[f]);
    if (check) {
      const auto fault = check->find_fault(camera, view.pixel_error, pool.resident().is_there,
                                           cut.select(camera, pool.resident(), false));
      ++result.checked_frames;
      if (fault) add_finding("frame " + std::to_string(f) + ": " + *fault, result.findings, result.finding_count);
    }
    const auto items = cut.select(camera, pool.resident(), true);
    if (check) {
      for (const run::ClusterInstance& item : items) {
        const std::uint32_t page = scene.groups[scene.clusters[item.cluster.value].coarser_group].page;
        if (pool.arrival_us(page) <= now_us) continue;
        add_finding("frame " + std::to_string(f) + ": page " + std::to_string(page) + " is drawn before it arrives",
                    result.findings, result.finding_count);
        break;
      }
    }
    if (watch.keeps_drawn_pages) result.drawn_pages.push_back(pages_of(scene, items));
    result.max_px.push_back(meter.add_frame(scene, camera, items));
    result.missing_pages.push_back(static_cast<std::uint32_t>(cut.selector().requests().size()));
    pool.send(cut.selector().requests(), cut.selector().page_priorities(), static_cast<std::int64_t>(f), now_us,
              next_us);
  }
  if (check && spec.pool_bytes && result.peak_pool_bytes > *spec.pool_bytes) {
    add_finding("the pool holds more than it has room for", result.findings, result.finding_count);
  }
  sum_load(scene, path.back().time_us + frame_us, result);
  result.error = meter.result();
  result.asked = recovery_of(path, result.max_px, view.pixel_error);
  result.fourfold = recovery_of(path, result.max_px, 4.0 * view.pixel_error);
  return result;
}

Simulation simulate(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view,
                    std::span<const RunSpec> specs, const Watch& watch) {
  Simulation out;
  out.demand = measure_demand(scene, path, view, watch.checks, out.findings, out.finding_count);
  out.runs.resize(specs.size());
  parallel_for_each_index(specs.size(), 1,
                          [&](std::size_t i) { out.runs[i] = run_stream(scene, path, view, specs[i], watch); });
  return out;
}

}  // namespace meshlode::app
