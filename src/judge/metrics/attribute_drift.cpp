// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/attribute_drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/drift_field.h"
#include "judge/metrics/layers.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kSamplesAtOnce = 1024;

using Values = std::array<Vec3d, kFields>;

/// A point of the surface that is measured.
struct Probe {
  Vec3d position{0.0};
  Values values{};  ///< not finite where unknown
  /// How fast each field changes there, per unit of length.
  std::array<double, kFields> slopes{};
};

struct Candidate {
  Vec3d point{0.0};
  std::uint32_t triangle = 0;
  Values values{};
};

/// Scratch of one thread's chunk.
struct DriftSearch {
  std::vector<NearestPoint> found;
  std::vector<Candidate> sides;
  Layers::Scratch layers;
};

/// Finds what a point of one surface is held against on the other.
class Pairing {
 public:
  Pairing(const Fields& from, const Surface& surface, const TriangleTree& tree, const Layers& layers, const Fields& to,
          const DriftOptions& options)
      : surface_(surface), tree_(tree), layers_(layers), to_(to), options_(options) {
    for (std::size_t f = 0; f < kFields; ++f) {
      if (!from[f] || !to[f]) continue;
      compared_.push_back(f);
    }
  }

  /// The fields that both surfaces have.
  [[nodiscard]] const std::vector<std::size_t>& compared() const { return compared_; }

  /// The differences of a point's values from those of its counterpart; below 0 where one of the two is unknown.
  std::array<double, kFields> differences(const Probe& probe, const NearestPoint& nearest, DriftSearch& search) const {
    collect(probe.position, nearest, search);
    std::array<double, kFields> explained{}, best{};
    for (const std::size_t f : compared_) explained[f] = explained_at(probe, f);
    Cost least;
    for (const Candidate& side : search.sides) {
      std::array<double, kFields> found{};
      const Cost cost = cost_of(probe.values, side.values, explained, found);
      if (&side != &search.sides.front() && !(cost < least)) continue;
      least = cost;
      best = found;
    }
    return best;
  }

 private:
  /// What is not known on the other surface alone comes first.
  struct Cost {
    std::size_t missing = 0;
    double sum = 0.0;  ///< of the squares, in units of what is explained
    bool operator<(const Cost& other) const {
      return missing != other.missing ? missing < other.missing : sum < other.sum;
    }
  };

  /// A difference that says nothing about sides and charts: what rounding makes, and what a slide within
  /// reach makes. So fields weigh what they can tell: on a narrow rim normals turn by degrees within a step of the
  /// grid, on a small leaf UVs move by hundredths.
  [[nodiscard]] double explained_at(const Probe& probe, std::size_t field) const {
    constexpr double kNormals = 1e-3, kUvs = 1e-4, kMost = 0.1, kDegrees = 57.295779513082321;
    const Field& to = *to_[field];
    const double unit = to.is_normal ? kDegrees : 1.0;
    const double slid = unit * probe.slopes[field] * std::max(options_.side_reach, options_.seam_reach);
    return std::min((to.is_normal ? kNormals : kUvs) * to.range + slid, kMost * to.range);
  }

  Cost cost_of(const Values& values, const Values& others, const std::array<double, kFields>& explained,
               std::array<double, kFields>& found) const {
    found.fill(-1.0);
    Cost cost;
    for (const std::size_t f : compared_) {
      if (!is_known(values[f])) continue;
      if (!is_known(others[f])) {
        ++cost.missing;
        continue;
      }
      found[f] = difference(*to_[f], values[f], others[f]);
      const double times = found[f] / explained[f];
      cost.sum += times * times;
    }
    return cost;
  }

  void collect(const Vec3d& p, const NearestPoint& nearest, DriftSearch& search) const {
    const double distance = std::sqrt(nearest.distance2);
    search.sides.clear();
    search.sides.push_back(candidate(nearest.triangle, closest_on_triangle(p, surface_, nearest.triangle)));
    find_ordered(tree_, p, distance + options_.tie, search);
    for (const NearestPoint& f : search.found) {
      search.sides.push_back(candidate(f.triangle, closest_on_triangle(p, surface_, f.triangle)));
    }
    if (options_.side_reach > 0.0) {
      const double reach = distance + options_.side_reach;
      find_ordered(tree_, p, reach, search);
      layers_.keep_first_of_each(p, reach, search.found, search.layers);
      for (const NearestPoint& f : search.found) {
        search.sides.push_back(candidate(f.triangle, closest_on_triangle(p, surface_, f.triangle)));
      }
    }
    if (!(options_.seam_reach > 0.0)) return;
    for (const std::size_t f : compared_) collect_beyond_seams(p, distance, f, search);
  }

  void collect_beyond_seams(const Vec3d& p, double distance, std::size_t field, DriftSearch& search) const {
    const Field& to = *to_[field];
    if (!to.seam_tree) return;
    find_ordered(*to.seam_tree, p, distance + options_.seam_reach, search);
    for (const NearestPoint& f : search.found) {
      const std::uint32_t triangle = to.seam_triangle[f.triangle];
      const ClosestPoint c = closest_on_triangle(p, surface_, triangle);
      if ((c.edges & to.seams[triangle]) == 0) continue;  // it goes on beyond: not the end of a side
      const Candidate other = candidate(triangle, c);
      if (!is_slide(other, field, search)) search.sides.push_back(other);
    }
  }

  /// By distance, so that what is kept does not depend on the tree.
  static void find_ordered(const TriangleTree& tree, const Vec3d& p, double reach, DriftSearch& search) {
    search.found.clear();
    tree.find_within(p, reach * reach, search.found);
    std::sort(search.found.begin(), search.found.end(), [](const NearestPoint& x, const NearestPoint& y) {
      return x.distance2 != y.distance2 ? x.distance2 < y.distance2 : x.triangle < y.triangle;
    });
  }

  [[nodiscard]] Candidate candidate(std::uint32_t triangle, const ClosestPoint& c) const {
    Candidate out{c.point, triangle, {}};
    for (const std::size_t f : compared_) out.values[f] = value_at(*to_[f], triangle, c.u, c.v);
    return out;
  }

  /// Whether the surface leads from a candidate before to this one, by what it has there of a field.
  [[nodiscard]] bool is_slide(const Candidate& other, std::size_t field, const DriftSearch& search) const {
    return std::any_of(search.sides.begin(), search.sides.end(), [&](const Candidate& side) {
      const double slide = glm::length(side.point - other.point);
      const double jump = glm::length(side.values[field] - other.values[field]);
      const double slope = std::max(slope_of(*to_[field], side.triangle), slope_of(*to_[field], other.triangle));
      return slide > options_.tie && jump <= 2.0 * slope * slide;
    });
  }

  const Surface& surface_;  ///< the other one
  const TriangleTree& tree_;
  const Layers& layers_;
  const Fields& to_;
  const DriftOptions& options_;
  std::vector<std::size_t> compared_;
};

OneWayDrift summarize(std::vector<double> samples, const std::vector<double>& at_vertices) {
  OneWayDrift out;
  const auto is_unknown = [](double x) { return x < 0.0; };
  samples.erase(std::remove_if(samples.begin(), samples.end(), is_unknown), samples.end());
  out.points = samples.size();
  for (const double x : at_vertices) {
    if (is_unknown(x)) continue;
    out.max = std::max(out.max, x);
    ++out.points;
  }
  if (samples.empty()) return out;
  double sum2 = 0.0;
  for (const double x : samples) sum2 += x * x;
  out.rms = std::sqrt(sum2 / static_cast<double>(samples.size()));
  std::sort(samples.begin(), samples.end());
  out.max = std::max(out.max, samples.back());
  out.p99 = samples[(samples.size() - 1) * 99 / 100];
  return out;
}

}  // namespace

struct DriftSurface::Parts {
  explicit Parts(ShadedSurface s)
      : shaded(std::move(s)), tree(shaded.surface), layers(shaded), fields(make_fields(shaded)) {}
  ShadedSurface shaded;
  TriangleTree tree;
  Layers layers;
  Fields fields;
};

DriftSurface::DriftSurface(ShadedSurface surface) : parts_(std::make_unique<Parts>(std::move(surface))) {}
DriftSurface::~DriftSurface() = default;
DriftSurface::DriftSurface(DriftSurface&&) noexcept = default;

namespace {

struct BothDrifts {
  OneWayDrift normal, uv;
};

BothDrifts measure_one_way(const DriftSurface::Parts& from, const DriftSurface::Parts& to,
                           const DriftOptions& options) {
  BothDrifts out;
  const Surface& surface = from.shaded.surface;
  const AreaSamples samples(surface, options.samples, options.seed);
  const std::vector<std::uint32_t> vertices = used_vertices(surface);
  const auto sample_count = static_cast<std::size_t>(samples.count());
  const std::size_t count = sample_count + vertices.size();
  std::vector<double> normal(count, -1.0), uv(count, -1.0);  // below 0: unknown
  const Pairing pairing(from.fields, to.shaded.surface, to.tree, to.layers, to.fields, options);
  parallel_for_each_index((count + kSamplesAtOnce - 1) / kSamplesAtOnce, 1, [&](std::size_t chunk) {
    DriftSearch search;
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kSamplesAtOnce; i < std::min(count, (chunk + 1) * kSamplesAtOnce); ++i) {
      const bool is_sample = i < sample_count;
      const SurfacePoint at = is_sample ? samples.sample(i) : SurfacePoint{};
      const std::uint32_t vertex = is_sample ? 0 : vertices[i - sample_count];
      const Vec3d p = is_sample ? samples.position(at) : surface.positions[vertex];
      const NearestPoint nearest = to.tree.nearest(p, hint);
      hint = nearest.triangle;
      Probe probe;
      probe.position = p;
      for (const std::size_t f : pairing.compared()) {
        const Field& field = *from.fields[f];
        probe.values[f] = is_sample ? value_at(field, at.triangle, at.u, at.v) : Vec3d(field.values[vertex]);
        probe.slopes[f] = is_sample ? slope_of(field, at.triangle) : double{field.slopes[vertex]};
      }
      const auto differences = pairing.differences(probe, nearest, search);
      for (const std::size_t f : pairing.compared()) {
        double& slot = from.fields[f]->is_normal ? normal[i] : uv[i];
        slot = std::max(slot, differences[f]);
      }
    }
  });
  const auto split = [&](const std::vector<double>& v) {
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(sample_count);
    return summarize({v.begin(), middle}, {middle, v.end()});
  };
  out.normal = split(normal);
  out.uv = split(uv);
  return out;
}

}  // namespace

DriftReport measure_drift(const DriftSurface& a, const DriftSurface& b, const DriftOptions& options) {
  const DriftSurface::Parts &pa = a.parts(), &pb = b.parts();
  bool has_common = false;
  for (std::size_t f = 0; f < pa.fields.size(); ++f) has_common = has_common || (pa.fields[f] && pb.fields[f]);
  if (!has_common || pa.shaded.surface.triangles.empty() || pb.shaded.surface.triangles.empty()) return {};
  const BothDrifts ab = measure_one_way(pa, pb, options), ba = measure_one_way(pb, pa, options);
  return {ab.normal, ba.normal, ab.uv, ba.uv};
}

}  // namespace meshlode::judge
