// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/canonical_form.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "base/id_table.h"
#include "base/ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "base/try.h"
#include "base/unset_vector.h"

namespace meshlode::builder {

namespace {

using Corners = std::array<std::uint32_t, 3>;

/// How many places to the left a triangle is turned to be the least of its three turns.
template <class Triangle>
std::size_t least_turn(const Triangle& t) {
  const auto turned = [&](std::size_t by) { return std::array{t[by], t[(by + 1) % 3], t[(by + 2) % 3]}; };
  std::size_t best = 0;
  for (std::size_t by = 1; by < 3; ++by) {
    if (turned(by) < turned(best)) best = by;
  }
  return best;
}

/// The materials of a cluster's triangles, by the keys that these are ordered by.
void order_materials(const LodDag& dag, const DagCluster& cluster, std::span<const std::uint32_t> keys,
                     std::vector<std::uint32_t>& materials) {
  std::array<std::pair<std::uint32_t, std::uint32_t>, 256> of_key;
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    of_key[t] = {keys[t], dag.triangle_material[cluster.first_triangle + t]};
  }
  std::sort(of_key.begin(), of_key.begin() + cluster.triangle_count);
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    materials[cluster.first_triangle + t] = of_key[t].second;
  }
}

/// The triangles of one cluster in the order of the places and attributes of their vertices, then of their materials.
void order_cluster(const LodDag& dag, const DagCluster& cluster, std::size_t stride, CanonicalForm& form) {
  struct Vertex {
    std::uint64_t xy;  // both as numbers that order as the coordinates do, and so is z
    std::uint32_t z, local;
  };
  const auto is_before = [&](const Vertex& a, const Vertex& b) {
    if (a.xy != b.xy) return a.xy < b.xy;
    if (a.z != b.z) return a.z < b.z;
    return stride > 0 &&
           std::memcmp(&dag.vertex_attributes[(cluster.first_vertex + a.local) * stride],
                       &dag.vertex_attributes[(cluster.first_vertex + b.local) * stride], stride * sizeof(float)) < 0;
  };
  std::array<Vertex, 256> order;
  const auto end = order.begin() + cluster.vertex_count;
  for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
    const auto ordered = [](std::int32_t x) { return static_cast<std::uint32_t>(x) ^ 0x80000000U; };
    const Vec3i& p = dag.vertex_position[cluster.first_vertex + v];
    order[v] = {std::uint64_t{ordered(p.x)} << 32U | ordered(p.y), ordered(p.z), v};
  }
  std::sort(order.begin(), end, is_before);
  std::array<std::uint8_t, 256> rank{};  // of equal vertices, which quantization may leave, the same
  std::size_t first = 0;
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    if (is_before(order[first], order[i])) first = i;
    rank[order[i].local] = static_cast<std::uint8_t>(first);
  }
  std::array<std::uint32_t, 256> keys;  // three ranks, the least of the triangle's turns
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    const auto& local = dag.triangles[cluster.first_triangle + t];
    const std::uint32_t a = rank[local[0]], b = rank[local[1]], c = rank[local[2]];
    keys[t] = std::min({a << 16U | b << 8U | c, b << 16U | c << 8U | a, c << 16U | a << 8U | b});
  }
  if (!form.triangle_material.empty()) order_materials(dag, cluster, keys, form.triangle_material);
  std::sort(keys.begin(), keys.begin() + cluster.triangle_count);
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& vertex = order[keys[t] >> (16U - 8U * k) & 0xFFU];
      form.triangles[cluster.first_triangle + t][k] = static_cast<std::uint8_t>(vertex.local);
    }
  }
}

/// Triangles that are the least of their turns, in order; equal ones in the order of their ids.
std::vector<std::uint32_t> sorted(std::span<const Corners> triangles, std::size_t position_count) {
  std::vector<std::uint32_t> end(position_count + 1, 0), order(triangles.size());
  for (const Corners& t : triangles) ++end[t[0] + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::uint32_t> next(end.begin(), end.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) order[next[triangles[t][0]]++] = t;
  parallel_for_each_index(position_count, kLoopGrain, [&](std::size_t p) {
    // All of them begin at the same place.
    const auto others = [&](std::uint32_t t) { return std::uint64_t{triangles[t][1]} << 32U | triangles[t][2]; };
    std::sort(order.begin() + end[p], order.begin() + end[p + 1],
              [&](std::uint32_t a, std::uint32_t b) { return others(a) != others(b) ? others(a) < others(b) : a < b; });
  });
  return order;
}

/// Triangles by places, the least of their turns, and by how much each was turned.
struct Turned {
  std::vector<Corners> triangles;
  std::vector<std::uint8_t> turn;
  void set(std::size_t at, const Corners& t) {
    const std::size_t by = least_turn(t);
    triangles[at] = {t[by], t[(by + 1) % 3], t[(by + 2) % 3]};
    turn[at] = static_cast<std::uint8_t>(by);
  }
};

/// Of a cluster's vertices the order in which its triangles use them, then those of no triangle: of equal vertices all
/// but one.
void order_of_use(const CanonicalForm& form, const DagCluster& cluster, std::span<std::uint32_t> use) {
  std::array<bool, 256> is_used{};
  std::size_t count = 0;
  const auto add = [&](std::size_t local) {
    if (!std::exchange(is_used[local], true)) use[count++] = cluster.first_vertex + static_cast<std::uint32_t>(local);
  };
  for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
    for (const std::uint8_t local : form.triangles[t]) add(local);
  }
  for (std::size_t local = 0; local < cluster.vertex_count; ++local) add(local);
}

/// Ids of what is used, in the order of its first use. `first`: per use, the first one of the same.
UnsetVector<std::uint32_t> number_by_first_use(std::span<const std::uint32_t> first) {
  constexpr std::size_t kChunk = 16384;
  std::vector<std::uint32_t> next(chunk_count(first.size(), kChunk) + 1, 0);
  parallel_for_each_chunk(first.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t use = begin; use < end; ++use) next[chunk + 1] += first[use] == use ? 1 : 0;
  });
  std::partial_sum(next.begin(), next.end(), next.begin());
  UnsetVector<std::uint32_t> ids(first.size());
  parallel_for_each_chunk(first.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t id = next[chunk];
    for (std::size_t use = begin; use < end; ++use) {
      if (first[use] == use) ids[use] = id++;
    }
  });
  parallel_for_each_index(first.size(), kLoopGrain, [&](std::size_t use) {
    if (first[use] != use) ids[use] = ids[first[use]];
  });
  return ids;
}

/// Ids of places on the grid in the order of their first use. They are looked up in parts by their hash, each of which
/// sees its places in that order.
template <class Place>
UnsetVector<std::uint32_t> number_places(std::size_t count, const Place& place) {
  constexpr std::size_t kParts = 64, kChunk = 16384;
  const auto hash_of = [&](std::uint32_t use) { return hash_point(place(use)); };
  const auto part_of = [&](std::uint64_t hash) { return hash >> 58U; };  // tables look at the low bits
  static_assert(kParts == 1U << (64 - 58));
  std::vector<std::array<std::uint32_t, kParts>> end(chunk_count(count, kChunk));
  const auto for_each = [&](const auto& visit) {
    parallel_for_each_chunk(count, kChunk, [&](std::size_t chunk, std::size_t from, std::size_t to) {
      for (std::size_t use = from; use < to; ++use) {
        const auto id = static_cast<std::uint32_t>(use);
        visit(end[chunk][part_of(hash_of(id))], id);
      }
    });
  };
  for_each([](std::uint32_t& counted, std::uint32_t) { ++counted; });
  std::array<std::uint32_t, kParts + 1> start{};
  std::uint32_t at = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    for (auto& chunk : end) at += std::exchange(chunk[part], at);
    start[part + 1] = at;
  }
  UnsetVector<std::uint32_t> sorted(count);
  for_each([&](std::uint32_t& next, std::uint32_t use) { sorted[next++] = use; });
  UnsetVector<std::uint32_t> first(count);  // use of the same place
  parallel_for_each_index(kParts, 1, [&](std::size_t part) {
    IdTable table(start[part + 1] - start[part]);
    for (std::uint32_t i = start[part]; i < start[part + 1]; ++i) {
      const std::uint32_t use = sorted[i];
      const Vec3i here = place(use);
      const auto is_here = [&](std::uint32_t other) { return place(other) == here; };
      first[use] = table.find_or_insert(hash_point(here), use, is_here, hash_of).id;
    }
  });
  release(sorted);
  return number_by_first_use(first);
}

/// Fills position_of_vertex: the source's places come first. Returns the ids of the source's exact positions.
UnsetVector<std::uint32_t> number_positions(const PreparedMesh& mesh, const LodDag& dag, CanonicalForm& form) {
  const std::size_t source_count = mesh.exact_on_grid.size(), vertex_count = dag.vertex_position.size();
  UnsetVector<std::uint32_t> use(vertex_count);
  parallel_for_each_index(dag.clusters.size(), 64, [&](std::size_t c) {
    const DagCluster& cluster = dag.clusters[c];
    order_of_use(form, cluster, std::span(use).subspan(cluster.first_vertex, cluster.vertex_count));
  });
  UnsetVector<std::uint32_t> ids = number_places(source_count + vertex_count, [&](std::size_t i) {
    return i < source_count ? mesh.exact_on_grid[i] : dag.vertex_position[use[i - source_count]];
  });
  form.position_of_vertex.resize(vertex_count);
  parallel_for_each_index(vertex_count, kLoopGrain,
                          [&](std::size_t v) { form.position_of_vertex[use[v]] = ids[source_count + v]; });
  form.position_count = ids.empty() ? 0 : 1 + *std::max_element(ids.begin(), ids.end());
  ids.resize(source_count);
  return ids;
}

/// Fills what is known per source triangle. `of_source`: of number_positions().
Status match_level0(const PreparedMesh& mesh, const LodDag& dag, std::span<const std::uint32_t> of_source,
                    CanonicalForm& form) {
  const Error other{ErrorCode::kCheckFailed, {}, "level 0 is not made of the source's triangles (V101)"};
  std::uint32_t source_positions = 0;
  for (const std::uint32_t position : of_source) source_positions = std::max(source_positions, position + 1);
  std::vector<std::uint32_t> clusters, start;  // of level 0: where their triangles begin in one list
  std::size_t count = 0;
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) continue;
    clusters.push_back(c);
    start.push_back(static_cast<std::uint32_t>(count));
    count += dag.clusters[c].triangle_count;
  }
  if (count != mesh.exact_triangles.size()) return other;
  Turned source, level0;
  UnsetVector<CanonicalForm::Level0Triangle> places(count);
  resize_all(count, source.triangles, level0.triangles, source.turn, level0.turn);
  std::atomic<bool> is_other = false;
  parallel_for_each_index(count, kLoopGrain, [&](std::size_t t) {
    const auto& [a, b, c] = mesh.exact_triangles[t];
    source.set(t, {of_source[a], of_source[b], of_source[c]});
  });
  parallel_for_each_index(clusters.size(), 64, [&](std::size_t i) {
    const DagCluster& cluster = dag.clusters[clusters[i]];
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      const std::uint32_t triangle = cluster.first_triangle + t;
      Corners corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = form.position_of_vertex[cluster.first_vertex + form.triangles[triangle][k]];
        if (corners[k] >= source_positions) is_other = true;
      }
      level0.set(start[i] + t, corners);
      places[start[i] + t] = {clusters[i], triangle};
    }
  });
  if (is_other) return other;

  std::vector<std::uint32_t> sources, stored;
  parallel_all([&] { sources = sorted(source.triangles, source_positions); },
               [&] { stored = sorted(level0.triangles, source_positions); });
  form.level0_of_source.resize(sources.size());
  form.vertices_of_source.swap(source.triangles);  // positions there become vertices
  parallel_for_each_index(count, kLoopGrain, [&](std::size_t i) {
    const std::uint32_t s = sources[i], l = stored[i];
    WedgeTriangle& vertices = form.vertices_of_source[s];
    if (vertices != level0.triangles[l]) {
      is_other = true;
      return;
    }
    const auto [cluster, triangle] = form.level0_of_source[s] = places[l];
    for (std::size_t k = 0; k < 3; ++k) {  // corner by corner: both were turned to the same first place
      vertices[(k + source.turn[s]) % 3] =
          dag.clusters[cluster].first_vertex + form.triangles[triangle][(k + level0.turn[l]) % 3];
    }
  });
  if (is_other) return other;
  return Ok{};
}

}  // namespace

Result<CanonicalForm> canonical_form(const PreparedMesh& mesh, const LodDag& dag) {
  if (mesh.exact_on_grid.size() + dag.vertex_position.size() >= kNoId) {
    return Error{ErrorCode::kUnsupported, {}, "source and levels have more than 2^32 - 2 vertices together"};
  }
  CanonicalForm form;
  form.triangles.resize(dag.triangles.size());
  if (dag.has_several_materials()) form.triangle_material.resize(dag.triangle_material.size());
  parallel_for_each_index(dag.clusters.size(), 16,
                          [&](std::size_t c) { order_cluster(dag, dag.clusters[c], mesh.layout.stride(), form); });
  const UnsetVector<std::uint32_t> of_source = number_positions(mesh, dag, form);
  TRY(match_level0(mesh, dag, of_source, form));
  return form;
}

}  // namespace meshlode::builder
