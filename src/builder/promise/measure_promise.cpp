// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/promise/measure_promise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "builder/hierarchy/lod_bounds.h"
#include "builder/hierarchy/margins.h"
#include "builder/measure/groups_by_level.h"
#include "builder/promise/product_surfaces.h"
#include "builder/promise/product_tree.h"
#include "builder/promise/promise_certifier.h"
#include "format/grid.h"

namespace meshlode::builder {

namespace {

/// Points of the source beside the corners and the middle of each triangle: so many in all, by the triangles' longest
/// sides, as what a cut is off by changes along them.
constexpr std::size_t kSourcePoints = 100000;
/// Carried on by a group, about; between so many a triangle of it.
constexpr std::size_t kCarried = 16384, kFewestCarried = 2, kMostCarried = 64;
/// The same of vertices of the source, of which corners of charts and peaks of normals are: all of them, but where a
/// triangle has very many, so that those of small meshes are there to the end.
constexpr std::size_t kCarriedVertices = 32768, kFewestVertices = 64;
/// Points on a group's triangles beside the corners, the middles of edges and the middle.
constexpr std::size_t kGroupPoints = 1024, kMostOfTriangle = 32;
/// Points nearer than this share of the farthest are not looked at closely.
constexpr double kLookFrom = 0.6;
/// From so many of the farthest points of either direction a farther one is looked for on the same triangle: on a
/// lattice of so many steps along an edge, then in so many steps, each half as long as the one before.
constexpr std::size_t kClimbed = 64;
constexpr int kLattice = 6, kSteps = 5, kNearSteps = 7, kNearTries = 10;
/// So many samples of one triangle of the source are looked between, each with each.
constexpr std::size_t kPairedOfTriangle = 4;
constexpr std::size_t kChunk = 1024;  // points that share a hint, whatever the thread count

/// What the steps of the grids move a corner by at most, and so any point between corners. Says nothing of the normals
/// of triangles.
double quantization_of(const ProductSpace& space, const format::MeshRecord& record) {
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
        tree_(source_, triangles_with_points(surfaces_, source_)) {}

  [[nodiscard]] ProductDeviations measure() {
    ProductDeviations found;
    found.groups.assign(dag_.groups.size(), 0.0);
    std::vector<std::vector<Sample>> carried(dag_.clusters.size());
    found.level0 = place_samples(carried);
    const std::vector<std::vector<std::uint32_t>> outputs = clusters_made_of_groups(dag_);
    for (const std::vector<std::uint32_t>& groups : groups_by_level(dag_)) {
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) {
        const std::uint32_t g = groups[i];
        if (!dag_.groups[g].is_terminal) found.groups[g] = measure_group(g, outputs[g], carried);
      });
      for (const std::uint32_t g : groups) {
        const DagGroup& group = dag_.groups[g];
        for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) carried[c] = {};
      }
    }
    return found;
  }

 private:
  using Point = ProductPoint<D>;
  using Surface = ProductSurface<D>;
  using Tree = ProductTree<D>;

  struct Sample {
    std::uint32_t triangle;  ///< of the source
    float b, c;              ///< weights of its second and third corner
    float distance = 0.0F;   ///< from the clusters that it was last found on
    std::uint32_t place = 0;
    [[nodiscard]] bool is_vertex() const { return (b == 0.0F || b == 1.0F) && (c == 0.0F || c == 1.0F); }
  };

  /// What is nearest to a point may be a triangle without area no more than a point may be of it: its normal, if the
  /// source has given it one, is not known here.
  static std::vector<std::uint32_t> triangles_with_points(const ProductSurfaces<D>& surfaces, const Surface& surface) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      if (surfaces.has_points(surface, t)) triangles.push_back(t);
    }
    return triangles;
  }

  /// A point of a surface from which a farther one may be looked for.
  struct Far {
    double distance2;
    std::uint32_t triangle;
    double b, c;
    std::uint32_t place;  ///< the nearest triangle of the other surface
  };

  /// The farthest so far, at most one of a triangle.
  class FarList {
   public:
    void add(const Far& far) {
      for (Far& known : list_) {
        if (known.triangle != far.triangle) continue;
        if (far.distance2 > known.distance2) known = far;
        return;
      }
      if (list_.size() < kClimbed) {
        list_.push_back(far);
        return;
      }
      const auto least = std::min_element(list_.begin(), list_.end(),
                                          [](const Far& a, const Far& b) { return a.distance2 < b.distance2; });
      if (far.distance2 > least->distance2) *least = far;
    }
    [[nodiscard]] const std::vector<Far>& list() const { return list_; }

   private:
    std::vector<Far> list_;
  };

  [[nodiscard]] std::vector<Sample> choose_samples() const {
    const auto count = static_cast<std::uint32_t>(source_.triangles.size());
    std::vector<double> length(count);
    double sum = 0.0;
    for (std::uint32_t t = 0; t < count; ++t) {
      length[t] = std::sqrt(longest2_of(t));
      sum += length[t];
    }
    const double per_length = sum > 0.0 && std::isfinite(sum) ? static_cast<double>(kSourcePoints) / sum : 0.0;
    std::vector<Sample> samples;
    std::vector<std::uint8_t> is_taken(source_.points.size(), 0);
    SplitMix64 random(0x7061696E74ULL);
    double owed = 0.0;
    for (std::uint32_t t = 0; t < count; ++t) {
      if (!surfaces_.has_points(source_, t)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        std::uint8_t& taken = is_taken[source_.triangles[t][k]];
        if (taken == 0) samples.push_back({t, k == 1 ? 1.0F : 0.0F, k == 2 ? 1.0F : 0.0F});
        taken = 1;
      }
      samples.push_back({t, 1.0F / 3.0F, 1.0F / 3.0F});
      for (owed += per_length * length[t]; owed >= 1.0; owed -= 1.0) {
        const auto [b, c] = random_weights(random);
        samples.push_back({t, static_cast<float>(b), static_cast<float>(c)});
      }
    }
    return samples;
  }

  /// Inside of the triangle, or on an edge of it: a needle is nothing but edges.
  static std::array<double, 2> random_weights(SplitMix64& random) {
    double b = random.unit(), c = random.unit();
    switch (random.below(6)) {
      case 0: return {b, 0.0};
      case 1: return {0.0, c};
      case 2: return {b, 1.0 - b};
      default: break;
    }
    if (b + c > 1.0) {
      b = 1.0 - b;
      c = 1.0 - c;
    }
    return {b, c};
  }

  /// Each point of the source goes to the cluster of level 0 that it lies on. Returns how far level 0 is off.
  double place_samples(std::vector<std::vector<Sample>>& carried) const {
    Surface level0;
    std::vector<std::uint32_t> cluster_of;
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (dag_.clusters[c].own_group.is_valid()) continue;
      surfaces_.add_cluster(dag_.clusters[c], level0);
      cluster_of.resize(level0.triangles.size(), c);
    }
    if (level0.triangles.empty()) return 0.0;
    const Tree tree(level0);
    const double quantization = quantization_of(space_, record_);
    std::vector<Sample> samples = choose_samples();
    std::vector<double> farthest2(chunk_count(samples.size(), kChunk), 0.0);
    parallel_for_each_chunk(samples.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      std::uint32_t place = kNoId;
      for (std::size_t i = begin; i < end; ++i) {
        // Within what quantization moves it by, one triangle is as good as another.
        const auto hit =
            tree.find(source_.at(samples[i].triangle, samples[i].b, samples[i].c), place, quantization * quantization);
        if (hit.triangle == kNoId) continue;  // its distance is not a number
        samples[i].place = place = hit.triangle;
        farthest2[chunk] = std::max(farthest2[chunk], hit.distance2);
      }
    });
    for (const Sample& sample : samples) carried[cluster_of[sample.place]].push_back(sample);
    if (!space_.is_flat()) return quantization;
    double farthest = 0.0;
    for (const double d2 : farthest2) farthest = std::max(farthest, d2);
    std::vector<double> back2(chunk_count(level0.triangles.size(), kChunk), 0.0);
    parallel_for_each_chunk(level0.triangles.size(), kChunk,
                            [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                              std::uint32_t place = kNoId;
                              for (std::size_t t = begin; t < end; ++t) {
                                const auto id = static_cast<std::uint32_t>(t);
                                if (!surfaces_.has_points(level0, id)) continue;
                                for (const auto& [b, c] : kCorners) {
                                  const auto hit = tree_.find(level0.at(id, b, c), place, 0.0);
                                  if (hit.triangle == kNoId) continue;
                                  place = hit.triangle;
                                  back2[chunk] = std::max(back2[chunk], hit.distance2);
                                }
                              }
                            });
    for (const double d2 : back2) farthest = std::max(farthest, d2);
    return std::sqrt(farthest);
  }

  /// Looks for a farther point on the same triangle of `surface`: on a lattice, and around its best point ever closer.
  static void climb(const Surface& surface, const Tree& other, Far& far) {
    const auto look = [&](double b, double c) {
      if (b < 0.0 || c < 0.0 || b + c > 1.0) return;
      const auto hit = other.find(surface.at(far.triangle, b, c), far.place, far.distance2);
      if (hit.triangle == kNoId || hit.distance2 <= far.distance2) return;
      far = {hit.distance2, far.triangle, b, c, hit.triangle};
    };
    constexpr double kSpacing = 1.0 / kLattice;
    for (int i = 0; i <= kLattice; ++i) {
      for (int k = 0; i + k <= kLattice; ++k) look(i * kSpacing, std::min(k * kSpacing, 1.0 - i * kSpacing));
    }
    double length = 0.5 * kSpacing;
    for (int step = 0; step < kSteps; ++step, length *= 0.5) {
      const Far from = far;
      for (const auto& [b, c] : kDirections) look(from.b + length * b, from.c + length * c);
    }
  }

  /// The same near the point itself, at random: what lies elsewhere on a triangle of the source may be another group's.
  static void climb_near(const Surface& surface, const Tree& other, Far& far) {
    SplitMix64 random(0x66726F6DULL + far.triangle);
    double length = 1.0;
    for (int step = 0; step < kNearSteps; ++step, length *= 0.5) {
      for (int i = 0; i < kNearTries; ++i) {
        const auto [b, c] = random_weights(random);
        const double tried_b = far.b + length * (b - far.b), tried_c = far.c + length * (c - far.c);
        const auto hit = other.find(surface.at(far.triangle, tried_b, tried_c), far.place, far.distance2);
        if (hit.triangle == kNoId || hit.distance2 <= far.distance2) continue;
        far = {hit.distance2, far.triangle, tried_b, tried_c, hit.triangle};
      }
    }
  }

  /// Points of the group against the source. Squared.
  [[nodiscard]] double measure_to_source(const Surface& surface, double farthest2) const {
    const auto count = static_cast<std::uint32_t>(surface.triangles.size());
    const std::size_t more = std::min(kMostOfTriangle, kGroupPoints / std::max(1U, count));
    std::vector<typename Tree::Hit> of_corner(surface.points.size());
    FarList list;
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
    for (Far far : list.list()) {
      climb(surface, tree_, far);
      farthest2 = std::max(farthest2, far.distance2);
    }
    return farthest2;
  }

  /// Points of the source against the group, each of which finds where it lies there. Squared.
  [[nodiscard]] double measure_from_source(const Tree& tree, std::vector<Sample>& samples) const {
    double farthest2 = 0.0;
    FarList list;
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
    for (Far far : list.list()) {
      climb_near(source_, tree, far);
      farthest2 = std::max(farthest2, far.distance2);
    }
    return farthest2;
  }

  /// Of a triangle of the source that reaches farther than the group is off, the samples that are left say little of
  /// what lies between them. What lies elsewhere on it may be another group's.
  void look_between(const Tree& tree, std::vector<Sample> samples, double& farthest2, FarList& list) const {
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& x, const Sample& y) { return x.triangle < y.triangle; });
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
      const std::uint32_t triangle = samples[begin].triangle;
      while (end < samples.size() && samples[end].triangle == triangle) ++end;
      if (end - begin < 2 || !(longest2_of(triangle) > farthest2)) continue;
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

  [[nodiscard]] double longest2_of(std::uint32_t triangle) const {
    double longest2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& a = source_.points[source_.triangles[triangle][k]];
      const Point& b = source_.points[source_.triangles[triangle][(k + 1) % 3]];
      double side2 = 0.0;
      for (std::size_t d = 0; d < D; ++d) side2 += (a[d] - b[d]) * (a[d] - b[d]);
      longest2 = std::max(longest2, side2);
    }
    return longest2;
  }

  /// The farthest samples of each triangle, of the others some from all over the source and the farthest vertices, and
  /// those that lie outermost in some coordinate: what is near now and far when the triangle has become another.
  [[nodiscard]] std::vector<Sample> thin(std::vector<Sample>& samples, std::size_t triangle_count) const {
    const std::size_t each =
        std::clamp(kCarried / std::max<std::size_t>(1, triangle_count), kFewestCarried, kMostCarried);
    const std::size_t vertices = std::max(kCarriedVertices / std::max<std::size_t>(1, triangle_count), kFewestVertices);
    std::sort(samples.begin(), samples.end(), [](const Sample& x, const Sample& y) {
      if (x.place != y.place) return x.place < y.place;
      if (x.distance != y.distance) return x.distance > y.distance;
      if (x.triangle != y.triangle) return x.triangle < y.triangle;
      return x.b != y.b ? x.b < y.b : x.c < y.c;
    });
    std::vector<Sample> kept;
    for (std::size_t begin = 0; begin < samples.size();) {
      std::size_t end = begin;
      while (end < samples.size() && samples[end].place == samples[begin].place) ++end;
      const std::size_t count = end - begin, far = std::min(count, each);
      const std::size_t rest = std::min(count - far, each / 2);
      const Outermost outermost = find_outermost({samples.data() + begin, count});
      std::size_t taken = 0, vertices_taken = 0;  // of the rest; of all
      for (std::size_t i = 0; i < count; ++i) {
        const Sample& sample = samples[begin + i];
        const bool is_of_rest = i >= far && taken < rest && i == far + (count - far) * taken / rest;
        const bool is_wanted_vertex = sample.is_vertex() && vertices_taken < vertices;
        const bool is_outermost = std::find(outermost.begin(), outermost.end(), i) != outermost.end();
        if (i < far || is_of_rest || is_wanted_vertex || is_outermost) kept.push_back(sample);
        taken += is_of_rest ? 1 : 0;
        vertices_taken += is_wanted_vertex ? 1 : 0;
      }
      begin = end;
    }
    return kept;
  }

  /// Of each coordinate the first sample with the least and the first with the most.
  using Outermost = std::array<std::size_t, 2 * D>;
  [[nodiscard]] Outermost find_outermost(std::span<const Sample> samples) const {
    Outermost at{};
    Point low{}, high{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Point point = source_.at(samples[i].triangle, samples[i].b, samples[i].c);
      for (std::size_t d = 0; d < D; ++d) {
        if (i == 0 || point[d] < low[d]) {
          low[d] = point[d];
          at[2 * d] = i;
        }
        if (i == 0 || point[d] > high[d]) {
          high[d] = point[d];
          at[2 * d + 1] = i;
        }
      }
    }
    return at;
  }

  double measure_group(std::uint32_t g, const std::vector<std::uint32_t>& outputs,
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
    const DagGroup& group = dag_.groups[g];
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      samples.insert(samples.end(), carried[c].begin(), carried[c].end());
    }
    const double from2 = measure_from_source(tree, samples);
    const double farthest2 = measure_to_source(surface, from2);
    // Clusters made from one group belong to no other: nobody else writes there.
    for (const Sample& sample : thin(samples, surface.triangles.size())) {
      carried[cluster_of[sample.place]].push_back(sample);
    }
    return std::sqrt(farthest2);
  }

  /// Along the edges of a triangle, in weights of its second and third corner.
  static constexpr std::array<std::array<double, 2>, 6> kDirections{
      {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}};
  static constexpr std::array<std::array<double, 2>, 3> kCorners{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
  ProductSpace space_;
  const LodDag& dag_;
  const format::MeshRecord& record_;
  ProductSurfaces<D> surfaces_;
  Surface source_;
  Tree tree_;
};

/// Measured, or of the tier certified proven.
template <std::size_t D>
ProductDeviations measure_in(const PaintedSource& source, const ProductSpace& space, const LodDag& dag,
                             const format::MeshRecord& record) {
  if (record.error_tier != format::ErrorTier::kCertified) return PromiseMeter<D>(source, space, dag, record).measure();
  const ProductSurfaces<D> surfaces(space, dag, record);
  return PromiseCertifier<D>(surfaces, dag, {record.grid.log2, record.grid.mantissa}, quantization_of(space, record))
      .certify(source);
}

/// Nothing where the space has positions alone and their errors are known.
std::optional<ProductDeviations> measure(const PaintedSource& source, const ProductSpace& space, const LodDag& dag,
                                         const format::MeshRecord& record) {
  const std::size_t dimensions = space.dimensions();
  if (dimensions <= 3 && record.error_tier != format::ErrorTier::kQem) return std::nullopt;
  if (dimensions <= 6) return measure_in<6>(source, space, dag, record);
  if (dimensions <= 8) return measure_in<8>(source, space, dag, record);
  return measure_in<14>(source, space, dag, record);
}

/// Makes errors nest along the DAG and above `least`, which does. Groups come coarse to fine.
std::vector<float> nest(const LodDag& dag, const std::optional<ProductDeviations>& measured, double margin,
                        const std::vector<float>& least) {
  if (!measured) return least;
  std::vector<float> errors(least.size());
  for (std::size_t g = errors.size(); g-- > 0;) {
    const DagGroup& group = dag.groups[g];
    if (group.is_terminal) {
      errors[g] = format::kInfiniteError;
      continue;
    }
    float finer = 0.0F;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      if (own.is_valid()) finer = std::max(finer, errors[own.value]);
    }
    errors[g] = grow_error(std::max(margin * measured->groups[g], double{least[g]}), finer);
  }
  return errors;
}

}  // namespace

PromiseErrors measure_promises(const PaintedSource& source, const LodDag& dag, const format::MeshRecord& record,
                               std::span<const format::GroupRecord> groups, double margin, std::uint32_t promises) {
  PromiseErrors out;
  out.mesh = source.units;
  out.mesh.promises = promises;
  std::vector<float> least;
  for (const format::GroupRecord& group : groups) least.push_back(group.error);

  const auto texels = measure(source, product_space_of(source, false), dag, record);
  const std::vector<float> texel_errors = nest(dag, texels, margin, least);
  out.mesh.level0_texels = std::max(record.level0_deviation, texels ? float_above(texels->level0) : 0.0F);
  const bool has_appearance = (promises & format::kPromisesAppearance) != 0;
  std::vector<float> appearance_errors(groups.size(), 0.0F);
  if (has_appearance) {
    auto appearance =
        source.units.normal_object > 0.0F ? measure(source, product_space_of(source, true), dag, record) : std::nullopt;
    if (appearance && record.error_tier == format::ErrorTier::kCertified) {
      // Normals are at most 2 apart, and what has none is not compared in them.
      const auto at_most = [&](double proven, float proven_texels) {
        return std::min(proven, std::hypot(double{proven_texels}, 2.0 * double{source.units.normal_object}));
      };
      appearance->level0 = at_most(appearance->level0, out.mesh.level0_texels);
      for (std::size_t g = 0; g < groups.size(); ++g)
        appearance->groups[g] = at_most(appearance->groups[g], std::max(out.mesh.level0_texels, texel_errors[g]));
    }
    appearance_errors = nest(dag, appearance, margin, texel_errors);
    // Level 0 is measured where the normals are those of triangles: with the margin of what samples find. Proven it is
    // in any case, and the margin is 1 then.
    const double level0 = appearance ? appearance->level0 * (source.layout.flat_normal ? margin : 1.0) : 0.0;
    out.mesh.level0_appearance = std::max(out.mesh.level0_texels, float_above(level0));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) out.groups.push_back({texel_errors[g], appearance_errors[g]});
  return out;
}

PromiseErrors promises_of_positions(const format::MeshRecord& record, std::span<const format::GroupRecord> groups,
                                    std::uint32_t promises) {
  PromiseErrors out;
  out.mesh.promises = promises;
  const bool has_appearance = (promises & format::kPromisesAppearance) != 0;
  out.mesh.level0_texels = record.level0_deviation;
  out.mesh.level0_appearance = has_appearance ? record.level0_deviation : 0.0F;
  for (const format::GroupRecord& group : groups) {
    out.groups.push_back({group.error, has_appearance ? group.error : 0.0F});
  }
  return out;
}

}  // namespace meshlode::builder
