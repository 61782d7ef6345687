// SPDX-License-Identifier: GPL-3.0-or-later
// A subtree stays closed to a traversal only while everything in it passes, so what passes together should lie
// together: groups of one DAG level first (their errors are alike, and a level's errors are far from another's),
// neighbours in space within it. Terminal groups never pass and get a subtree of their own, so that they hold nothing
// else open.
#include "builder/hierarchy/bvh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "builder/hierarchy/lod_bounds.h"
#include "builder/hierarchy/margins.h"

namespace meshlode::builder {
namespace {

constexpr std::uint32_t kWidth = format::kBvhWidth;

struct TreeNode {
  std::vector<std::uint32_t> children;  ///< into the tree; empty for a leaf
  std::uint32_t group = format::kNone;
};

class TreeBuilder {
 public:
  explicit TreeBuilder(std::span<const Hierarchy::Sphere> spheres) : spheres_(spheres) {}

  [[nodiscard]] const std::vector<TreeNode>& tree() const { return tree_; }

  /// A subtree over `groups`, which it reorders. \pre not empty
  std::uint32_t add_groups(std::span<std::uint32_t> groups) {
    if (groups.size() == 1) return add({{}, groups[0]});
    // Children are full subtrees of `part` groups, but for the last: few nodes, and leaves at one depth.
    std::size_t part = 1;
    while (part * kWidth < groups.size()) part *= kWidth;
    TreeNode node;
    for (const std::span<std::uint32_t> piece : split(groups, part)) node.children.push_back(add_groups(piece));
    return add(std::move(node));
  }

  /// One root over subtrees given in order of importance: the first ones lie nearest to it.
  std::uint32_t chain(std::span<const std::uint32_t> roots) {
    if (roots.size() == 1) return roots[0];
    TreeNode node;
    const std::size_t direct = roots.size() <= kWidth ? roots.size() : kWidth - 1;
    node.children.assign(roots.begin(), roots.begin() + static_cast<std::ptrdiff_t>(direct));
    if (direct < roots.size()) node.children.push_back(chain(roots.subspan(direct)));
    return add(std::move(node));
  }

 private:
  std::uint32_t add(TreeNode node) {
    tree_.push_back(std::move(node));
    return static_cast<std::uint32_t>(tree_.size() - 1);
  }

  // Halves the groups along their longest axis until each piece has `part` of them (the last may have fewer).
  std::vector<std::span<std::uint32_t>> split(std::span<std::uint32_t> groups, std::size_t part) {
    const std::size_t parts = (groups.size() + part - 1) / part;
    if (parts == 1) return {groups};
    std::array<float, 3> low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = high[axis] = spheres_[groups[0]].center[axis];
      for (const std::uint32_t g : groups) {
        low[axis] = std::min(low[axis], spheres_[g].center[axis]);
        high[axis] = std::max(high[axis], spheres_[g].center[axis]);
      }
    }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    }
    std::sort(groups.begin(), groups.end(), [&](std::uint32_t a, std::uint32_t b) {
      const float ca = spheres_[a].center[longest], cb = spheres_[b].center[longest];
      return ca != cb ? ca < cb : a < b;
    });
    const std::size_t middle = parts / 2 * part;
    std::vector<std::span<std::uint32_t>> pieces = split(groups.first(middle), part);
    for (const std::span<std::uint32_t> piece : split(groups.subspan(middle), part)) pieces.push_back(piece);
    return pieces;
  }

  std::span<const Hierarchy::Sphere> spheres_;
  std::vector<TreeNode> tree_;
};

// Breadth first, so that children are contiguous and behind their node.
std::vector<format::NodeRecord> lay_out(const std::vector<TreeNode>& tree, std::uint32_t root) {
  std::vector<format::NodeRecord> nodes(1);
  std::vector<std::uint32_t> source{root};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const TreeNode& node = tree[source[i]];
    nodes[i].child_count = static_cast<std::uint32_t>(node.children.size());
    nodes[i].first = node.children.empty() ? node.group : static_cast<std::uint32_t>(nodes.size());
    source.insert(source.end(), node.children.begin(), node.children.end());
    nodes.resize(source.size());
  }
  return nodes;
}

void set_sphere(format::NodeRecord& node, const Hierarchy::Sphere& sphere) {
  std::copy(sphere.center, sphere.center + 3, node.center);
  node.radius = sphere.radius;
}

}  // namespace

std::vector<format::NodeRecord> build_bvh(std::span<const Hierarchy::Sphere> spheres, std::span<const float> errors,
                                          std::span<const std::uint32_t> levels) {
  if (spheres.empty()) return {};
  // Terminal groups, then levels from coarse to fine.
  std::vector<std::uint32_t> order(spheres.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  const auto is_terminal = [&](std::uint32_t g) { return errors[g] >= format::kInfiniteError; };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (is_terminal(a) != is_terminal(b)) return is_terminal(a);
    if (levels[a] != levels[b]) return levels[a] > levels[b];
    return a < b;
  });
  TreeBuilder builder(spheres);
  std::vector<std::uint32_t> roots;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && is_terminal(order[end]) == is_terminal(order[begin]) &&
           (is_terminal(order[begin]) || levels[order[end]] == levels[order[begin]])) {
      ++end;
    }
    roots.push_back(builder.add_groups(std::span(order).subspan(begin, end - begin)));
    begin = end;
  }
  const std::uint32_t root = builder.chain(roots);
  std::vector<format::NodeRecord> nodes = lay_out(builder.tree(), root);

  std::vector<Hierarchy::Sphere> inner;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    format::NodeRecord& node = nodes[i];
    if (node.child_count == 0) {
      set_sphere(node, spheres[node.first]);
      continue;
    }
    inner.clear();
    for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) {
      inner.push_back({{nodes[c].center[0], nodes[c].center[1], nodes[c].center[2]}, nodes[c].radius});
    }
    set_sphere(node, enclose_spheres(inner));
  }
  set_node_errors(errors, nodes);
  return nodes;
}

void set_node_errors(std::span<const float> errors, std::span<format::NodeRecord> nodes) {
  for (std::size_t i = nodes.size(); i-- > 0;) {
    format::NodeRecord& node = nodes[i];
    if (node.child_count == 0) {
      node.error = errors[node.first];
      continue;
    }
    float error = 0.0F;
    for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) error = std::max(error, nodes[c].error);
    node.error = error >= format::kInfiniteError ? error : grow_error(0.0, error);
  }
}

}  // namespace meshlode::builder
