// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/deviations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "judge/metrics/coverage.h"
#include "judge/metrics/metrics.h"
#include "judge/metrics/surface_bracket.h"
#include "run/select/select.h"

namespace meshlode::judge {

std::vector<double> spread_thresholds(std::span<const format::GroupRecord> groups, std::uint32_t count) {
  float low = format::kInfiniteError;
  float high = 0.0F;
  bool any_zero = false;
  std::vector<double> thresholds;
  for (const format::GroupRecord& group : groups) {
    if ((group.flags & format::kGroupAggregate) != 0) continue;  // a pixel's size, no distance
    if (count == kAllCuts && group.error < format::kInfiniteError) thresholds.push_back(group.error);
    if (group.error == 0.0F) any_zero = true;
    if (group.error >= format::kInfiniteError || !(group.error > 0.0F)) continue;
    low = std::min(low, group.error);
    high = std::max(high, group.error);
  }
  if (count == kAllCuts) {
    std::sort(thresholds.begin(), thresholds.end());
    thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
    return thresholds;
  }
  if (any_zero && (count > 1 || (count == 1 && !(high > 0.0F)))) thresholds.push_back(0.0);
  if (!(high > 0.0F)) return thresholds;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = count < 2 ? 0.5 : static_cast<double>(i) / (count - 1);
    thresholds.push_back(double{low} * std::pow(double{high} / low, t) * (1.0 + 1e-12));
  }
  return thresholds;
}

double position_rounding(const format::MeshRecord& mesh) {
  const double farthest = std::max({std::abs(mesh.origin[0]), std::abs(mesh.origin[1]), std::abs(mesh.origin[2])});
  return 1e-12 * mesh.diagonal + 0x1p-51 * (farthest + mesh.diagonal);
}

namespace {

/// What a cut stores of its clusters.
double stored_error_of(const run::Asset& asset, const format::MeshRecord& mesh, std::span<const ClusterId> clusters) {
  double error = mesh.level0_deviation;
  for (const ClusterId c : clusters) {
    const std::uint32_t group = asset.clusters()[c.value].own_group;
    if (group != format::kNone) error = std::max(error, double{asset.groups()[group].error});
  }
  return error;
}

/// The cuts of a surface that it was made from, from fine to coarse. What was proven to be near enough in one cut is so
/// in the next, for what a cut stores grows: a triangle of the source is looked at again where a cluster that it is
/// near to has gone, and one of a cut where its cluster is new.
class Brackets {
 public:
  Brackets(const run::Asset& asset, MeshId mesh, Surface truth, std::uint32_t budget)
      : asset_(asset),
        mesh_(mesh),
        truth_(std::move(truth)),
        tree_(truth_),
        budget_(budget),
        near_(truth_.triangles.size()),
        is_near_(asset.meshes()[mesh.value].cluster_count, 0) {}

  Result<CutBracket> look_at(std::span<const ClusterId> clusters, CutBracket cut) {
    TRY_LET(surface, surface_of_clusters(asset_, mesh_, clusters));
    if (truth_.triangles.empty() || surface->triangles.empty()) {
      if (truth_.triangles.empty() != surface->triangles.empty()) cut.lower = cut.upper = HUGE_VAL;
      return cut;
    }
    BracketOptions options;
    options.enough = cut.stored * (1.0 + kNothing) + cut.rounding;
    options.budget = budget_ * (truth_.triangles.size() + surface->triangles.size() + kAtLeast);
    if (options.enough < proven_at_) forget();  // not so in an asset whose errors grow
    proven_at_ = options.enough;
    const Bracket of_source = look_at_source(*surface, clusters, options);
    const Bracket of_cut = look_at_cut(*surface, clusters, options);
    cut.is_of_source = of_source.lower >= of_cut.lower;
    cut.lower = std::max(of_source.lower, of_cut.lower);
    cut.worst = cut.is_of_source ? of_source.worst : of_cut.worst;
    cut.upper = std::max(of_source.upper, of_cut.upper);
    cut.undecided = of_source.undecided + of_cut.undecided;
    return cut;
  }

 private:
  /// Triangles that the budget is for at least: a small mesh may have large ones, each of which lies over many.
  static constexpr std::uint64_t kAtLeast = 65536;

  void forget() {
    std::fill(near_.begin(), near_.end(), NearParts());
    std::fill(is_near_.begin(), is_near_.end(), 0);
  }
  [[nodiscard]] std::uint32_t index_of(ClusterId cluster) const {
    return cluster.value - asset_.meshes()[mesh_.value].first_cluster;
  }
  [[nodiscard]] std::uint32_t triangle_count(ClusterId cluster) const {
    return asset_.clusters()[cluster.value].triangles_less_1 + 1U;
  }

  Bracket look_at_source(const Surface& surface, std::span<const ClusterId> clusters, const BracketOptions& options) {
    std::vector<std::uint8_t> is_drawn(is_near_.size(), 0);
    std::vector<std::uint32_t> parts;
    parts.reserve(surface.triangles.size());
    for (const ClusterId cluster : clusters) {
      is_drawn[index_of(cluster)] = 1;
      parts.insert(parts.end(), triangle_count(cluster), index_of(cluster));
    }
    std::vector<std::uint32_t> triangles;
    std::vector<std::uint8_t> is_listed(near_.size(), 0);  // some are in several leaves
    for (const std::uint32_t t : tree_.triangles_in_order()) {
      const NearParts& near = near_[t];
      const bool is_proven = near.is_proven() && std::all_of(near.parts.begin(), near.parts.begin() + near.count,
                                                             [&](std::uint32_t part) { return is_drawn[part] != 0; });
      if (!is_proven && is_listed[t] == 0) triangles.push_back(t);
      is_listed[t] = 1;
    }
    const TriangleTree tree(surface);
    Bracket bracket = bracket_one_way(truth_, triangles, {surface, tree, parts}, options);
    for (std::size_t i = 0; i < triangles.size(); ++i) near_[triangles[i]] = bracket.near[i];
    return bracket;
  }

  Bracket look_at_cut(const Surface& surface, std::span<const ClusterId> clusters, const BracketOptions& options) {
    std::vector<std::uint32_t> triangles, cluster_of;
    std::uint32_t first = 0;
    for (const ClusterId cluster : clusters) {
      const std::uint32_t count = triangle_count(cluster);
      if (is_near_[index_of(cluster)] == 0) {
        for (std::uint32_t i = 0; i < count; ++i) triangles.push_back(first + i);
        cluster_of.insert(cluster_of.end(), count, index_of(cluster));
        is_near_[index_of(cluster)] = 1;
      }
      first += count;
    }
    Bracket bracket = bracket_one_way(surface, triangles, {truth_, tree_}, options);
    if (bracket.upper <= options.enough) return bracket;  // all that were open for a while, too
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (!bracket.near[i].is_proven()) is_near_[cluster_of[i]] = 0;
    }
    return bracket;
  }

  const run::Asset& asset_;
  MeshId mesh_;
  Surface truth_;
  TriangleTree tree_;
  std::uint32_t budget_;
  double proven_at_ = 0.0;
  std::vector<NearParts> near_;        ///< of each triangle of the source: clusters of the mesh
  std::vector<std::uint8_t> is_near_;  ///< of each cluster of the mesh
};

/// Clusters that no aggregate has or made. Of assets of before parts were meshes these are a trunk.
std::vector<ClusterId> clusters_of_others(const run::Asset& asset, const std::vector<ClusterId>& clusters) {
  const std::vector<ClusterId> aggregates = clusters_of_aggregates(asset, clusters);
  std::vector<ClusterId> others;
  std::size_t next = 0;  // both are in the same order
  for (const ClusterId cluster : clusters) {
    if (next < aggregates.size() && aggregates[next] == cluster) {
      ++next;
    } else {
      others.push_back(cluster);
    }
  }
  return others;
}

}  // namespace

Result<std::vector<CutBracket>> bracket_cuts(const run::Asset& asset, MeshId mesh, const scene::SourceMesh& source,
                                             std::uint32_t cuts, std::uint32_t budget) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<CutBracket> out;
  // Which triangles of the source the others of a mixed mesh are the source does not say; level 0 does, but for the
  // grid.
  const bool is_mixed = has_aggregates(asset, mesh);
  const auto drawn_at = [&](double threshold) {
    std::vector<ClusterId> clusters = run::select_uniform(asset, mesh, threshold).clusters;
    return is_mixed ? clusters_of_others(asset, clusters) : clusters;
  };
  TRY_LET(truth, is_mixed ? surface_of_clusters(asset, mesh, drawn_at(-1.0)) : surface_of_source(source));
  if (is_mixed && truth->triangles.empty()) return out;
  Brackets brackets(asset, mesh, std::move(*truth), budget);
  const double rounding = position_rounding(record) + (is_mixed ? double{record.level0_deviation} : 0.0);
  std::vector<ClusterId> previous;
  for (const double threshold :
       spread_thresholds(asset.groups().subspan(record.first_group, record.group_count), cuts)) {
    std::vector<ClusterId> clusters = drawn_at(threshold);
    if (clusters == previous) continue;
    CutBracket cut;
    cut.mesh = mesh;
    cut.threshold = threshold;
    cut.stored = stored_error_of(asset, record, clusters);
    cut.rounding = rounding;
    TRY_LET(bracket, brackets.look_at(clusters, cut));
    out.push_back(*bracket);
    previous = std::move(clusters);
  }
  return out;
}

std::vector<CutBracket> check_deviations(const run::Asset& asset, const scene::Scene& source, std::uint32_t cuts,
                                         std::uint32_t budget, RuleLog& log) {
  std::vector<CutBracket> out;
  for (std::uint32_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    const format::ErrorTier tier = asset.meshes()[m].error_tier;
    if (tier == format::ErrorTier::kQem) continue;
    const double limit = tier == format::ErrorTier::kCertified ? 1.0 : 1.0 + kMeasuredShortfall;
    const auto brackets = bracket_cuts(asset, MeshId(m), source.meshes[m], cuts, budget);
    if (!brackets) {
      log.add(Rule::kL204, brackets.error().where, brackets.error().detail);
      continue;
    }
    for (const CutBracket& cut : *brackets) {
      out.push_back(cut);
      log.expect(
          !cut.is_above(limit), Rule::kV206, [&] { return place("mesh", m); },
          [&] {
            char text[240];
            std::snprintf(text, sizeof text,
                          "the cut at error %.9g stores %.6g and deviates by %.6g to %.6g, %.3f times that, at "
                          "(%.9g %.9g %.9g) of the %s",
                          cut.threshold, cut.stored, cut.lower, cut.upper, cut.ratio_of(cut.lower), cut.worst.x,
                          cut.worst.y, cut.worst.z, cut.is_of_source ? "source" : "cut");
            return std::string(text);
          });
    }
  }
  return out;
}

}  // namespace meshlode::judge
