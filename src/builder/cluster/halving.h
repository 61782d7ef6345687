// SPDX-License-Identifier: GPL-3.0-or-later
// The last cuts of a recursive bisection, of graphs of some dozen nodes. METIS coarsens each of them, cuts what is left
// several times and refines the best on the way back, which pays on large graphs. A small one is cut at the median of
// its nodes along their principal axis or near it (inertial bisection), and the cut is refined (Fiduccia and Mattheyses
// 1982).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "builder/cluster/partition.h"

namespace meshlode::builder {

/// Of one graph; keeps its memory from cut to cut.
class Halving {
 public:
  /// `centers`: where each node of the graph lies. Both must outlive the object.
  Halving(const Graph& graph, std::span<const Vec3f> centers)
      : graph_(graph), centers_(centers), local_(graph.node_count(), kNoId) {}

  /// Cuts the graph between `nodes` into parts of about equal weight, labelled first_label … first_label + parts - 1.
  /// `nodes` are put in another order. No part is empty if there are as many nodes as parts. Time grows with the square
  /// of the nodes. \pre parts > 0
  void cut(std::span<std::uint32_t> nodes, std::uint32_t parts, std::uint32_t first_label,
           std::vector<std::uint32_t>& labels);

 private:
  void take(std::span<const std::uint32_t> nodes);
  void project(std::span<const std::uint32_t> nodes);
  void sweep(float tilt);
  void take_up(const std::vector<std::uint8_t>& is_right);
  [[nodiscard]] bool refine_once();
  void move(std::uint32_t node);
  /// How much the left half weighs beyond what is allowed, or below.
  [[nodiscard]] std::int32_t imbalance() const;

  const Graph& graph_;
  std::span<const Vec3f> centers_;
  std::vector<std::uint32_t> local_;  ///< by node of the graph; kNoId: not among those that are cut
  // What is cut, by local node.
  std::vector<std::uint32_t> start_;                           ///< into edges_, and the end
  std::vector<std::pair<std::uint32_t, std::int32_t>> edges_;  ///< other end and weight
  std::vector<std::int32_t> weight_, around_;                  ///< of the node, and of all its edges
  std::vector<Vec2f> along_;                                   ///< the principal axes
  std::int32_t target_ = 0;                                    ///< of the left half
  // The cut that is tried.
  std::vector<std::uint8_t> is_right_;
  std::vector<std::int32_t> gain_;  ///< what moving the node would take off the cut
  std::int32_t left_ = 0, cut_ = 0;
  std::vector<std::uint8_t> best_, is_moved_, is_listed_;
  std::vector<std::uint32_t> border_;  ///< those that have an edge in the cut, or had one
  std::vector<std::uint32_t> moves_;
  std::vector<std::uint64_t> order_;  ///< nodes in the order of a direction
  std::vector<std::uint32_t> left_nodes_, right_nodes_;
};

}  // namespace meshlode::builder
