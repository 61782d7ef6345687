// SPDX-License-Identifier: GPL-3.0-or-later
// By counting: a vertex is the smaller one of a handful of edges, and few are left to be put in order by the other end.
#include "builder/simplify/edge_uses.h"

#include <algorithm>
#include <span>

namespace meshlode::builder {

namespace {

/// They come in the order of their corners, which equals keep.
void sort_by_other_end(std::span<EdgeUse> uses) {
  constexpr std::size_t kFew = 32;  // above, at a hub, insertion would be quadratic
  if (uses.size() > kFew) {
    std::sort(uses.begin(), uses.end(),
              [](const EdgeUse& x, const EdgeUse& y) { return x.b != y.b ? x.b < y.b : x.corner < y.corner; });
    return;
  }
  for (std::size_t i = 1; i < uses.size(); ++i) {
    const EdgeUse use = uses[i];
    std::size_t at = i;
    for (; at > 0 && uses[at - 1].b > use.b; --at) uses[at] = uses[at - 1];
    uses[at] = use;
  }
}

template <class Visit>
void for_each_use(const CollapseMesh& mesh, const Visit& visit) {
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_alive(t)) continue;
    const std::uint32_t v[3] = {mesh.vertex(3 * t), mesh.vertex(3 * t + 1), mesh.vertex(3 * t + 2)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = v[k == 2 ? 0 : k + 1];
      visit(EdgeUse{std::min(v[k], other), std::max(v[k], other), 3 * t + k});
    }
  }
}

}  // namespace

std::vector<EdgeUse> sorted_edge_uses(const CollapseMesh& mesh) {
  std::vector<std::uint32_t> end(mesh.vertex_count() + 1, 0);  // of the uses of each vertex, once they are in place
  for_each_use(mesh, [&](const EdgeUse& use) { ++end[use.a + 1]; });
  for (std::size_t v = 1; v < end.size(); ++v) end[v] += end[v - 1];
  std::vector<EdgeUse> uses(end.back());
  for_each_use(mesh, [&](const EdgeUse& use) { uses[end[use.a]++] = use; });
  for (std::size_t v = 0, first = 0; v < mesh.vertex_count(); first = end[v], ++v) {
    sort_by_other_end(std::span(uses).subspan(first, end[v] - first));
  }
  return uses;
}

}  // namespace meshlode::builder
