// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/whole_cuts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "base/id_table.h"
#include "base/ids.h"
#include "base/parallel.h"
#include "base/random.h"
#include "builder/deviation/bounded_search.h"
#include "builder/deviation/surface_tree.h"
#include "builder/measure/source_points.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kChunk = 256;  // source triangles that share a hint, whatever the thread count
/// Points of one source triangle from which on its corners are asked first: what is near to all three is near to them.
constexpr std::uint32_t kManyOfTriangle = 10;
/// Points nearer to a cut than this share of its error are left alone: they belong to groups of smaller errors, which
/// other cuts show.
constexpr double kLookFrom = 0.7;
/// Points of a cut from which a farther one is looked for on the same triangle: the farthest of all, and the farthest
/// of those that are nearest to one group.
constexpr std::size_t kClimbed = 32, kClimbedOfGroup = 4;
/// Steps of such a search, each half as long as the one before, and points tried at each.
constexpr int kSteps = 7, kTries = 12;
/// Triangles that no single one of the cut is near to throughout may have a peak between their points, where a fold of
/// the cut leaves them. They are searched by bounds, so many at once, those first whose points are farthest, for as
/// long as some of them have one: in so many parts each, so many more for all that these do not bound, and so many of a
/// cut.
constexpr std::ptrdiff_t kDoubtful = 512;
constexpr std::size_t kPartsOfDoubtful = 128, kMoreParts = 100000, kMostParts = 1000000;
/// From cut to cut so many more groups are finer, as a share of those that are; and what all cuts together may have,
/// where that is more than the mesh has.
constexpr std::size_t kCutShare = 8;
constexpr std::size_t kFewTriangles = 250000;
/// Cuts of so few triangles are put into trees side by side.
constexpr std::size_t kTrianglesAtOnce = 16384;
/// What a flat surface may be off by, as a share of the mesh: the arithmetic of doubles.
constexpr double kNoise = 1e-12;
/// A raised group leaves the cut that it was found in, and what takes its place is looked at again.
constexpr int kRounds = 6;

using Triangle = std::array<std::uint32_t, 3>;

/// Clusters as one surface, off the grid.
struct Surface {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> cluster;  ///< per triangle, of LodDag::clusters

  Surface() = default;
  Surface(const PreparedMesh& mesh, const LodDag& dag, std::span<const std::uint32_t> clusters) {
    struct Start {
      std::size_t vertex = 0, triangle = 0;
    };
    std::vector<Start> start{{}};
    start.reserve(clusters.size() + 1);
    for (const std::uint32_t id : clusters) {
      const DagCluster& source = dag.clusters[id];
      start.push_back({start.back().vertex + source.vertex_count, start.back().triangle + source.triangle_count});
    }
    positions.resize(start.back().vertex);
    triangles.resize(start.back().triangle);
    cluster.resize(start.back().triangle);
    parallel_for_each_index(clusters.size(), kLoopGrain / 128, [&](std::size_t i) {
      const DagCluster& source = dag.clusters[clusters[i]];
      const auto base = static_cast<std::uint32_t>(start[i].vertex);
      for (std::uint32_t v = 0; v < source.vertex_count; ++v) {
        positions[base + v] = mesh.grid.decode(dag.vertex_position[source.first_vertex + v]);
      }
      for (std::uint32_t t = 0; t < source.triangle_count; ++t) {
        const auto& local = dag.triangles[source.first_triangle + t];
        triangles[start[i].triangle + t] = {base + local[0], base + local[1], base + local[2]};
        cluster[start[i].triangle + t] = clusters[i];
      }
    });
  }
};

/// A cluster that a point of the source is near to. Cuts that follow one another have most of their clusters in common:
/// a point that is near enough to one of them need not be looked for in the others.
struct Near {
  std::uint32_t cluster = kNoId;
  float distance = 0.0F;  ///< to it at most, object units, as a SurfaceTree's floats have it
};

/// Around a cluster, off the grid.
struct ClusterBox {
  std::uint32_t cluster = 0;
  Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// A point of the source, far from a cut.
struct FarPoint {
  double distance = 0.0;
  Vec3d at{0.0};
  std::uint32_t point = 0;  ///< where it was found from
  TreeSlot place{0U};       ///< of what is nearest, in the cut's tree
  GroupId nearest;          ///< that it is of; invalid for level 0
};

/// A source triangle, with the largest distance that its points have from a cut.
struct Doubtful {
  double distance = 0.0;
  std::uint32_t run = 0;
  TreeSlot place{0U};
};

class WholeCuts {
 public:
  WholeCuts(const PreparedMesh& mesh, double margin, LodDag& dag)
      : mesh_(mesh),
        margin_(margin),
        dag_(dag),
        points_(choose_source_points(mesh)),
        runs_(runs_of(points_)),
        near_(points_.size()),
        run_near_(runs_.size()),
        outputs_(dag.groups.size()) {
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (dag_.clusters[c].own_group.is_valid()) outputs_[dag_.clusters[c].own_group.value].push_back(c);
    }
  }

  /// One look at all cuts. \returns how many groups it raised.
  std::size_t look() {
    std::vector<double> errors;
    for (const DagGroup& group : dag_.groups) {
      if (!group.is_terminal) errors.push_back(group.error);
    }
    std::sort(errors.begin(), errors.end(), std::greater<>());
    errors.erase(std::unique(errors.begin(), errors.end()), errors.end());
    std::vector<double> raised(dag_.groups.size(), 0.0);
    const double noise = kNoise * mesh_.diagonal;
    std::size_t triangles = 0;
    bool is_enough = false;
    for (std::size_t k = 0; k < errors.size() && !is_enough;) {
      std::vector<Cut> cuts;
      std::size_t at_once = 0;
      for (; k < errors.size() && at_once < kTrianglesAtOnce; k = next(k)) {
        Cut cut = cut_at(errors[k]);
        for (const std::uint32_t c : cut.clusters) cut.triangles += dag_.clusters[c].triangle_count;
        triangles += cut.triangles;
        is_enough = k > 0 && triangles > std::max(mesh_.exact_triangles.size(), kFewTriangles);
        if (is_enough) break;
        if (std::find(true_cuts_.begin(), true_cuts_.end(), hash_of(cut)) != true_cuts_.end()) continue;
        at_once += cut.triangles;
        cuts.push_back(std::move(cut));
      }
      parallel_for_each_index(cuts.size(), 1, [&](std::size_t i) { make_surface(cuts[i]); });
      for (const Cut& cut : cuts) {
        if (is_true(cut, noise, raised)) true_cuts_.push_back(hash_of(cut));
      }
    }
    return raise(raised);
  }

 private:
  static std::size_t next(std::size_t k) { return k + std::max<std::size_t>(1, k / kCutShare); }

  [[nodiscard]] double error_of(GroupId group) const { return group.is_valid() ? dag_.groups[group.value].error : 0.0; }

  struct Cut {
    double threshold = 0.0;
    std::vector<std::uint32_t> clusters;  ///< ascending
    std::size_t triangles = 0;
    Surface surface;
    SurfaceTree tree;  ///< over it
  };

  /// The cut's clusters; no surface yet.
  [[nodiscard]] Cut cut_at(double threshold) const {
    Cut cut;
    cut.threshold = threshold;
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      const DagCluster& cluster = dag_.clusters[c];
      if (error_of(cluster.own_group) <= threshold && error_of(cluster.coarser_group) > threshold)
        cut.clusters.push_back(c);
    }
    return cut;
  }
  void make_surface(Cut& cut) const {
    cut.surface = {mesh_, dag_, cut.clusters};
    cut.tree.build({cut.surface.positions, cut.surface.triangles});
  }

  static std::uint64_t hash_of(const Cut& cut) {
    std::uint64_t hash = hash_word(0, std::bit_cast<std::uint64_t>(cut.threshold));
    for (const std::uint32_t c : cut.clusters) hash = hash_word(hash, c);
    return hash;
  }

  /// Whether no point is farther from the cut than the errors of its groups say. `raised`, by group, gets what is.
  bool is_true(const Cut& cut, double noise, std::vector<double>& raised) {
    bool is_true = true;
    for (const FarPoint& far : find_far_points(cut.surface, cut.tree, cut.threshold)) {
      if (far.distance <= std::max(error_of(far.nearest), noise)) continue;
      const GroupId group = group_of(far.at, cut.threshold);
      if (!group.is_valid() || far.distance <= dag_.groups[group.value].error) continue;
      raised[group.value] = std::max(raised[group.value], far.distance);
      is_true = false;
    }
    return is_true;
  }

  /// Where a point is farther from a cut than `enough`, squared and in the tree's frame, its nearest triangle; else one
  /// that is near enough. `place` is where to begin, and becomes that triangle.
  static SurfaceTree::Hit find_near(const SurfaceTree& tree, const Vec3d& point, float enough, TreeSlot& place) {
    const Vec3f at = tree.to_frame(point);
    SurfaceTree::Hit hit = tree.look_around(at, place, {});
    if (!(hit.distance2 <= enough)) hit = tree.find_nearest(at, hit, enough);
    if (hit.slot.is_valid()) place = hit.slot;
    return hit;
  }
  /// One triangle of the cut that is near to all of a source triangle, if the places looked at have one: at `place`,
  /// and where the first corner is nearest to. The distance is that of the farthest corner.
  static SurfaceTree::Hit find_near_throughout(const SurfaceTree& tree, const std::array<Vec3d, 3>& corners,
                                               float enough, TreeSlot& place) {
    const std::array<Vec3f, 3> at{tree.to_frame(corners[0]), tree.to_frame(corners[1]), tree.to_frame(corners[2])};
    const SurfaceTree::Hit hit = tree.look_around(at, place);
    if (hit.distance2 <= enough) return hit;
    const TreeSlot before = place;
    (void)find_near(tree, corners[0], enough, place);
    return place == before ? hit : tree.look_around(at, place);
  }
  static bool is_far(const SurfaceTree& tree, const Vec3d& point, float enough, TreeSlot& place) {
    const SurfaceTree::Hit hit = find_near(tree, point, enough, place);
    return hit.slot.is_valid() && hit.distance2 > enough;
  }

  /// The farthest points, each with the farthest that was found around it.
  [[nodiscard]] std::vector<FarPoint> find_far_points(const Surface& cut, const SurfaceTree& tree, double threshold) {
    std::vector<std::uint8_t> is_in_cut(dag_.clusters.size(), 0);
    for (const std::uint32_t c : cut.cluster) is_in_cut[c] = 1;
    const double enough_object = std::max(kLookFrom * threshold, mesh_.level0_deviation);
    const float enough = tree.squared_in_frame(enough_object);
    const auto is_still_near = [&](const Near& near) {
      return near.cluster != kNoId && is_in_cut[near.cluster] != 0 && double{near.distance} <= enough_object;
    };
    const auto near_of = [&](const SurfaceTree::Hit& hit) {
      return Near{cut.cluster[tree.triangle_at(hit.slot)],
                  static_cast<float>(std::sqrt(double{hit.distance2}) / tree.scale())};
    };
    std::vector<std::vector<FarPoint>> partials(chunk_count(runs_.size(), kChunk));
    std::vector<std::vector<Doubtful>> doubtful(partials.size());
    parallel_for_each_chunk(runs_.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      TreeSlot place{0U};
      for (std::size_t r = begin; r < end; ++r) {
        const PointRun& run = runs_[r];
        if (run.count >= kManyOfTriangle) {
          if (is_still_near(run_near_[r])) continue;
          const SurfaceTree::Hit hit = find_near_throughout(tree, source_corners(mesh_, run.triangle), enough, place);
          if (hit.distance2 <= enough) {
            run_near_[r] = near_of(hit);
            continue;
          }
        }
        Doubtful doubt{0.0, static_cast<std::uint32_t>(r), place};
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
          if (is_still_near(near_[i])) {
            doubt.distance = std::max(doubt.distance, double{near_[i].distance});
            continue;
          }
          const SurfaceTree::Hit hit = find_near(tree, points_[i].at, enough, place);
          if (!hit.slot.is_valid()) continue;
          near_[i] = near_of({place, hit.distance2});
          if (double{near_[i].distance} > doubt.distance) {
            doubt.distance = double{near_[i].distance};
            doubt.place = place;
          }
          if (!(hit.distance2 > enough)) continue;
          partials[chunk].push_back({std::sqrt(tree.distance2_at(points_[i].at, place)), points_[i].at, i, place,
                                     group_at(cut, tree, place)});
        }
        if (run.count >= kManyOfTriangle) doubtful[chunk].push_back(doubt);
      }
    });
    partials.push_back(search_doubtful(cut, tree, threshold, doubtful));
    std::vector<FarPoint> found;
    for (const auto& partial : partials) found.insert(found.end(), partial.begin(), partial.end());
    const auto is_farther = [](const FarPoint& a, const FarPoint& b) {
      return a.distance != b.distance ? a.distance > b.distance : a.point < b.point;
    };
    // The farthest are climbed from whatever they are, of the others the suspects alone.
    const auto others = found.begin() + static_cast<std::ptrdiff_t>(std::min(found.size(), kClimbed));
    std::nth_element(found.begin(), others, found.end(), is_farther);
    const auto is_no_suspect = [&](const FarPoint& far) { return far.distance <= error_of(far.nearest); };
    found.erase(std::remove_if(others, found.end(), is_no_suspect), found.end());
    std::sort(found.begin(), found.end(), is_farther);
    std::vector<FarPoint> chosen;
    std::vector<std::uint8_t> taken(dag_.groups.size() + 1, 0);
    for (const FarPoint& far : found) {
      std::uint8_t& of_group = taken[far.nearest.is_valid() ? far.nearest.value : dag_.groups.size()];
      const bool is_suspect = far.distance > error_of(far.nearest) && of_group < kClimbedOfGroup;
      if (is_suspect) ++of_group;
      if (is_suspect || chosen.size() < kClimbed) chosen.push_back(far);
    }
    parallel_for_each_index(chosen.size(), 1, [&](std::size_t i) { climb(cut, tree, chosen[i]); });
    return chosen;
  }

  /// What is farther than `threshold` between the points of triangles.
  [[nodiscard]] std::vector<FarPoint> search_doubtful(const Surface& cut, const SurfaceTree& tree, double threshold,
                                                      std::span<const std::vector<Doubtful>> by_chunk) const {
    std::vector<Doubtful> doubtful;
    for (const auto& some : by_chunk) doubtful.insert(doubtful.end(), some.begin(), some.end());
    std::vector<FarPoint> found;
    std::size_t parts = 0;
    for (auto first = doubtful.begin(); first != doubtful.end() && parts < kMostParts;) {
      const auto end = first + std::min<std::ptrdiff_t>(doubtful.end() - first, kDoubtful);
      std::partial_sort(first, end, doubtful.end(), [](const Doubtful& a, const Doubtful& b) {
        return a.distance != b.distance ? a.distance > b.distance : a.run < b.run;
      });
      const std::size_t before = found.size();
      parts += search_some(cut, tree, threshold, std::span(first, end), found);
      if (found.size() == before) break;
      first = end;
    }
    return found;
  }
  /// Returns the parts that were made.
  std::size_t search_some(const Surface& cut, const SurfaceTree& tree, double threshold,
                          std::span<const Doubtful> doubtful, std::vector<FarPoint>& found) const {
    std::vector<BoundedSearch> searches(doubtful.size(),
                                        BoundedSearch(tree, 1.0, std::max(threshold, mesh_.level0_deviation)));
    std::vector<std::size_t> parts(searches.size());
    parallel_for_each_index(searches.size(), 1, [&](std::size_t i) {
      searches[i].add(source_corners(mesh_, runs_[doubtful[i].run].triangle), doubtful[i].place);
      parts[i] = searches[i].run(kPartsOfDoubtful);
    });
    std::vector<BoundedSearch*> left;
    for (BoundedSearch& search : searches) {
      if (!search.is_done()) left.push_back(&search);
    }
    parallel_for_each_index(left.size(), 1, [&](std::size_t i) { left[i]->run(kMoreParts / left.size()); });
    for (std::size_t i = 0; i < searches.size(); ++i) {
      const auto& [distance, at, place] = searches[i].found();
      if (distance > 0.0) {
        found.push_back({distance, at, runs_[doubtful[i].run].first, place, group_at(cut, tree, place)});
      }
    }
    return std::accumulate(parts.begin(), parts.end(), left.empty() ? std::size_t{0} : kMoreParts);
  }

  [[nodiscard]] GroupId group_at(const Surface& cut, const SurfaceTree& tree, TreeSlot place) const {
    return dag_.clusters[cut.cluster[tree.triangle_at(place)]].own_group;
  }

  /// Looks for a farther point on the same triangle of the source.
  void climb(const Surface& cut, const SurfaceTree& tree, FarPoint& far) const {
    const std::array<Vec3d, 3> corners = source_corners(mesh_, points_[far.point].triangle);
    SplitMix64 random(far.point);
    float enough = tree.squared_in_frame(far.distance);
    TreeSlot place = far.place;
    double length = 1.0;
    for (int step = 0; step < kSteps; ++step, length *= 0.5) {
      for (int i = 0; i < kTries; ++i) {
        const Vec3d tried = far.at + length * (random_point(corners, i % 2 == 0, random) - far.at);
        if (!is_far(tree, tried, enough, place)) continue;
        const double distance = std::sqrt(tree.distance2_at(tried, place));
        if (distance <= far.distance) continue;
        far = {distance, tried, far.point, place, group_at(cut, tree, place)};
        enough = tree.squared_in_frame(distance);
      }
    }
  }

  /// The group that stands for a point of the source in a cut: from the cluster of level 0 that the point lies on,
  /// through what replaced it, always on the nearest side. Invalid for level 0 itself.
  [[nodiscard]] GroupId group_of(const Vec3d& point, double threshold) {
    std::uint32_t cluster = nearest_of_level0(point);
    for (;;) {
      const GroupId group = dag_.clusters[cluster].coarser_group;
      const std::vector<std::uint32_t>& outputs = outputs_[group.value];
      if (dag_.groups[group.value].is_terminal || error_of(group) > threshold || outputs.empty()) {
        return dag_.clusters[cluster].own_group;
      }
      cluster = nearest_of(outputs, point);
    }
  }

  /// By the clusters' boxes: few points are asked for, a tree over all of level 0 would cost more than all else here.
  [[nodiscard]] std::uint32_t nearest_of_level0(const Vec3d& point) {
    if (level0_.empty()) {
      for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
        if (!dag_.clusters[c].own_group.is_valid()) level0_.push_back(box_of(c));
      }
    }
    std::vector<double> distance2;
    distance2.reserve(level0_.size());
    for (const ClusterBox& box : level0_) {
      const Vec3d away = glm::max(glm::max(box.low - point, point - box.high), Vec3d(0.0));
      distance2.push_back(glm::dot(away, away));
    }
    const auto nearest = std::min_element(distance2.begin(), distance2.end()) - distance2.begin();
    const double enough2 = distance2_to(level0_[static_cast<std::size_t>(nearest)].cluster, point);
    std::vector<std::uint32_t> clusters;
    for (std::size_t i = 0; i < level0_.size(); ++i) {
      if (distance2[i] <= enough2) clusters.push_back(level0_[i].cluster);
    }
    return nearest_of(clusters, point);
  }
  [[nodiscard]] ClusterBox box_of(std::uint32_t cluster) const {
    ClusterBox box{cluster};
    const DagCluster& c = dag_.clusters[cluster];
    for (std::uint32_t v = c.first_vertex; v < c.first_vertex + c.vertex_count; ++v) {
      const Vec3d at = mesh_.grid.decode(dag_.vertex_position[v]);
      box.low = glm::min(box.low, at);
      box.high = glm::max(box.high, at);
    }
    return box;
  }

  [[nodiscard]] double distance2_to(std::uint32_t cluster, const Vec3d& point) const {
    const Surface one(mesh_, dag_, {&cluster, 1});
    double least2 = std::numeric_limits<double>::infinity();
    for (const Triangle& t : one.triangles) {
      least2 = std::min(
          least2, point_triangle_distance2(point, {one.positions[t[0]], one.positions[t[1]], one.positions[t[2]]}));
    }
    return least2;
  }
  [[nodiscard]] std::uint32_t nearest_of(std::span<const std::uint32_t> clusters, const Vec3d& point) const {
    std::uint32_t best = clusters.front();
    double best2 = std::numeric_limits<double>::infinity();
    for (const std::uint32_t c : clusters) {
      const double there2 = distance2_to(c, point);
      if (there2 < best2) {
        best2 = there2;
        best = c;
      }
    }
    return best;
  }

  /// Groups come coarse to fine, so that errors are handed on from the last to the first.
  std::size_t raise(const std::vector<double>& raised) {
    std::size_t count = 0;
    for (std::size_t g = raised.size(); g-- > 0;) {
      DagGroup& group = dag_.groups[g];
      if (group.is_terminal) continue;
      if (raised[g] > 0.0) {
        ++count;
        group.deviation = std::max(group.deviation, raised[g]);
        group.error = std::max(group.error, margin_ * raised[g]);
      }
      for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
        group.error = std::max(group.error, error_of(dag_.clusters[c].own_group));
      }
    }
    return count;
  }

  const PreparedMesh& mesh_;
  double margin_;
  LodDag& dag_;
  std::vector<SourcePoint> points_;
  std::vector<PointRun> runs_;
  /// Hashes of cuts that raised nothing. A round raises few groups, and leaves most cuts as they were.
  std::vector<std::uint64_t> true_cuts_;
  std::vector<Near> near_;                           ///< per point, of the last cut that it was looked for in
  std::vector<Near> run_near_;                       ///< per run: of all of its triangle
  std::vector<std::vector<std::uint32_t>> outputs_;  ///< per group: the clusters made from it
  std::vector<ClusterBox> level0_;                   ///< made when first asked for
};

}  // namespace

std::size_t hold_to_whole_cuts(const PreparedMesh& mesh, double margin, LodDag& dag) {
  WholeCuts cuts(mesh, margin, dag);
  std::size_t total = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t raised = cuts.look();
    total += raised;
    if (raised == 0) break;
  }
  return total;
}

}  // namespace meshlode::builder
