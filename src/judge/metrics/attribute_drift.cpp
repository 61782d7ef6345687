// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/attribute_drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/layers.h"
#include "judge/metrics/seams.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kChunk = 1024;
constexpr double kDegrees = 57.295779513082321;
constexpr float kSameNormal = 1e-3F;  // length of the difference of unit normals that is no crease
constexpr float kSameUv = 1e-6F;

/// One attribute of a surface; UVs have z = 0.
struct Field {
  const Surface* surface = nullptr;
  std::vector<Vec3f> values;
  bool is_normal = false;
  std::vector<std::uint8_t> seams;
  Surface seam_surface;                      ///< the triangles with a seam
  std::vector<std::uint32_t> seam_triangle;  ///< of seam_surface -> of surface
  std::optional<TriangleTree> seam_tree;
};

Field make_field(const Surface& surface, std::vector<Vec3f> values, bool is_normal) {
  Field field;
  field.surface = &surface;
  field.values = std::move(values);
  field.is_normal = is_normal;
  field.seams = find_seams(surface, field.values, is_normal ? kSameNormal : kSameUv);
  field.seam_surface.positions = surface.positions;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    if (field.seams[t] == 0) continue;
    field.seam_surface.triangles.push_back(surface.triangles[t]);
    field.seam_triangle.push_back(t);
  }
  if (!field.seam_triangle.empty()) field.seam_tree.emplace(field.seam_surface);
  return field;
}

bool is_known(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::vector<Vec3f> unit_normals(const std::vector<Vec3f>& normals) {
  std::vector<Vec3f> out(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) out[i] = normals[i] / glm::length(normals[i]);
  return out;
}

std::vector<Vec3f> lifted(const std::vector<Vec2f>& uvs) {
  std::vector<Vec3f> out(uvs.size());
  for (std::size_t i = 0; i < uvs.size(); ++i) out[i] = Vec3f(uvs[i], 0.0F);
  return out;
}

/// The value at a point of a triangle; not finite where unknown.
Vec3d value_at(const Field& field, std::uint32_t triangle, double u, double v) {
  const auto& t = field.surface->triangles[triangle];
  const Vec3d value =
      Vec3d(field.values[t[0]]) * (1.0 - u - v) + Vec3d(field.values[t[1]]) * u + Vec3d(field.values[t[2]]) * v;
  return field.is_normal ? glm::normalize(value) : value;
}

double difference(const Field& field, const Vec3d& a, const Vec3d& b) {
  if (!field.is_normal) return glm::length(a - b);
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * kDegrees;
}

struct ClosestPoint {
  Vec3d point{0.0};
  double u = 0.0, v = 0.0;
  std::uint8_t edges = 0;  ///< bit k: the point lies on the edge from corner k to k + 1
};

ClosestPoint closest_on_edge(const Vec3d& p, const Vec3d& a, const Vec3d& b, double& along) {
  const Vec3d d = b - a;
  const double dd = glm::dot(d, d);
  along = dd > 0.0 ? std::clamp(glm::dot(p - a, d) / dd, 0.0, 1.0) : 0.0;
  return {a + d * along, 0.0, 0.0, 0};
}

/// The closest point of a triangle, with its weights and the edges it lies on.
ClosestPoint closest_on_triangle(const Vec3d& p, const Surface& s, std::uint32_t triangle) {
  const auto& t = s.triangles[triangle];
  const Vec3d a = s.positions[t[0]], ab = s.positions[t[1]] - a, ac = s.positions[t[2]] - a, ap = p - a;
  const double g00 = glm::dot(ab, ab), g01 = glm::dot(ab, ac), g11 = glm::dot(ac, ac);
  const double det = g00 * g11 - g01 * g01;
  if (det > 1e-14 * g00 * g11) {
    const double h0 = glm::dot(ap, ab), h1 = glm::dot(ap, ac);
    const double u = (g11 * h0 - g01 * h1) / det, v = (g00 * h1 - g01 * h0) / det;
    if (u > 0.0 && v > 0.0 && u + v < 1.0) return {a + ab * u + ac * v, u, v, 0};
  }
  ClosestPoint best;
  double best2 = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < 3; ++k) {
    double along = 0.0;
    ClosestPoint c = closest_on_edge(p, s.positions[t[k]], s.positions[t[(k + 1) % 3]], along);
    const double d2 = glm::dot(c.point - p, c.point - p);
    if (d2 > best2) continue;
    double weights[3] = {};
    weights[k] = 1.0 - along;
    weights[(k + 1) % 3] = along;
    c.u = weights[1];
    c.v = weights[2];
    c.edges = static_cast<std::uint8_t>(1U << k);
    if (along == 0.0) c.edges = static_cast<std::uint8_t>(c.edges | (1U << ((k + 2) % 3)));
    if (along == 1.0) c.edges = static_cast<std::uint8_t>(c.edges | (1U << ((k + 1) % 3)));
    if (d2 < best2) best = c;
    best2 = d2;
  }
  return best;
}

/// How much the value changes at most per unit of length inside a triangle (Frobenius norm of its gradient).
double slope_of(const Field& field, std::uint32_t triangle) {
  const auto& t = field.surface->triangles[triangle];
  const std::vector<Vec3d>& p = field.surface->positions;
  const Vec3d e0 = p[t[1]] - p[t[0]], e1 = p[t[2]] - p[t[0]];
  const Vec3d d0 = Vec3d(field.values[t[1]]) - Vec3d(field.values[t[0]]);
  const Vec3d d1 = Vec3d(field.values[t[2]]) - Vec3d(field.values[t[0]]);
  const double g00 = glm::dot(e0, e0), g01 = glm::dot(e0, e1), g11 = glm::dot(e1, e1);
  const double det = g00 * g11 - g01 * g01;
  if (!(det > 1e-12 * g00 * g11)) return 0.0;  // a needle: no slide is explained by it
  const double sum = (glm::dot(d0, d0) * g11 - 2.0 * glm::dot(d0, d1) * g01 + glm::dot(d1, d1) * g00) / det;
  return std::sqrt(std::max(0.0, sum));
}

constexpr std::size_t kFields = 1 + scene::kMaxUvSets;  // normals, then UV sets
using Fields = std::array<std::optional<Field>, kFields>;
/// A value of each field; not finite where unknown.
using Values = std::array<Vec3d, kFields>;

/// A difference that weighs as much as one of any other field by its own: half a turn of a normal, a hundredth of what
/// the surface has of the atlas. On a narrow rim a slide within the rounding of positions turns normals by degrees,
/// where UVs move by thousandths of that.
constexpr double kShareOfUvs = 0.01;

double range_of(const Field& field) {
  if (field.is_normal) return 180.0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d low(kInfinity), high(-kInfinity);
  for (const Vec3f& value : field.values) {
    if (!is_known(Vec3d(value))) continue;
    low = glm::min(low, Vec3d(value));
    high = glm::max(high, Vec3d(value));
  }
  const double range = glm::length(high - low);
  return kShareOfUvs * (range > 0.0 && std::isfinite(range) ? range : 1.0);
}

struct Candidate {
  Vec3d point{0.0};
  std::uint32_t triangle = 0;
  Values values{};
};

/// Scratch of one thread's chunk.
struct Search {
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
      range_[f] = range_of(*to[f]);
    }
  }

  /// The fields that both surfaces have.
  [[nodiscard]] const std::vector<std::size_t>& compared() const { return compared_; }

  /// The differences of a point's values from those of its counterpart; below 0 where one of the two is unknown.
  std::array<double, kFields> differences(const Vec3d& p, const Values& values, const NearestPoint& nearest,
                                          Search& search) const {
    collect(p, nearest, search);
    std::array<double, kFields> best{};
    Cost least;
    for (const Candidate& side : search.sides) {
      std::array<double, kFields> found{};
      const Cost cost = cost_of(values, side.values, found);
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
    double sum = 0.0;  ///< of the squared shares
    bool operator<(const Cost& other) const {
      return missing != other.missing ? missing < other.missing : sum < other.sum;
    }
  };

  Cost cost_of(const Values& values, const Values& others, std::array<double, kFields>& found) const {
    found.fill(-1.0);
    Cost cost;
    for (const std::size_t f : compared_) {
      if (!is_known(values[f])) continue;
      if (!is_known(others[f])) {
        ++cost.missing;
        continue;
      }
      found[f] = difference(*to_[f], values[f], others[f]);
      const double share = found[f] / range_[f];
      cost.sum += share * share;
    }
    return cost;
  }

  void collect(const Vec3d& p, const NearestPoint& nearest, Search& search) const {
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

  void collect_beyond_seams(const Vec3d& p, double distance, std::size_t field, Search& search) const {
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
  static void find_ordered(const TriangleTree& tree, const Vec3d& p, double reach, Search& search) {
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
  [[nodiscard]] bool is_slide(const Candidate& other, std::size_t field, const Search& search) const {
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
  std::array<double, kFields> range_{};
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

Fields make_fields(const ShadedSurface& s) {
  Fields fields;
  if (!s.normals.empty()) fields[0].emplace(make_field(s.surface, unit_normals(s.normals), true));
  for (std::size_t n = 0; n < scene::kMaxUvSets; ++n) {
    if (!s.uvs[n].empty()) fields[1 + n].emplace(make_field(s.surface, lifted(s.uvs[n]), false));
  }
  return fields;
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
  parallel_for_each_index((count + kChunk - 1) / kChunk, 1, [&](std::size_t chunk) {
    Search search;
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
      const bool is_sample = i < sample_count;
      const SurfacePoint at = is_sample ? samples.sample(i) : SurfacePoint{};
      const std::uint32_t vertex = is_sample ? 0 : vertices[i - sample_count];
      const Vec3d p = is_sample ? samples.position(at) : surface.positions[vertex];
      const NearestPoint nearest = to.tree.nearest(p, hint);
      hint = nearest.triangle;
      Values values;
      for (const std::size_t f : pairing.compared()) {
        const Field& field = *from.fields[f];
        values[f] = is_sample ? value_at(field, at.triangle, at.u, at.v) : Vec3d(field.values[vertex]);
      }
      const auto differences = pairing.differences(p, values, nearest, search);
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
