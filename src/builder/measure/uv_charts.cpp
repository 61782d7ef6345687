// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/uv_charts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/id_table.h"
#include "base/ids.h"

namespace meshlode::builder {

/// Vertices with one place and the same texture coordinates are one key; keys that hang together are one set.
class UvCharts::Keys {
 public:
  Keys(const UvCharts& charts, std::size_t expected) : charts_(charts), table_(expected) {}

  std::uint32_t add(std::uint32_t vertex) {
    const auto entry = table_.find_or_insert(
        hash_of(vertex), static_cast<std::uint32_t>(vertex_.size()),
        [&](std::uint32_t key) { return is_same(vertex_[key], vertex); },
        [&](std::uint32_t key) { return hash_of(vertex_[key]); });
    if (entry.is_new) {
      vertex_.push_back(vertex);
      parent_.push_back(entry.id);
    }
    return entry.id;
  }
  std::uint32_t root(std::uint32_t key) {
    while (parent_[key] != key) key = parent_[key] = parent_[parent_[key]];
    return key;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(vertex_.size()); }
  /// The first that has it.
  [[nodiscard]] std::uint32_t vertex(std::uint32_t key) const { return vertex_[key]; }

 private:
  [[nodiscard]] std::size_t uv_count() const { return 2 * std::size_t{charts_.mesh_.layout.uv_set_count}; }
  [[nodiscard]] std::uint64_t hash_of(std::uint32_t vertex) const {
    std::uint64_t h = hash_word(0, charts_.form_.position_of_vertex[vertex]);
    for (std::size_t j = 0; j < uv_count(); ++j) {
      h = hash_word(h, std::bit_cast<std::uint32_t>(charts_.uvs(vertex)[j] + 0.0F));  // one zero
    }
    return h;
  }
  [[nodiscard]] bool is_same(std::uint32_t a, std::uint32_t b) const {
    return charts_.form_.position_of_vertex[a] == charts_.form_.position_of_vertex[b] &&
           std::equal(charts_.uvs(a), charts_.uvs(a) + uv_count(), charts_.uvs(b));
  }

  const UvCharts& charts_;
  IdTable table_;
  std::vector<std::uint32_t> vertex_, parent_;  ///< per key
};

template <class Visit>
void UvCharts::for_each_vertex(std::uint32_t cluster, const Visit& visit) const {
  const DagCluster& c = dag_.clusters[cluster];
  for (std::uint32_t v = c.first_vertex; v < c.first_vertex + c.vertex_count; ++v) visit(v);
}

template <class Visit>
void UvCharts::for_each_triangle(std::uint32_t cluster, const Visit& visit) const {
  const DagCluster& c = dag_.clusters[cluster];
  for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
    const auto& local = dag_.triangles[t];
    visit(WedgeTriangle{c.first_vertex + local[0], c.first_vertex + local[1], c.first_vertex + local[2]});
  }
}

UvCharts::UvCharts(const PreparedMesh& mesh, const CanonicalForm& form, const LodDag& dag)
    : mesh_(mesh), form_(form), dag_(dag), chart_(dag.vertex_position.size(), kNoId) {
  Keys keys(*this, mesh.exact_positions.size());
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (!dag.clusters[c].own_group.is_valid()) for_each_vertex(c, [&](std::uint32_t v) { chart_[v] = keys.add(v); });
  }
  for (const WedgeTriangle& t : form.vertices_of_source) {
    keys.join(chart_[t[0]], chart_[t[1]]);
    keys.join(chart_[t[0]], chart_[t[2]]);
  }
  // By their first triangles of the source, which no order within clusters changes.
  std::vector<std::uint32_t> number(keys.size(), kNoId);
  std::uint32_t count = 0;
  for (const WedgeTriangle& t : form.vertices_of_source) {
    std::uint32_t& own = number[keys.root(chart_[t[0]])];
    if (own == kNoId) own = count++;
  }
  for (std::uint32_t& chart : chart_) {
    if (chart != kNoId) chart = number[keys.root(chart)];
  }
}

/// UV units per object unit, squared: the mean over the surface.
double UvCharts::uv_scale2(std::span<const std::uint32_t> made) const {
  double area = 0.0, uv_area = 0.0;
  for (const std::uint32_t c : made) {
    for_each_triangle(c, [&](const WedgeTriangle& t) {
      const Vec3d p = mesh_.grid.decode(dag_.vertex_position[t[0]]);
      const Vec3d n = glm::cross(mesh_.grid.decode(dag_.vertex_position[t[1]]) - p,
                                 mesh_.grid.decode(dag_.vertex_position[t[2]]) - p);
      area += std::sqrt(glm::dot(n, n));
      const float *a = uvs(t[0]), *b = uvs(t[1]), *d = uvs(t[2]);
      for (std::size_t j = 0; j < 2 * std::size_t{mesh_.layout.uv_set_count}; j += 2) {
        const double bu = double{b[j]} - double{a[j]}, bv = double{b[j + 1]} - double{a[j + 1]};
        const double du = double{d[j]} - double{a[j]}, dv = double{d[j + 1]} - double{a[j + 1]};
        uv_area += std::abs(bu * dv - bv * du);
      }
    });
  }
  return area > 0.0 ? uv_area / area : 0.0;
}

void UvCharts::label(const DagGroup& group, std::span<const std::uint32_t> made) {
  std::size_t expected = 0;
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    expected += dag_.clusters[c].vertex_count;
  }
  Keys keys(*this, expected);
  std::vector<std::uint32_t> known;  // per key of a member: its chart
  known.reserve(expected);
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    for_each_vertex(c, [&](std::uint32_t v) {
      const std::uint32_t key = keys.add(v);
      if (key == known.size()) known.push_back(kNoId);
      known[key] = std::min(known[key], chart_[v]);
    });
  }
  for (const std::uint32_t c : made) {
    for_each_vertex(c, [&](std::uint32_t v) { chart_[v] = keys.add(v); });  // for now
  }
  for (const std::uint32_t c : made) {
    for_each_triangle(c, [&](const WedgeTriangle& t) {
      keys.join(chart_[t[0]], chart_[t[1]]);
      keys.join(chart_[t[0]], chart_[t[2]]);
    });
  }

  // The chart that most of the vertices say; they differ where charts came to meet.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> said;  // root, chart
  for (const std::uint32_t c : made) {
    for_each_vertex(c, [&](std::uint32_t v) {
      if (chart_[v] < known.size() && known[chart_[v]] != kNoId)
        said.emplace_back(keys.root(chart_[v]), known[chart_[v]]);
    });
  }
  std::sort(said.begin(), said.end());
  std::vector<std::uint32_t> chart_of_root(keys.size(), kNoId), votes(keys.size(), 0);
  for (std::size_t i = 0, end = 0; i < said.size(); i = end) {
    while (end < said.size() && said[end] == said[i]) ++end;
    const auto count = static_cast<std::uint32_t>(end - i);
    if (count <= votes[said[i].first]) continue;
    votes[said[i].first] = count;
    chart_of_root[said[i].first] = said[i].second;
  }

  // The rest by one vertex, the first of their first triangle: an exact answer would be no better.
  double scale2 = -1.0;  // UV units per step of the grid, squared
  const auto nearest = [&](std::uint32_t vertex) {
    if (scale2 < 0.0) scale2 = mesh_.grid.step() * mesh_.grid.step() * uv_scale2(made);
    const Vec3i place = dag_.vertex_position[vertex];
    const float* const own = uvs(vertex);
    std::pair<double, std::uint32_t> best{std::numeric_limits<double>::infinity(), kNoId};
    for (std::uint32_t key = 0; key < known.size(); ++key) {
      const std::uint32_t other = keys.vertex(key);
      const Vec3d away = Vec3d(place) - Vec3d(dag_.vertex_position[other]);
      double distance2 = glm::dot(away, away) * scale2;
      for (std::size_t j = 0; j < 2 * std::size_t{mesh_.layout.uv_set_count}; ++j) {
        const double off = double{own[j]} - double{uvs(other)[j]};
        distance2 += off * off;
      }
      best = std::min(best, {distance2, known[key]});
    }
    return best.second;
  };
  for (const std::uint32_t c : made) {
    for_each_triangle(c, [&](const WedgeTriangle& t) {
      std::uint32_t& chart = chart_of_root[keys.root(chart_[t[0]])];
      if (chart == kNoId) chart = nearest(t[0]);
    });
  }
  for (const std::uint32_t c : made) {
    for_each_vertex(c, [&](std::uint32_t v) { chart_[v] = chart_of_root[keys.root(chart_[v])]; });
  }
}

}  // namespace meshlode::builder
