// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/held_edges.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "builder/gap_label.h"
#include "builder/simplify/edge_uses.h"

namespace meshlode::builder {

namespace {

/// Whether the texture or the colour breaks between two corners.
bool differ(const SimplifyInput& input, std::uint32_t wedge_x, std::uint32_t wedge_y) {
  const std::size_t stride = input.layout.stride();
  const float* x = &input.wedge_attributes[wedge_x * stride];
  const float* y = &input.wedge_attributes[wedge_y * stride];
  return !std::equal(x + input.layout.uv_offset(), x + stride, y + input.layout.uv_offset());
}

/// Of an edge between two triangles; 0 where nothing holds it.
double weight_between(const SimplifyInput& input, const SimplifyOptions& options, const CollapseMesh& mesh,
                      std::span<const EdgeUse> pair) {
  const EdgeUse& x = pair[0];
  const EdgeUse& y = pair[1];
  if (material_of(input.triangle_material[x.corner / 3]) != material_of(input.triangle_material[y.corner / 3])) {
    return options.border_weight;
  }
  if (input.layout.stride() <= input.layout.uv_offset()) return 0.0;
  const auto wedge_at = [&](const EdgeUse& use, std::uint32_t vertex) {
    return mesh.wedge(mesh.vertex(use.corner) == vertex ? use.corner : CollapseMesh::next_in_triangle(use.corner));
  };
  const auto breaks_at = [&](std::uint32_t vertex) { return differ(input, wedge_at(x, vertex), wedge_at(y, vertex)); };
  return breaks_at(x.a) || breaks_at(x.b) ? options.seam_weight : 0.0;
}

}  // namespace

HeldEdges find_held_edges(const SimplifyInput& input, const SimplifyOptions& options, const CollapseMesh& mesh,
                          std::span<const EdgeUse> uses) {
  HeldEdges held;
  held.is_border.assign(input.positions.size(), 0);
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
    const std::span<const EdgeUse> edge = uses.subspan(i, end - i);
    i = end;
    const std::uint32_t a = edge[0].a, b = edge[0].b;
    int net = 0;
    for (const EdgeUse& use : edge) net += mesh.vertex(use.corner) == a ? 1 : -1;
    const bool is_border = edge.size() != 2;
    if (edge.size() > 2 || (edge.size() == 2 && net != 0)) held.is_manifold = false;
    if (is_border) held.is_border[a] = held.is_border[b] = 1;
    if (input.stays(a) && input.stays(b)) continue;
    held.has_free_border |= net != 0;
    const double weight = is_border ? 1.0 : weight_between(input, options, mesh, edge);
    if (!(weight > 0.0)) continue;
    for (const EdgeUse& use : edge) held.edges.push_back({a, b, use.corner / 3, weight, is_border});
  }
  return held;
}

}  // namespace meshlode::builder
