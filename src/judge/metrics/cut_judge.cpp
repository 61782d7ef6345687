// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/cut_judge.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kChunk = 1024;
constexpr std::size_t kMaxSuspects = 256;
constexpr double kAreaKept = 0.75;

}  // namespace

CutSource::CutSource(const Surface& source, std::uint64_t sample_target) : samples(sample_target), tree(source) {
  const AreaSamples area_samples(source, samples, 1);
  sample_count = static_cast<std::size_t>(area_samples.count());
  for (std::size_t i = 0; i < sample_count; ++i) points.push_back(area_samples.position(area_samples.sample(i)));
  for (const std::uint32_t v : used_vertices(source)) points.push_back(source.positions[v]);
  if (area_samples.area() > 0.0) density = static_cast<double>(samples) / (kAreaKept * area_samples.area());
}

CutJudge::CutJudge(std::shared_ptr<const CutSource> source, const run::Asset& asset,
                   std::span<const run::DecodedCluster> decoded, MeshId mesh)
    : source_(std::move(source)), asset_(asset), decoded_(decoded), mesh_(mesh) {
  clusters_.resize(asset.clusters().size());
}

CutJudge::CutJudge(const Surface& source, const run::Asset& asset, std::span<const run::DecodedCluster> decoded,
                   MeshId mesh, std::uint64_t samples)
    : CutJudge(std::make_shared<const CutSource>(source, samples), asset, decoded, mesh) {}

CutJudge::ClusterFigures CutJudge::measure_cluster(ClusterId cluster) const {
  const Surface surface = surface_of_clusters(asset_, decoded_, mesh_, std::span(&cluster, 1));
  ClusterFigures out;
  out.is_known = true;
  const double area = AreaSamples(surface, 0, 0).area();
  const AreaSamples samples(surface, static_cast<std::uint64_t>(std::ceil(area * source_->density)), cluster.value + 2);
  std::uint32_t hint = 0xFFFFFFFFu;
  const auto distance2 = [&](const Vec3d& p) {
    const NearestPoint nearest = source_->tree.nearest(p, hint);
    hint = nearest.triangle;
    out.max2 = std::max(out.max2, nearest.distance2);
    return nearest.distance2;
  };
  double sum2 = 0.0;
  for (std::uint64_t i = 0; i < samples.count(); ++i) sum2 += distance2(samples.position(samples.sample(i)));
  for (const std::uint32_t v : used_vertices(surface)) (void)distance2(surface.positions[v]);
  out.area = area;
  out.mean2 = samples.count() > 0 ? sum2 / static_cast<double>(samples.count()) : 0.0;
  return out;
}

CutJudge::Forward CutJudge::measure_to_cut(const TriangleTree& cut, const Limit& limit,
                                           std::vector<std::uint32_t>* worst) const {
  const double max2 = limit.max * limit.max;
  const double sum2 = limit.rms * limit.rms * static_cast<double>(source_->sample_count);
  struct Partial {
    double sum2 = 0.0, max2 = -1.0;
    std::uint32_t worst = 0;
  };
  std::vector<Partial> partials((source_->points.size() + kChunk - 1) / kChunk);
  std::atomic<bool> is_within = true;
  std::atomic<double> sum2_so_far = 0.0;  // in any order: it decides only far from the limit, the exact sum below at it
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    Partial& partial = partials[chunk];
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(source_->points.size(), (chunk + 1) * kChunk); ++i) {
      if (!is_within.load(std::memory_order_relaxed)) return;
      const NearestPoint nearest = cut.nearest(source_->points[i], hint);
      hint = nearest.triangle;
      if (i < source_->sample_count) partial.sum2 += nearest.distance2;
      if (nearest.distance2 > partial.max2) {
        partial.max2 = nearest.distance2;
        partial.worst = static_cast<std::uint32_t>(i);
      }
      if (nearest.distance2 > max2) is_within.store(false, std::memory_order_relaxed);
    }
    if (sum2_so_far.fetch_add(partial.sum2) + partial.sum2 > 1.001 * sum2) is_within.store(false);
  });
  Forward out;
  for (const Partial& p : partials) {
    out.sum2 += p.sum2;
    out.max2 = std::max(out.max2, p.max2);
  }
  out.is_within = is_within && out.max2 <= max2 && out.sum2 <= sum2;
  if (worst != nullptr) {
    // The farthest points of their chunks, farthest last.
    std::vector<Partial> far(partials);
    std::sort(far.begin(), far.end(), [](const Partial& a, const Partial& b) {
      return a.max2 != b.max2 ? a.max2 < b.max2 : a.worst < b.worst;
    });
    const std::size_t kept = std::min<std::size_t>(far.size(), 16);
    for (std::size_t i = far.size() - kept; i < far.size(); ++i) {
      if (far[i].max2 >= 0.0) worst->push_back(far[i].worst);
    }
  }
  return out;
}

std::optional<CutFigures> CutJudge::measure_within(std::span<const ClusterId> clusters, const Limit& limit) {
  const double limit2 = limit.max * limit.max;
  CutFigures out;
  std::vector<ClusterId> unknown;
  for (const ClusterId c : clusters) {
    out.triangles += asset_.clusters()[c.value].triangle_count();
    if (!clusters_[c.value].is_known) {
      unknown.push_back(c);
    } else if (clusters_[c.value].max2 > limit2) {
      return std::nullopt;
    }
  }
  parallel_for_each_index(unknown.size(), 1,
                          [&](std::size_t i) { clusters_[unknown[i].value] = measure_cluster(unknown[i]); });
  double sum2 = 0.0, area = 0.0, max2 = 0.0;
  for (const ClusterId c : clusters) {
    const ClusterFigures& figures = clusters_[c.value];
    sum2 += figures.mean2 * figures.area;
    area += figures.area;
    max2 = std::max(max2, figures.max2);
  }
  out.max_to_source = std::sqrt(max2);
  out.rms_to_source = area > 0.0 ? std::sqrt(sum2 / area) : 0.0;
  if (max2 > limit2 || out.rms_to_source > limit.rms) return std::nullopt;

  const TriangleTree tree(surface_of_clusters(asset_, decoded_, mesh_, clusters));
  for (std::size_t i = suspects_.size(); i-- > 0;) {
    if (tree.nearest(source_->points[suspects_[i]]).distance2 > limit2) return std::nullopt;
  }
  const Forward forward = measure_to_cut(tree, limit, &suspects_);
  if (suspects_.size() > kMaxSuspects) {
    suspects_.erase(suspects_.begin(), suspects_.end() - static_cast<std::ptrdiff_t>(kMaxSuspects));
  }
  if (!forward.is_within) return std::nullopt;
  out.max_to_cut = std::sqrt(forward.max2);
  const auto count = static_cast<double>(source_->sample_count);
  out.rms_to_cut = source_->sample_count > 0 ? std::sqrt(forward.sum2 / count) : 0.0;
  return out;
}

CutFigures CutJudge::measure(const Surface& surface) const {
  CutFigures out;
  out.triangles = surface.triangles.size();
  const TriangleTree tree(surface);
  const Forward forward = measure_to_cut(tree, {}, nullptr);
  out.max_to_cut = std::sqrt(forward.max2);
  const auto points = static_cast<double>(source_->sample_count);
  out.rms_to_cut = source_->sample_count > 0 ? std::sqrt(forward.sum2 / points) : 0.0;

  const AreaSamples samples(surface, source_->samples, 2);
  const std::vector<std::uint32_t> vertices = used_vertices(surface);
  const auto count = static_cast<std::size_t>(samples.count());
  std::vector<double> sums((count + vertices.size() + kChunk - 1) / kChunk, 0.0), maxima(sums.size(), 0.0);
  parallel_for_each_index(sums.size(), 1, [&](std::size_t chunk) {
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(count + vertices.size(), (chunk + 1) * kChunk); ++i) {
      const Vec3d p = i < count ? samples.position(samples.sample(i)) : surface.positions[vertices[i - count]];
      const NearestPoint nearest = source_->tree.nearest(p, hint);
      hint = nearest.triangle;
      if (i < count) sums[chunk] += nearest.distance2;
      maxima[chunk] = std::max(maxima[chunk], nearest.distance2);
    }
  });
  double sum2 = 0.0, max2 = 0.0;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    sum2 += sums[c];
    max2 = std::max(max2, maxima[c]);
  }
  out.max_to_source = std::sqrt(max2);
  out.rms_to_source = count > 0 ? std::sqrt(sum2 / static_cast<double>(count)) : 0.0;
  return out;
}

}  // namespace meshlode::judge
