// SPDX-License-Identifier: GPL-3.0-or-later
// The tier measured for what is promised (docs/reference/selection.md, "What is promised"): points of a group are held
// against all of the source, and points of the source against the groups that stand for them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "builder/lod_dag.h"
#include "builder/measure/groups_by_level.h"
#include "builder/promise/far_points.h"
#include "builder/promise/painted_source.h"
#include "builder/promise/product_surfaces.h"
#include "builder/promise/product_tree.h"
#include "builder/promise/promise_certifier.h"
#include "builder/promise/source_points.h"

namespace meshlode::builder {

/// What the steps of the grids move a corner by at most, and so any point between corners. Says nothing of the normals
/// of triangles.
inline double quantization_of(const ProductSpace& space, const format::MeshRecord& record) {
  double sum = double{record.level0_deviation} * double{record.level0_deviation};
  for (std::uint32_t set = 0; set < space.layout.uv_set_count; ++set) {
    const double half = 0.5 * format::exp2_exact(record.uv_log2[set]);
    for (const double unit : space.uv[set]) sum += half * unit * half * unit;
  }
  if (space.layout.has_normal && space.normal > 0.0) {
    const double turn = space.normal * std::sqrt(2.0) / record.normal_scale;
    sum += turn * turn;
  }
  return std::sqrt(sum);
}

template <std::size_t D>
class PromiseMeter {
 public:
  PromiseMeter(const PaintedSource& source, const ProductSpace& space, const LodDag& dag,
               const format::MeshRecord& record)
      : space_(space),
        dag_(dag),
        record_(record),
        surfaces_(space, dag, record),
        source_(surfaces_.of_source(source)),
        points_(surfaces_, source_),
        tree_(source_, triangles_with_points(surfaces_, source_)) {}

  /// `least`: per group, what its deviation counts as in any case. Of those that are no larger, and no larger than a
  /// finer one's, that is said. \pre it is 0 or more
  [[nodiscard]] ProductDeviations measure(std::vector<double> least) {
    ProductDeviations found;
    found.groups = std::move(least);
    std::vector<std::vector<Sample>> carried(dag_.clusters.size());
    found.level0 = place_samples(carried);
    const std::vector<std::vector<std::uint32_t>> outputs = clusters_made_of_groups(dag_);
    for (const std::vector<std::uint32_t>& groups : groups_by_level(dag_)) {
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) {
        const std::uint32_t g = groups[i];
        if (dag_.groups[g].is_terminal) return;
        for_each_member(g, [&](std::uint32_t c) {
          const GroupId finer = dag_.clusters[c].own_group;
          if (finer.is_valid()) found.groups[g] = std::max(found.groups[g], found.groups[finer.value]);
        });
        found.groups[g] = measure_group(g, outputs[g], found.groups[g], carried);
      });
      for (const std::uint32_t g : groups) for_each_member(g, [&](std::uint32_t c) { carried[c] = {}; });
    }
    return found;
  }

 private:
  /// Points on a group's triangles beside the corners, the middles of edges and the middle. With a sixteenth
  /// random scenes 1050482 and 1081146 had a cut at 1.08 and 1.12 times what it promises, with a quarter the first;
  /// rock, bunny and FlightHelmet take 3 to 8% less time.
  static constexpr std::size_t kGroupPoints = 16384, kMostOfTriangle = 512;
  /// Points nearer than this share of the farthest are not looked at closely.
  static constexpr double kLookFrom = 0.6;
  /// So many samples of one triangle of the source are looked between, each with each.
  static constexpr std::size_t kPairedOfTriangle = 4;
  static constexpr std::size_t kChunk = 1024;  // points that share a hint, whatever the thread count

  using Point = ProductPoint<D>;
  using Surface = ProductSurface<D>;
  using Tree = ProductTree<D>;
  using Sample = SourcePoint;

  /// What is nearest to a point may be a triangle without area no more than a point may be of it: its normal, if the
  /// source has given it one, is not known here.
  static std::vector<std::uint32_t> triangles_with_points(const ProductSurfaces<D>& surfaces, const Surface& surface) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      if (surfaces.has_points(surface, t)) triangles.push_back(t);
    }
    return triangles;
  }

  template <class Visit>
  void for_each_member(std::uint32_t g, const Visit& visit) const {
    const DagGroup& group = dag_.groups[g];
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) visit(c);
  }

  /// Each point of the source goes to the cluster of level 0 that it lies on. Returns how far level 0 is off.
  double place_samples(std::vector<std::vector<Sample>>& carried) const {
    Surface level0;
    std::vector<std::uint32_t> cluster_of, clusters;
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (dag_.clusters[c].own_group.is_valid()) continue;
      surfaces_.add_cluster(dag_.clusters[c], level0);
      cluster_of.resize(level0.triangles.size(), c);
      clusters.push_back(c);
    }
    if (level0.triangles.empty()) return 0.0;
    const Tree tree(level0);
    const double quantization = quantization_of(space_, record_);
    std::vector<Sample> samples = points_.choose();
    std::vector<double> farthest2(chunk_count(samples.size(), kChunk), 0.0);
    parallel_for_each_chunk(samples.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      std::uint32_t place = kNoId;
      FarPoints list;
      for (std::size_t i = begin; i < end; ++i) {
        // Within what quantization moves it by, one triangle is as good as another.
        const auto hit =
            tree.find(source_.at(samples[i].triangle, samples[i].b, samples[i].c), place, quantization * quantization);
        if (hit.triangle == kNoId) continue;  // its distance is not a number
        samples[i].place = place = hit.triangle;
        farthest2[chunk] = std::max(farthest2[chunk], hit.distance2);
        if (space_.is_flat() && hit.distance2 >= kLookFrom * kLookFrom * farthest2[chunk])
          list.add({hit.distance2, samples[i].triangle, double{samples[i].b}, double{samples[i].c}, hit.triangle});
      }
      farthest2[chunk] = climb_all(tree, list, farthest2[chunk]);
    });
    for (const Sample& sample : samples) carried[cluster_of[sample.place]].push_back(sample);
    if (!space_.is_flat()) return quantization;
    double farthest = 0.0;
    for (const double d2 : farthest2) farthest = std::max(farthest, d2);
    std::vector<double> back2(clusters.size(), farthest);
    parallel_for_each_index(clusters.size(), 1, [&](std::size_t i) {
      Surface surface;
      surfaces_.add_cluster(dag_.clusters[clusters[i]], surface);
      back2[i] = measure_to_source(surface, back2[i]);
    });
    for (const double d2 : back2) farthest = std::max(farthest, d2);
    return std::sqrt(farthest);
  }

  /// From points of the source to farther ones near to them.
  [[nodiscard]] double climb_all(const Tree& tree, const FarPoints& list, double farthest2) const {
    for (FarPoint far : list.list()) {
      climb_near(source_, tree, far);
      farthest2 = std::max(farthest2, far.distance2);
    }
    return farthest2;
  }

  /// Points of the group against the source. Squared, `farthest2` at least.
  [[nodiscard]] double measure_to_source(const Surface& surface, double farthest2) const {
    const auto count = static_cast<std::uint32_t>(surface.triangles.size());
    const std::size_t more = std::min(kMostOfTriangle, kGroupPoints / std::max(1U, count));
    std::vector<typename Tree::Hit> of_corner(surface.points.size());
    FarPoints list;
    std::uint32_t place = kNoId;
    const auto note = [&](const typename Tree::Hit& hit, std::uint32_t t, double b, double c) {
      if (hit.triangle == kNoId || hit.distance2 < kLookFrom * kLookFrom * farthest2) return;
      list.add({hit.distance2, t, b, c, hit.triangle});
    };
    const auto look = [&](std::uint32_t t, double b, double c) {
      const auto hit = tree_.find(surface.at(t, b, c), place, kLookFrom * kLookFrom * farthest2);
      if (hit.triangle == kNoId) return hit;
      place = hit.triangle;
      farthest2 = std::max(farthest2, hit.distance2);
      note(hit, t, b, c);
      return hit;
    };
    const auto edge = [](std::uint32_t a, std::uint32_t b) { return std::array<std::uint32_t, 2>{a, b}; };
    std::vector<std::array<std::uint32_t, 2>> ascending;
    for (std::uint32_t t = 0; t < count; ++t) {
      if (!surfaces_.has_points(surface, t)) continue;
      const auto& [a, b, c] = surface.triangles[t];
      for (const auto& e : {edge(a, b), edge(b, c), edge(c, a)}) {
        if (e[0] < e[1]) ascending.push_back(e);
      }
    }
    std::sort(ascending.begin(), ascending.end());
    SplitMix64 random(0x67726F7570ULL);
    for (std::uint32_t t = 0; t < count; ++t) {
      if (!surfaces_.has_points(surface, t)) continue;
      const auto& ids = surface.triangles[t];
      look(t, 1.0 / 3.0, 1.0 / 3.0);
      for (std::size_t k = 0; k < 3; ++k) {
        // Looked at once, and where it is far each triangle around it may rise from there.
        if (of_corner[ids[k]].triangle == kNoId) {
          of_corner[ids[k]] = look(t, kCorners[k][0], kCorners[k][1]);
        } else {
          note(of_corner[ids[k]], t, kCorners[k][0], kCorners[k][1]);
        }
        // Of an edge that two triangles share, in opposite directions, one looks.
        const std::size_t next = (k + 1) % 3;
        if (ids[k] > ids[next] && std::binary_search(ascending.begin(), ascending.end(), edge(ids[next], ids[k])))
          continue;
        look(t, 0.5 * (kCorners[k][0] + kCorners[next][0]), 0.5 * (kCorners[k][1] + kCorners[next][1]));
      }
      for (std::size_t i = 0; i < more; ++i) {
        const auto [b, c] = random_weights(random);
        look(t, b, c);
      }
    }
    for (FarPoint far : list.list()) {
      climb(surface, tree_, far);
      farthest2 = std::max(farthest2, far.distance2);
    }
    return farthest2;
  }

  /// Points of the source against the group, each of which finds where it lies there. Squared, `farthest2` at least.
  [[nodiscard]] double measure_from_source(const Tree& tree, std::vector<Sample>& samples, double farthest2) const {
    FarPoints list;
    std::uint32_t place = kNoId;
    for (Sample& sample : samples) {
      const Point point = source_.at(sample.triangle, sample.b, sample.c);
      // The nearest in any case: on some other triangle that is near enough not to matter now, it would be thinned out
      // among strangers, and be missed where it matters.
      const auto hit = tree.find(point, place, 0.0);
      if (hit.triangle == kNoId) continue;
      sample.place = place = hit.triangle;
      sample.distance = static_cast<float>(std::sqrt(hit.distance2));
      farthest2 = std::max(farthest2, hit.distance2);
      if (hit.distance2 >= kLookFrom * kLookFrom * farthest2) {
        list.add({hit.distance2, sample.triangle, double{sample.b}, double{sample.c}, hit.triangle});
      }
    }
    look_between(tree, samples, farthest2, list);
    return climb_all(tree, list, farthest2);
  }

  /// Of a triangle of the source that reaches farther than the group is off, the samples that are left say little of
  /// what lies between them. What lies elsewhere on it may be another group's.
  void look_between(const Tree& tree, std::vector<Sample> samples, double& farthest2, FarPoints& list) const {
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& x, const Sample& y) { return x.triangle < y.triangle; });
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
      const std::uint32_t triangle = samples[begin].triangle;
      while (end < samples.size() && samples[end].triangle == triangle) ++end;
      if (end - begin < 2 || !(points_.longest2_of(triangle) > farthest2)) continue;
      const std::size_t last = std::min(end, begin + kPairedOfTriangle);
      for (std::size_t i = begin; i < last; ++i) {
        for (std::size_t k = i + 1; k < last; ++k) {
          const double b = 0.5 * (double{samples[i].b} + double{samples[k].b});
          const double c = 0.5 * (double{samples[i].c} + double{samples[k].c});
          const auto hit = tree.find(source_.at(triangle, b, c), samples[i].place, kLookFrom * kLookFrom * farthest2);
          if (hit.triangle == kNoId) continue;
          farthest2 = std::max(farthest2, hit.distance2);
          if (hit.distance2 < kLookFrom * kLookFrom * farthest2) continue;
          list.add({hit.distance2, triangle, b, c, hit.triangle});
        }
      }
    }
  }

  /// Not below `known`: what is nearer is not looked at closely.
  double measure_group(std::uint32_t g, const std::vector<std::uint32_t>& outputs, double known,
                       std::vector<std::vector<Sample>>& carried) const {
    Surface surface;
    std::vector<std::uint32_t> cluster_of;
    for (const std::uint32_t c : outputs) {
      surfaces_.add_cluster(dag_.clusters[c], surface);
      cluster_of.resize(surface.triangles.size(), c);
    }
    if (surface.triangles.empty()) return std::numeric_limits<double>::infinity();
    const Tree tree(surface);
    std::vector<Sample> samples;
    for_each_member(g, [&](std::uint32_t c) { samples.insert(samples.end(), carried[c].begin(), carried[c].end()); });
    const double from2 = measure_from_source(tree, samples, known * known);
    const double farthest2 = measure_to_source(surface, from2);
    // Clusters made from one group belong to no other: nobody else writes there.
    for (const Sample& sample : points_.thin(samples, surface.triangles.size())) {
      carried[cluster_of[sample.place]].push_back(sample);
    }
    return farthest2 > known * known ? std::sqrt(farthest2) : known;
  }

  static constexpr std::array<std::array<double, 2>, 3> kCorners{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
  ProductSpace space_;
  const LodDag& dag_;
  const format::MeshRecord& record_;
  ProductSurfaces<D> surfaces_;
  Surface source_;
  SourcePoints<D> points_;
  Tree tree_;
};

}  // namespace meshlode::builder
