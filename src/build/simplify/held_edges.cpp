// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/simplify/held_edges.h"

#include <algorithm>
#include <span>

namespace meshlode::build {

namespace {

struct Use {
  std::uint32_t a, b;    // a < b
  std::uint32_t corner;  // whose edge to the next corner this is
};

/// By edge, then by corner.
std::vector<Use> sorted_uses(const CollapseMesh& mesh) {
  std::vector<Use> uses;
  uses.reserve(3 * mesh.alive_count());
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangle_count(); ++corner) {
    if (!mesh.is_alive(corner / 3)) continue;
    const std::uint32_t a = mesh.vertex(corner);
    const std::uint32_t b = mesh.vertex(CollapseMesh::next_in_triangle(corner));
    uses.push_back({std::min(a, b), std::max(a, b), corner});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& x, const Use& y) {
    if (x.a != y.a) return x.a < y.a;
    if (x.b != y.b) return x.b < y.b;
    return x.corner < y.corner;
  });
  return uses;
}

/// Whether the texture or the colour breaks between two corners.
bool differ(const SimplifyInput& input, std::uint32_t wedge_x, std::uint32_t wedge_y) {
  const std::size_t stride = input.layout.stride();
  const float* x = &input.wedge_attributes[wedge_x * stride];
  const float* y = &input.wedge_attributes[wedge_y * stride];
  return !std::equal(x + input.layout.uv_offset(), x + stride, y + input.layout.uv_offset());
}

/// Of an edge between two triangles; 0 where nothing holds it.
double weight_between(const SimplifyInput& input, const SimplifyOptions& options, const CollapseMesh& mesh,
                      std::span<const Use> pair) {
  const Use& x = pair[0];
  const Use& y = pair[1];
  if (input.triangle_material[x.corner / 3] != input.triangle_material[y.corner / 3]) return options.border_weight;
  if (input.layout.stride() <= input.layout.uv_offset()) return 0.0;
  const auto wedge_at = [&](const Use& use, std::uint32_t vertex) {
    return mesh.wedge(mesh.vertex(use.corner) == vertex ? use.corner : CollapseMesh::next_in_triangle(use.corner));
  };
  const auto breaks_at = [&](std::uint32_t vertex) { return differ(input, wedge_at(x, vertex), wedge_at(y, vertex)); };
  return breaks_at(x.a) || breaks_at(x.b) ? options.seam_weight : 0.0;
}

}  // namespace

HeldEdges find_held_edges(const SimplifyInput& input, const SimplifyOptions& options, const CollapseMesh& mesh) {
  HeldEdges held;
  held.is_border.assign(input.positions.size(), 0);
  const std::vector<Use> uses = sorted_uses(mesh);
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
    const std::span<const Use> edge(&uses[i], end - i);
    i = end;
    const std::uint32_t a = edge[0].a, b = edge[0].b;
    int net = 0;
    for (const Use& use : edge) net += mesh.vertex(use.corner) == a ? 1 : -1;
    held.has_free_border |= net != 0 && (input.is_locked[a] == 0 || input.is_locked[b] == 0);
    const bool is_border = edge.size() != 2;
    const double weight = is_border ? 1.0 : weight_between(input, options, mesh, edge);
    if (is_border) held.is_border[a] = held.is_border[b] = 1;
    if (!(weight > 0.0)) continue;
    for (const Use& use : edge) held.edges.push_back({a, b, use.corner / 3, weight, is_border});
  }
  return held;
}

}  // namespace meshlode::build
