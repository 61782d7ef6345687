// SPDX-License-Identifier: GPL-3.0-or-later
// What the frames of a path need: no pool and no link, so frames are looked at side by side.
#include <algorithm>

#include "app/stream/check_cut.h"
#include "app/stream/frame_cut.h"
#include "base/parallel.h"

namespace meshlode::app {

namespace {

struct FrameDemand {
  std::uint64_t bytes = 0, pages = 0, drawn_bytes = 0, group_bytes = 0;
  std::vector<std::string> findings;
};

/// The bytes of all clusters of each group.
std::vector<std::uint64_t> bytes_of_groups(const StreamScene& scene) {
  std::vector<std::uint64_t> bytes(scene.groups.size());
  for (std::size_t c = 0; c < scene.clusters.size(); ++c)
    bytes[scene.clusters[c].coarser_group] += scene.cluster_bytes[c];
  return bytes;
}

/// Marks for one frame, each asked for once however many instances there are.
struct Marks {
  std::vector<std::uint8_t> is_drawn;   ///< per cluster
  std::vector<std::uint8_t> is_needed;  ///< per group: a member is drawn, or one of a finer group
};

void measure_frame(const StreamScene& scene, std::span<const run::ClusterInstance> items,
                   std::span<const float> page_priorities, std::span<const std::uint64_t> group_bytes, Marks& marks,
                   FrameDemand& out) {
  for (std::size_t p = 0; p < page_priorities.size(); ++p) {
    if (!(page_priorities[p] > 0.0F)) continue;
    out.bytes += scene.pages[p].bytes;
    ++out.pages;
  }
  std::fill(marks.is_drawn.begin(), marks.is_drawn.end(), std::uint8_t{0});
  std::fill(marks.is_needed.begin(), marks.is_needed.end(), std::uint8_t{0});
  for (const run::ClusterInstance& item : items) {
    if (marks.is_drawn[item.cluster.value] == 0) out.drawn_bytes += scene.cluster_bytes[item.cluster.value];
    marks.is_drawn[item.cluster.value] = 1;
    marks.is_needed[scene.clusters[item.cluster.value].coarser_group] = 1;
  }
  for (std::size_t c = scene.clusters.size(); c-- > 0;) {  // finer groups have larger ids
    const format::ClusterRecord& cluster = scene.clusters[c];
    if (cluster.own_group != format::kNone) {
      marks.is_needed[cluster.coarser_group] |= marks.is_needed[cluster.own_group];
    }
  }
  for (std::size_t g = 0; g < group_bytes.size(); ++g) out.group_bytes += marks.is_needed[g] != 0 ? group_bytes[g] : 0;
}

}  // namespace

std::vector<std::uint32_t> root_pages(const StreamScene& scene) {
  std::vector<std::uint8_t> is_drawn(scene.meshes.size()), is_root(scene.pages.size());
  for (const format::InstanceRecord& instance : scene.instances) {
    if ((instance.flags & format::kInstanceSingular) == 0) is_drawn[instance.mesh] = 1;
  }
  for (const format::GroupRecord& group : scene.groups) {
    if ((group.flags & format::kGroupTerminal) != 0 && is_drawn[group.mesh] != 0) is_root[group.page] = 1;
  }
  std::vector<std::uint32_t> pages;
  for (std::uint32_t p = 0; p < is_root.size(); ++p) {
    if (is_root[p] != 0) pages.push_back(p);
  }
  return pages;
}

namespace {

/// \param pages  ascending
std::uint64_t count_reads(const StreamScene& scene, std::span<const std::uint32_t> pages) {
  std::vector<std::uint8_t> begins_file(scene.pages.size());
  for (const std::uint32_t mesh : scene.first_mesh_of_file) {
    const std::uint32_t group = mesh < scene.meshes.size() ? scene.meshes[mesh].first_group : format::kNone;
    if (group < scene.groups.size()) begins_file[scene.groups[group].page] = 1;
  }
  std::uint64_t reads = 0;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    reads += i == 0 || pages[i] != pages[i - 1] + 1 || begins_file[pages[i]] != 0 ? 1 : 0;
  }
  return reads;
}

}  // namespace

Demand measure_demand(const StreamScene& scene, std::span<const PathFrame> path, const StreamView& view, bool checks,
                      std::vector<std::string>& findings, std::uint64_t& finding_count) {
  constexpr std::size_t kChunk = 16;  // frames that share a selector
  const std::vector<std::uint64_t> group_bytes = bytes_of_groups(scene);
  const std::size_t chunks = chunk_count(path.size(), kChunk);
  std::vector<FrameDemand> frames(path.size());
  std::vector<std::vector<std::uint8_t>> wanted(chunks);
  const ResidentPages all(scene.pages.size(), true);
  parallel_for_each_chunk(path.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    FrameCut cut(scene, view);
    Marks marks{std::vector<std::uint8_t>(scene.clusters.size()), std::vector<std::uint8_t>(scene.groups.size())};
    wanted[chunk].assign(scene.pages.size(), 0);
    for (std::size_t f = begin; f < end; ++f) {
      const run::Camera camera = camera_of(scene, view, path[f]);
      const auto items = cut.select(camera, all, true);
      const std::span<const float> priorities = cut.selector().page_priorities();
      for (std::size_t p = 0; p < priorities.size(); ++p) {
        if (priorities[p] > 0.0F) wanted[chunk][p] = 1;
      }
      measure_frame(scene, items, priorities, group_bytes, marks, frames[f]);
      if (!checks) continue;
      const run::Frustum frustum = run::frustum_of(camera);
      const auto expected = run::select_bvh(scene.tables(), camera, view.pixel_error, nullptr, {}, &frustum);
      if (!std::equal(items.begin(), items.end(), expected.begin(), expected.end())) {
        frames[f].findings.push_back("frame " + std::to_string(f) + ": with all pages the cut is not that of select");
      }
    }
  });

  Demand demand;
  double drawn = 0.0, loaded = 0.0, groups = 0.0;
  for (const FrameDemand& frame : frames) {
    demand.max_bytes = std::max(demand.max_bytes, frame.bytes);
    demand.max_pages = std::max(demand.max_pages, frame.pages);
    demand.mean_pages += static_cast<double>(frame.pages) / static_cast<double>(path.size());
    loaded += static_cast<double>(frame.bytes);
    drawn += static_cast<double>(frame.drawn_bytes);
    groups += static_cast<double>(frame.group_bytes);
    for (const std::string& text : frame.findings) add_finding(text, findings, finding_count);
  }
  demand.mean_bytes = loaded / static_cast<double>(path.size());
  if (loaded > 0.0) demand.drawn_share = drawn / loaded;
  if (groups > 0.0) demand.whole_group_share = drawn / groups;
  for (std::size_t p = 0; p < scene.pages.size(); ++p) {
    const bool is_wanted = std::any_of(wanted.begin(), wanted.end(), [&](const auto& of) { return of[p] != 0; });
    if (!is_wanted) continue;
    demand.union_bytes += scene.pages[p].bytes;
    ++demand.union_pages;
  }

  ResidentPages roots(scene.pages.size());
  const std::vector<std::uint32_t> root_ids = root_pages(scene);
  demand.root_reads = count_reads(scene, root_ids);
  for (const std::uint32_t page : root_ids) {
    roots.set(page, true);
    demand.root_bytes += scene.pages[page].bytes;
    ++demand.root_pages;
  }
  FrameCut cut(scene, view);
  ErrorMeter meter(view.pixel_error);
  for (const PathFrame& frame : path) {
    const run::Camera camera = camera_of(scene, view, frame);
    meter.add_frame(scene, camera, cut.select(camera, roots, true));
  }
  demand.root_error = meter.result();
  return demand;
}

}  // namespace meshlode::app
