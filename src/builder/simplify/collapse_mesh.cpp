// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_mesh.h"

#include <algorithm>
#include <tuple>

namespace meshlode::builder {

CollapseMesh::CollapseMesh(const std::vector<WedgeTriangle>& triangles,
                           const std::vector<std::uint32_t>& wedge_position, std::size_t vertex_count)
    : vertex_(3 * triangles.size()),
      wedge_(3 * triangles.size()),
      next_(3 * triangles.size(), kEnd),
      head_(vertex_count, kEnd),
      tail_(vertex_count, kEnd),
      is_alive_(triangles.size(), 1),
      alive_count_(static_cast<std::uint32_t>(triangles.size())) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      wedge_[3 * t + k] = triangles[t][k];
      vertex_[3 * t + k] = wedge_position[triangles[t][k]];
    }
    const std::uint32_t* v = &vertex_[3 * t];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      kill(t);
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

void CollapseMesh::corners_of(std::uint32_t vertex, std::vector<std::uint32_t>& out) {
  out.clear();
  std::uint32_t previous = kEnd;
  for (std::uint32_t corner = head_[vertex]; corner != kEnd; corner = next_[corner]) {
    if (!is_alive(corner / 3)) continue;  // unlinked below
    if (previous == kEnd) {
      head_[vertex] = corner;
    } else {
      next_[previous] = corner;
    }
    previous = corner;
    out.push_back(corner);
  }
  if (previous == kEnd) {
    head_[vertex] = kEnd;
  } else {
    next_[previous] = kEnd;
  }
  tail_[vertex] = previous;
}

void CollapseMesh::merge_vertices(std::uint32_t to, std::uint32_t from) {
  for (std::uint32_t corner = head_[from]; corner != kEnd; corner = next_[corner]) {
    vertex_[corner] = to;
    const std::uint32_t t = corner / 3;
    if (!is_alive(t)) continue;
    const std::uint32_t* v = &vertex_[3 * t];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) kill(t);
  }
  if (head_[from] == kEnd) return;
  if (head_[to] == kEnd) {
    head_[to] = head_[from];
  } else {
    next_[tail_[to]] = head_[from];
  }
  tail_[to] = tail_[from];
  head_[from] = tail_[from] = kEnd;
}

void CollapseMesh::drop_opposite_pairs(std::uint32_t vertex, std::vector<std::uint32_t>& dropped) {
  // By the two other vertices, then in the order around `vertex`: a hub may have thousands.
  struct Spoke {
    std::uint32_t low, high, order, triangle;
    bool is_turned;
  };
  std::vector<std::uint32_t> corners;
  corners_of(vertex, corners);
  std::vector<Spoke> spokes;
  spokes.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const std::uint32_t a = vertex_[next_in_triangle(corner)];
    const std::uint32_t b = vertex_[next_in_triangle(next_in_triangle(corner))];
    spokes.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(spokes.size()), corner / 3, a > b});
  }
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& s, const Spoke& t) {
    return std::tie(s.low, s.high, s.order) < std::tie(t.low, t.high, t.order);
  });
  dropped.clear();
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (!is_alive(spokes[i].triangle)) continue;
    for (std::size_t j = i + 1; j < spokes.size() && spokes[j].low == spokes[i].low && spokes[j].high == spokes[i].high;
         ++j) {
      if (!is_alive(spokes[j].triangle) || spokes[j].is_turned == spokes[i].is_turned) continue;
      kill(spokes[i].triangle);
      kill(spokes[j].triangle);
      dropped.push_back(spokes[i].triangle);
      break;
    }
  }
}

}  // namespace meshlode::builder
