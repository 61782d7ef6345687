// SPDX-License-Identifier: GPL-3.0-or-later
#include "uv_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "base/ids.h"
#include "base/random.h"
#include "builder/dag/build_dag.h"
#include "builder/encode/attribute_steps.h"
#include "builder/measure/measure.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"

namespace meshlode::builder::test {

namespace {

using Uv = glm::dvec2;

/// Labels of eight bits ride where the builder keeps gaps, which a mesh prepared without any does not have.
constexpr std::uint32_t kLabelShift = 24, kLabels = 256;

struct PaintedTriangle {
  std::array<Vec3d, 3> at;
  std::array<Uv, 3> uv;
  std::uint32_t chart = kNoId, cluster = kNoId;

  [[nodiscard]] double area() const { return 0.5 * glm::length(glm::cross(at[1] - at[0], at[2] - at[0])); }
  template <class T>
  [[nodiscard]] static T mix(const std::array<T, 3>& of, const Vec3d& w) {
    return of[0] * w[0] + of[1] * w[1] + of[2] * w[2];
  }
};

/// Shares of the nearest point's corners: inside, or the best of three edges.
Vec3d nearest_shares(const PaintedTriangle& t, const Vec3d& p) {
  const Vec3d ab = t.at[1] - t.at[0], ac = t.at[2] - t.at[0], ap = p - t.at[0];
  const double d00 = glm::dot(ab, ab), d01 = glm::dot(ab, ac), d11 = glm::dot(ac, ac);
  const double d20 = glm::dot(ap, ab), d21 = glm::dot(ap, ac), det = d00 * d11 - d01 * d01;
  if (det > 0.0) {
    const double v = (d11 * d20 - d01 * d21) / det, w = (d00 * d21 - d01 * d20) / det;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) return {1.0 - v - w, v, w};
  }
  Vec3d best(1.0, 0.0, 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3d from = t.at[k], edge = t.at[(k + 1) % 3] - from;
    const double length2 = glm::dot(edge, edge);
    const double s = length2 > 0.0 ? std::clamp(glm::dot(p - from, edge) / length2, 0.0, 1.0) : 0.0;
    const double distance = glm::length(p - from - edge * s);
    if (distance >= least) continue;
    least = distance;
    best = Vec3d(0.0);
    best[k] = 1.0 - s;
    best[(k + 1) % 3] = s;
  }
  return best;
}

/// Halved by the median centre again and again; looked through by boxes.
class PlainTree {
 public:
  explicit PlainTree(std::vector<const PaintedTriangle*> triangles) : triangles_(std::move(triangles)) {
    if (!triangles_.empty()) build(0, triangles_.size());
  }
  struct Found {
    const PaintedTriangle* triangle = nullptr;
    Vec3d shares{0.0};
    double distance = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Found nearest(const Vec3d& p) const {
    Found found;
    if (!nodes_.empty()) search(0, p, found);
    return found;
  }

 private:
  struct Node {
    Vec3d low, high;
    std::size_t begin, end, left, right;  // of a leaf left is 0
  };
  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t id = nodes_.size();
    nodes_.push_back({Vec3d(1e300), Vec3d(-1e300), begin, end, 0, 0});
    for (std::size_t i = begin; i < end; ++i) {
      for (const Vec3d& p : triangles_[i]->at) {
        nodes_[id].low = glm::min(nodes_[id].low, p);
        nodes_[id].high = glm::max(nodes_[id].high, p);
      }
    }
    if (end - begin <= 4) return id;
    const Vec3d size = nodes_[id].high - nodes_[id].low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto half = triangles_.begin() + static_cast<std::ptrdiff_t>((begin + end) / 2);
    std::nth_element(triangles_.begin() + static_cast<std::ptrdiff_t>(begin), half,
                     triangles_.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](const PaintedTriangle* a, const PaintedTriangle* b) {
                       return (a->at[0] + a->at[1] + a->at[2])[axis] < (b->at[0] + b->at[1] + b->at[2])[axis];
                     });
    const std::size_t left = build(begin, (begin + end) / 2), right = build((begin + end) / 2, end);
    nodes_[id].left = left;
    nodes_[id].right = right;
    return id;
  }
  [[nodiscard]] double outside(std::size_t id, const Vec3d& p) const {
    return glm::length(glm::max(Vec3d(0.0), glm::max(nodes_[id].low - p, p - nodes_[id].high)));
  }
  void search(std::size_t id, const Vec3d& p, Found& found) const {
    const Node& node = nodes_[id];
    if (node.left == 0) {
      for (std::size_t i = node.begin; i < node.end; ++i) {
        const Vec3d shares = nearest_shares(*triangles_[i], p);
        const double distance = glm::length(p - PaintedTriangle::mix(triangles_[i]->at, shares));
        if (distance < found.distance) found = {triangles_[i], shares, distance};
      }
      return;
    }
    std::array<std::pair<double, std::size_t>, 2> sides{std::pair{outside(node.left, p), node.left},
                                                        std::pair{outside(node.right, p), node.right}};
    std::sort(sides.begin(), sides.end());
    for (const auto& [distance, side] : sides) {
      if (distance < found.distance) search(side, p, found);
    }
  }

  std::vector<const PaintedTriangle*> triangles_;
  std::vector<Node> nodes_;
};

/// A surface: all of it, and chart by chart.
class ChartedSurface {
 public:
  explicit ChartedSurface(std::span<const PaintedTriangle> triangles) : whole_(pointers(triangles)) {
    std::map<std::uint32_t, std::vector<const PaintedTriangle*>> by_chart;
    for (const PaintedTriangle& t : triangles) by_chart[t.chart].push_back(&t);
    for (auto& [chart, own] : by_chart) charts_.emplace(chart, PlainTree(std::move(own)));
  }
  [[nodiscard]] bool has(std::uint32_t chart) const { return charts_.count(chart) > 0; }
  [[nodiscard]] PlainTree::Found nearest(const Vec3d& p, std::uint32_t chart) const {
    const auto own = charts_.find(chart);
    return own == charts_.end() ? whole_.nearest(p) : own->second.nearest(p);
  }
  [[nodiscard]] PlainTree::Found nearest_of_all(const Vec3d& p) const { return whole_.nearest(p); }

 private:
  static std::vector<const PaintedTriangle*> pointers(std::span<const PaintedTriangle> triangles) {
    std::vector<const PaintedTriangle*> out;
    for (const PaintedTriangle& t : triangles) out.push_back(&t);
    return out;
  }
  PlainTree whole_;
  std::map<std::uint32_t, PlainTree> charts_;
};

/// A random point of each of parts * parts equal triangles. (Their middles never come near a corner, where what moved
/// is off the farthest: a quantile of many is low.)
template <class Visit>
void for_each_point(int parts, SplitMix64& random, const Visit& visit) {
  for (int n = 0; n < parts * parts; ++n) {  // rows of i + j cells that point up, and i + j that point down
    const int row = static_cast<int>(std::sqrt(n)), at = n - row * row, i = at / 2, j = row - i;
    double s = random.unit(), t = random.unit();
    if (s + t > 1.0) s = 1.0 - s, t = 1.0 - t;
    if (at % 2 != 0) s = 1.0 - s, t = -t;
    visit(Vec3d(parts - i - j - s - t, i + s, j + t) / double(parts));
  }
}

/// What `share` of the area does not exceed.
double quantile(std::vector<std::pair<double, double>>& errors, double share) {  // and areas
  std::sort(errors.begin(), errors.end());
  double total = 0.0, below = 0.0;
  for (const auto& [error, area] : errors) total += area;
  for (const auto& [error, area] : errors) {
    below += area;
    if (below >= share * total) return error;
  }
  return 0.0;
}

/// A point of the source on its way up the DAG.
struct Carried {
  Vec3d at;
  Uv uv;
  std::uint32_t chart;
  double area;
};

using Places = std::array<std::array<int, 3>, 3>;
template <class Corner>
Places places_of(const Corner& corner) {
  Places places;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3i p = corner(k);
    places[k] = {p.x, p.y, p.z};
  }
  std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
  return places;
}

std::vector<std::uint32_t> charts_of(const PreparedMesh& mesh, std::uint32_t& count) {
  std::vector<std::uint32_t> parent(mesh.wedge_position.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const std::function<std::uint32_t(std::uint32_t)> root = [&](std::uint32_t w) {
    while (parent[w] != w) w = parent[w] = parent[parent[w]];
    return w;
  };
  std::map<std::vector<double>, std::uint32_t> same;
  for (std::uint32_t w = 0; w < parent.size(); ++w) {
    std::vector<double> key{static_cast<double>(mesh.wedge_position[w])};
    for (std::uint32_t j = mesh.layout.uv_offset(); j < mesh.layout.color_offset(); ++j) {
      key.push_back(double{mesh.wedge_attributes[w * mesh.layout.stride() + j]});
    }
    parent[root(w)] = root(same.emplace(key, w).first->second);
  }
  for (const WedgeTriangle& t : mesh.triangles) {
    parent[root(t[0])] = root(t[1]);
    parent[root(t[0])] = root(t[2]);
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> charts;
  for (const WedgeTriangle& t : mesh.triangles) {
    charts.push_back(numbers.emplace(root(t[0]), static_cast<std::uint32_t>(numbers.size())).first->second);
  }
  count = static_cast<std::uint32_t>(numbers.size());
  return charts;
}

}  // namespace

ChartedDag build_charted(const scene::SourceMesh& source, const std::vector<scene::SceneMaterial>& materials) {
  const MeshPlan plan = plan_mesh(source, materials, {AttributeChoice::kAll}, "m");
  ChartedDag out{*prepare_mesh(source, plan.layout, {}), {}, {}, {}, 0};
  out.source_chart = charts_of(out.mesh, out.chart_count);
  // A digit of the charts' numbers a build: it does not change what the build makes.
  for (std::uint32_t digit = 1; digit == 1 || digit <= out.chart_count; digit *= kLabels) {
    PreparedMesh labelled = out.mesh;
    for (std::size_t t = 0; t < labelled.triangles.size(); ++t) {
      labelled.triangle_material[t] |= out.source_chart[t] / digit % kLabels << kLabelShift;
    }
    std::map<Places, std::uint32_t> label_of;  // kNoId: several
    std::mutex mutex;
    const auto note = [&](const Places& places, std::uint32_t label) {
      const auto [entry, is_new] = label_of.emplace(places, label);
      if (!is_new && entry->second != label) entry->second = kNoId;
    };
    DagOptions options;
    options.simplify_group = [&](const SimplifyInput& input, const SimplifyOptions& how) {
      SimplifyResult result = simplify_group(input, how);
      const std::lock_guard lock(mutex);
      for (std::size_t t = 0; t < result.triangles.size(); ++t) {
        note(places_of([&](std::size_t k) { return result.positions[result.wedge_position[result.triangles[t][k]]]; }),
             result.triangle_material[t] >> kLabelShift);
      }
      return result;
    };
    for (std::size_t t = 0; t < labelled.triangles.size(); ++t) {
      note(places_of(
               [&](std::size_t k) { return labelled.positions[labelled.wedge_position[labelled.triangles[t][k]]]; }),
           labelled.triangle_material[t] >> kLabelShift);
    }
    Result<LodDag> dag = build_dag(labelled, options);
    EXPECT_TRUE(dag.ok());
    if (!dag.ok()) return out;
    if (digit > 1) {
      EXPECT_EQ(dag->vertex_position, out.dag.vertex_position);
    }
    out.dag = std::move(*dag);
    out.triangle_chart.resize(out.dag.triangles.size(), 0);
    for (const DagCluster& c : out.dag.clusters) {
      for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
        const auto found = label_of.find(places_of(
            [&](std::size_t k) { return out.dag.vertex_position[c.first_vertex + out.dag.triangles[t][k]]; }));
        const std::uint32_t label = found == label_of.end() ? kNoId : found->second;
        std::uint32_t& chart = out.triangle_chart[t];
        chart = label == kNoId || chart == kNoId ? kNoId : chart + digit * label;
      }
    }
  }
  snap_attributes(out.mesh.layout, {}, out.dag);
  EXPECT_TRUE(measure(out.mesh, format::ErrorTier::kMeasured, out.dag));
  return out;
}

std::vector<CountedUvs> count_uvs(const ChartedDag& charted) {
  const PreparedMesh& mesh = charted.mesh;
  const LodDag& dag = charted.dag;
  const std::size_t stride = mesh.layout.stride(), offset = mesh.layout.uv_offset();
  const double step = std::ldexp(1.0, dag.steps->uv_log2[0]);
  const auto uv_at = [&](const std::vector<float>& attributes, std::uint32_t wedge) {  // as it is stored
    const Uv uv(attributes[wedge * stride + offset], attributes[wedge * stride + offset + 1]);
    return glm::round(uv / step) * step;
  };
  std::vector<PaintedTriangle> source(mesh.triangles.size());
  for (std::size_t t = 0; t < source.size(); ++t) {
    source[t].chart = charted.source_chart[t];
    for (std::size_t k = 0; k < 3; ++k) {
      source[t].at[k] = mesh.exact_positions[mesh.exact_triangles[t][k]];
      source[t].uv[k] = uv_at(mesh.wedge_attributes, mesh.triangles[t][k]);
    }
  }
  const ChartedSurface source_surface(source);
  SplitMix64 random(0x7576ULL);

  // What each cluster of level 0 has of the source, by places; then what each group makes takes over.
  std::vector<std::vector<Carried>> carried(dag.clusters.size());
  std::map<Places, std::vector<std::uint32_t>> clusters_at;
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const DagCluster& cluster = dag.clusters[c];
    if (cluster.own_group.is_valid()) continue;
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      clusters_at[places_of([&](std::size_t k) {
        return dag.vertex_position[cluster.first_vertex + dag.triangles[t][k]];
      })].push_back(c);
    }
  }
  const int source_parts = source.size() > 50000 ? 1 : source.size() > 4000 ? 2 : 3;
  for (std::size_t t = 0; t < source.size(); ++t) {
    std::vector<std::uint32_t>& places =
        clusters_at[places_of([&](std::size_t k) { return mesh.exact_on_grid[mesh.exact_triangles[t][k]]; })];
    EXPECT_FALSE(places.empty());
    if (places.empty()) continue;
    const std::uint32_t cluster = places.back();
    if (places.size() > 1) places.pop_back();
    for_each_point(source_parts, random, [&](const Vec3d& w) {
      carried[cluster].push_back({PaintedTriangle::mix(source[t].at, w), PaintedTriangle::mix(source[t].uv, w),
                                  source[t].chart, source[t].area() / (source_parts * source_parts)});
    });
  }

  std::vector<CountedUvs> counted(dag.groups.size());
  std::vector<std::vector<std::uint32_t>> made(dag.groups.size());
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) made[dag.clusters[c].own_group.value].push_back(c);
  }
  for (std::size_t g = dag.groups.size(); g-- > 0;) {  // from coarse to fine they are
    const DagGroup& group = dag.groups[g];
    if (group.is_terminal) continue;
    std::vector<PaintedTriangle> drawn;
    for (const std::uint32_t c : made[g]) {
      const DagCluster& cluster = dag.clusters[c];
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        PaintedTriangle& triangle = drawn.emplace_back();
        triangle.chart = charted.triangle_chart[t];
        triangle.cluster = c;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = cluster.first_vertex + dag.triangles[t][k];
          triangle.at[k] = mesh.grid.decode(dag.vertex_position[v]);
          triangle.uv[k] = uv_at(dag.vertex_attributes, v);
        }
      }
    }
    const ChartedSurface surface(drawn);
    std::vector<std::pair<double, double>> own, any, back;
    const int parts = source.size() > 50000 ? 2 : drawn.size() > 500 ? 3 : 6;
    for (const PaintedTriangle& t : drawn) {
      for_each_point(parts, random, [&](const Vec3d& w) {
        const Vec3d at = PaintedTriangle::mix(t.at, w);
        const Uv uv = PaintedTriangle::mix(t.uv, w);
        const auto off = [&](const PlainTree::Found& found) {
          return glm::length(uv - PaintedTriangle::mix(found.triangle->uv, found.shares));
        };
        own.emplace_back(off(source_surface.nearest(at, t.chart)), t.area());
        any.emplace_back(off(source_surface.nearest_of_all(at)), t.area());
      });
    }
    CountedUvs& count = counted[g];
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      if (dag.clusters[c].own_group.is_valid()) {
        const CountedUvs& finer = counted[dag.clusters[c].own_group.value];
        for (std::size_t i = 0; i < 3; ++i) count.both[i] = std::max(count.both[i], finer.both[i]);
      }
      for (const Carried& point : std::exchange(carried[c], {})) {
        const PlainTree::Found found = surface.nearest(point.at, point.chart);
        back.emplace_back(glm::length(point.uv - PaintedTriangle::mix(found.triangle->uv, found.shares)), point.area);
        count.vanished += surface.has(point.chart) ? 0 : 1;
        carried[found.triangle->cluster].push_back(point);
      }
    }
    count.of_group = quantile(own, kShares[1]);
    count.nearest = quantile(any, kShares[1]);
    for (std::size_t i = 0; i < 3; ++i) {
      count.both[i] = std::max({count.both[i], quantile(own, kShares[i]), quantile(back, kShares[i])});
    }
  }
  return counted;
}

}  // namespace meshlode::builder::test
