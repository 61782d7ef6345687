// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_mesh.h"

#include <algorithm>

#include "builder/simplify/edge_uses.h"

namespace meshlode::builder {

CollapseMesh::CollapseMesh(const std::vector<WedgeTriangle>& triangles,
                           const std::vector<std::uint32_t>& wedge_position, std::size_t vertex_count)
    : vertex_(3 * triangles.size()),
      wedge_(3 * triangles.size()),
      next_(3 * triangles.size(), kEnd),
      edge_(3 * triangles.size(), kEnd),
      head_(vertex_count, kEnd),
      tail_(vertex_count, kEnd),
      is_alive_(triangles.size(), 1),
      alive_count_(static_cast<std::uint32_t>(triangles.size())) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      wedge_[3 * t + k] = triangles[t][k];
      vertex_[3 * t + k] = wedge_position[triangles[t][k]];
    }
    const std::uint32_t* v = &vertex_[3 * std::size_t{t}];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      is_alive_[t] = 0;
      --alive_count_;
      continue;
    }
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t at = vertex_[corner];
      if (head_[at] == kEnd) {
        head_[at] = corner;
      } else {
        next_[tail_[at]] = corner;
      }
      tail_[at] = corner;
    }
  }
}

void CollapseMesh::number_edges(std::span<const EdgeUse> uses) {
  ends_.reserve(uses.size() / 2);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const bool is_first = i == 0 || uses[i].a != uses[i - 1].a || uses[i].b != uses[i - 1].b;
    if (is_first) ends_.push_back({uses[i].a, uses[i].b});
    edge_[uses[i].corner] = static_cast<std::uint32_t>(ends_.size() - 1);
  }
}

// Corners of dead triangles are unlinked on the way, so that none is met twice.
void CollapseMesh::gather(std::uint32_t vertex, Ring& out) {
  out.vertex = vertex;
  out.count = 0;
  out.is_hub = false;
  std::uint32_t previous = kEnd;
  for (std::uint32_t corner = head_[vertex]; corner != kEnd; corner = next_[corner]) {
    if (!is_alive(corner / 3)) continue;
    if (previous == kEnd) {
      head_[vertex] = corner;
    } else {
      next_[previous] = corner;
    }
    previous = corner;
    if (out.count == Ring::kMost) {
      out.is_hub = true;
      return;
    }
    out.corner[out.count++] = corner;
  }
  if (previous == kEnd) {
    head_[vertex] = kEnd;
  } else {
    next_[previous] = kEnd;
  }
  tail_[vertex] = previous;
}

struct CollapseMesh::EdgePairs {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 2 * Ring::kMost> kept, dropped;

  /// What the edge becomes: mostly itself.
  [[nodiscard]] std::uint32_t heir_of(std::uint32_t edge) const {
    for (std::uint32_t k = 0; k < count; ++k) {
      if (dropped[k] == edge) return kept[k];
    }
    return edge;
  }
  void add(std::uint32_t keep, std::uint32_t drop) {
    if (keep == drop || heir_of(drop) != drop) return;
    kept[count] = keep;
    dropped[count++] = drop;
  }
};

/// They are sides of the triangles on the edge.
void CollapseMesh::pair_on(const Ring& a, const Ring& b, std::span<const std::uint32_t> triangles, EdgePairs& out) {
  for (const std::uint32_t t : triangles) {
    std::uint32_t kept = kEnd, dropped = kEnd;
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t u = vertex_[corner], v = vertex_[next_in_triangle(corner)];
      const bool is_at_a = u == a.vertex || v == a.vertex, is_at_b = u == b.vertex || v == b.vertex;
      if (is_at_a && is_at_b) {
        ends_[edge_[corner]][0] = kEnd;
      } else {
        (is_at_a ? kept : dropped) = edge_[corner];
      }
    }
    out.add(kept, dropped);
  }
}

/// Wherever they are: several triangles on an edge, or none between two edges that become one.
void CollapseMesh::pair_by_neighbors(const Ring& a, const Ring& b, EdgePairs& out) {
  std::array<std::uint32_t, 2 * Ring::kMost> neighbor, edge;
  std::uint32_t count = 0;
  const auto for_sides = [&](const Ring& end, const auto& visit) {
    for (const std::uint32_t corner : end.corners()) {
      const auto [next, previous] = others(corner);
      visit(next, edge_[corner]);
      visit(previous, edge_[next_in_triangle(next_in_triangle(corner))]);
    }
  };
  for_sides(a, [&](std::uint32_t other, std::uint32_t side) {
    neighbor[count] = other;
    edge[count++] = side;
  });
  for_sides(b, [&](std::uint32_t other, std::uint32_t side) {
    if (other == a.vertex) {
      ends_[side][0] = kEnd;
      return;
    }
    const auto met = std::find(neighbor.begin(), neighbor.begin() + count, other);
    if (met != neighbor.begin() + count) out.add(edge[static_cast<std::size_t>(met - neighbor.begin())], side);
  });
}

void CollapseMesh::move_ends(const Ring& b, std::uint32_t a, const EdgePairs& pairs) {
  for (const std::uint32_t corner : b.corners()) {
    if (!is_alive(corner / 3)) continue;
    vertex_[corner] = a;
    for (const std::uint32_t side : {corner, next_in_triangle(next_in_triangle(corner))}) {
      edge_[side] = pairs.heir_of(edge_[side]);
      Ends& ends = ends_[edge_[side]];
      if (ends[0] == b.vertex) ends[0] = a;
      if (ends[1] == b.vertex) ends[1] = a;
    }
  }
  for (std::uint32_t k = 0; k < pairs.count; ++k) ends_[pairs.dropped[k]][0] = kEnd;
}

// An edge that no triangle stands on any more keeps its ends: it has no star when it comes up.
void CollapseMesh::join(const Ring& a, const Ring& b, std::span<const std::uint32_t> gone, std::size_t on_edge,
                        bool is_manifold) {
  EdgePairs pairs;
  if (is_manifold) {
    pair_on(a, b, gone.first(on_edge), pairs);
  } else {
    pair_by_neighbors(a, b, pairs);
  }
  for (const std::uint32_t t : gone) is_alive_[t] = 0;
  alive_count_ -= static_cast<std::uint32_t>(gone.size());
  move_ends(b, a.vertex, pairs);
  const std::uint32_t to = a.vertex, from = b.vertex;
  if (head_[from] == kEnd) return;
  if (head_[to] == kEnd) {
    head_[to] = head_[from];
  } else {
    next_[tail_[to]] = head_[from];
  }
  tail_[to] = tail_[from];
  head_[from] = tail_[from] = kEnd;
}

}  // namespace meshlode::builder
