// SPDX-License-Identifier: GPL-3.0-or-later
// BVH rules (L401 … L404): one tree per mesh whose nodes bound the groups below them (I8).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "judge/validate/exact.h"
#include "judge/validate/file_tables.h"
#include "judge/validate/margin.h"

namespace meshlode::judge {

namespace {

using format::NodeRecord;

template <class Record>
ExactBall ball_of(const Record& r) {
  return {{r.center[0], r.center[1], r.center[2]}, r.radius};
}

constexpr std::uint32_t kMaxDepth = 64;  ///< nodes from the root to a leaf, both counted

bool is_sound(const NodeRecord& node) {
  return std::isfinite(node.center[0]) && std::isfinite(node.center[1]) && std::isfinite(node.center[2]) &&
         std::isfinite(node.radius) && node.radius >= 0.0F && std::isfinite(node.error) && node.error >= 0.0F;
}

class TreeChecker {
 public:
  TreeChecker(const FileTables& file, std::size_t mesh, RuleLog& log)
      : file_(file), m_(mesh), mesh_(file.meshes[mesh]), log_(log) {}

  void run() {
    std::vector<std::uint32_t> parents(mesh_.node_count, 0);
    std::vector<std::uint32_t> leaves(mesh_.group_count, 0);
    depths_.assign(mesh_.node_count, 1);
    for (std::uint32_t k = 0; k < mesh_.node_count; ++k) check_node(k, parents, leaves);
    for (std::uint32_t k = 0; k < mesh_.node_count; ++k) {
      log_.expect(
          parents[k] == (k == 0 ? 0U : 1U), Rule::kL401, [&] { return at(k); },
          [&] { return "has " + std::to_string(parents[k]) + " parents"; });
    }
    for (std::uint32_t k = 0; k < mesh_.group_count; ++k) {
      log_.expect(
          leaves[k] == 1, Rule::kL402, [&] { return place("mesh", m_, "group", std::size_t{mesh_.first_group} + k); },
          [&] { return "is in " + std::to_string(leaves[k]) + " leaves"; });
    }
  }

 private:
  [[nodiscard]] std::string at(std::uint32_t k) const {
    return place("mesh", m_, "node", std::size_t{mesh_.first_node} + k);
  }

  void check_node(std::uint32_t k, std::vector<std::uint32_t>& parents, std::vector<std::uint32_t>& leaves) {
    const NodeRecord& node = file_.nodes[mesh_.first_node + k];
    const auto where = [&] { return at(k); };
    const bool sound =
        log_.expect(is_sound(node), Rule::kL403, where, [] { return std::string("sphere or error is not a number"); });
    if (node.child_count == 0) {
      const std::uint32_t local = node.first - mesh_.first_group;  // wraps to a large number when below
      if (!log_.expect(local < mesh_.group_count, Rule::kL402, where,
                       [&] { return "group " + std::to_string(node.first) + " is not of its mesh"; })) {
        return;
      }
      ++leaves[local];
      const format::GroupRecord& group = file_.groups[node.first];
      // Traversal takes a leaf that fails for a group that fails, so the two are the same bits.
      log_.expect(are_same_bits(ball_of(node), ball_of(group)), Rule::kL403, where,
                  [&] { return "its sphere is not that of its " + place("group", node.first); });
      log_.expect(node.error == group.error, Rule::kL404, where,
                  [&] { return differs("error", double{node.error}, "its group's", double{group.error}); });
      return;
    }
    const std::uint32_t first = node.first - mesh_.first_node;
    if (!log_.expect(node.child_count <= format::kBvhWidth && first > k && first < mesh_.node_count &&
                         node.child_count <= mesh_.node_count - first,
                     Rule::kL401, where, [&] {
                       return "children " + std::to_string(node.first) + " + " + std::to_string(node.child_count) +
                              " are not nodes of its mesh after it, or more than 8";
                     })) {
      return;
    }
    bool infinite_below = false;
    for (std::uint32_t child = first; child < first + node.child_count; ++child) {
      ++parents[child];
      depths_[child] = depths_[k] + 1;  // nodes come parents first
      log_.expect(depths_[child] <= kMaxDepth, Rule::kL401, where,
                  [] { return std::string("lies more than 64 nodes deep"); });
      infinite_below |= file_.nodes[mesh_.first_node + child].error == format::kInfiniteError;
      const NodeRecord& below = file_.nodes[mesh_.first_node + child];
      if (sound && is_sound(below)) bound(k, ball_of(below), below.error, [&] { return at(child); });
    }
    // An infinite error above finite ones only would cost traversal, never a wrong cut: yet it is not what was
    // specified.
    log_.expect(infinite_below || node.error != format::kInfiniteError, Rule::kL404, where,
                [] { return std::string("infinite without a terminal group below"); });
  }

  template <class Name>
  void bound(std::uint32_t k, const ExactBall& below, float error, const Name& name) {
    const NodeRecord& node = file_.nodes[mesh_.first_node + k];
    const ExactBall ball = ball_of(node);
    const auto where = [&] { return at(k); };
    if (std::isfinite(below.radius) && below.radius >= 0.0F) {
      if (log_.expect(contains_ball(ball, below), Rule::kL403, where, [&] { return "does not contain " + name(); })) {
        log_.expect(are_same_bits(ball, below) || has_sphere_margin(ball, below), Rule::kL403, where,
                    [&] { return "contains " + name() + " without the margin of the rule's rounding"; });
      }
    }
    log_.expect(node.error >= error && (node.error == error || has_error_margin(error, node.error)), Rule::kL404, where,
                [&] { return differs("error", double{node.error}, "below", double{error}); });
  }

  const FileTables& file_;
  std::size_t m_;
  const format::MeshRecord& mesh_;
  RuleLog& log_;
  std::vector<std::uint32_t> depths_;  ///< nodes from the root, the root counted
};

}  // namespace

void check_trees(const FileTables& file, RuleLog& log) {
  for (const Rule rule : {Rule::kL401, Rule::kL402, Rule::kL403, Rule::kL404}) log.check(rule);
  for (std::size_t m = 0; m < file.meshes.size(); ++m) TreeChecker(file, m, log).run();
}

}  // namespace meshlode::judge
