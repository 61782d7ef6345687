// SPDX-License-Identifier: GPL-3.0-or-later
// The constants are those of the models of docs/log/size.md and of data/, built with the default options.
#include "app/preview/estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "builder/plan/count_wedges.h"
#include "format/grid.h"

namespace meshlode::app {

namespace {

/// All levels together: each has half of the finer one's triangles.
constexpr double kStoredPerSource = 2.02;
/// Vertices on borders are in several clusters: so many more for each triangle than the mesh itself has.
constexpr double kBorderVertices = 0.19;
/// Edges that a cluster is wide, and how many bits coarser levels have more than level 0: half a bit a level.
constexpr double kEdgesAcross = 11.0;
constexpr double kCoarserBits = 1.0;
/// A cluster is nearly flat: the shear saves so many bits of its third coordinate.
constexpr double kFlatBits = 4.0;
/// Texture coordinates are predicted from positions: so many bits of each less.
constexpr double kPredictedUvBits = 2.0;
/// Of a normal at the usual scale, both coordinates.
constexpr double kNormalBits = 18.5;
constexpr double kUsualNormalScale = 811.0;
/// Of a colour channel that varies.
constexpr double kColorBits = 6.0;
/// Topology and heads, a triangle.
constexpr double kTriangleBits = 6.2;

double bits_across(double edge, double step) {
  return edge > 0.0 && step > 0.0 ? std::max(0.0, std::log2(kEdgesAcross * edge / step) + kCoarserBits) : 0.0;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median extent of an edge in one UV set, over a sample of the triangles.
double median_uv_edge(const scene::SourceMesh& mesh, std::size_t set) {
  constexpr std::size_t kSample = 20000;
  std::size_t triangles = 0;
  for (const scene::Primitive& primitive : mesh.primitives) triangles += primitive.indices.size() / 3;
  const std::size_t stride = std::max<std::size_t>(1, triangles / kSample);
  std::vector<double> extents;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto& uvs = primitive.uvs[set];
    for (std::size_t t = 0; !uvs.empty() && 3 * t + 2 < primitive.indices.size(); t += stride) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2f edge = uvs[primitive.indices[3 * t + k]] - uvs[primitive.indices[3 * t + (k + 1) % 3]];
        const double extent = std::max(std::abs(double{edge.x}), std::abs(double{edge.y}));
        if (std::isfinite(extent)) extents.push_back(extent);
      }
    }
  }
  return median(extents);
}

/// Channels of the colours that are not the same at every vertex.
int varying_channels(const scene::SourceMesh& mesh) {
  int count = 0;
  for (int k = 0; k < 4; ++k) {
    float low = 1.0F, high = 0.0F;
    for (const scene::Primitive& primitive : mesh.primitives) {
      for (const Vec4f& color : primitive.colors) {
        low = std::min(low, color[k]);
        high = std::max(high, color[k]);
      }
    }
    count += high > low ? 1 : 0;
  }
  return count;
}

}  // namespace

SizeFacts size_facts(const scene::SourceMesh& mesh, const builder::GridPlan& grid) {
  SizeFacts facts;
  for (const scene::Primitive& primitive : mesh.primitives) facts.triangles += primitive.indices.size() / 3;
  facts.position_bits = bits_across(grid.median_edge, grid.grid.step());
  for (std::size_t set = 0; set < facts.uv_edge.size(); ++set) facts.uv_edge[set] = median_uv_edge(mesh, set);
  return facts;
}

SizeEstimate estimate_size(const scene::SourceMesh& mesh, const builder::AttributeLayout& layout,
                           const SizeFacts& facts, std::int32_t normal_scale,
                           const std::array<std::int32_t, scene::kMaxUvSets>& uv_log2,
                           std::uint32_t cluster_triangles) {
  SizeEstimate out;
  if (facts.triangles == 0) return out;
  const bool is_whole = facts.triangles <= cluster_triangles;
  const auto source = static_cast<double>(facts.triangles);
  const double stored = is_whole ? source : kStoredPerSource * source;
  const double wedges =
      static_cast<double>(builder::count_wedges(mesh, layout).wedges) / source + (is_whole ? 0.0 : kBorderVertices);
  const double vertices = stored * std::min(3.0, wedges);
  const auto bytes = [&](double bits) { return vertices * bits / 8.0; };
  out.positions = bytes(std::max(0.0, 3.0 * facts.position_bits - kFlatBits));
  if (layout.has_normal) {
    out.normals = bytes(std::max(2.0, kNormalBits + 2.0 * std::log2(normal_scale / kUsualNormalScale)));
  }
  for (std::uint32_t k = 0; k < layout.uv_set_count; ++k) {
    const std::uint32_t set = layout.uv_set_source[k];
    const double across = bits_across(facts.uv_edge[set], format::exp2_exact(uv_log2[set]));
    out.uvs[k] = bytes(2.0 * std::max(0.0, across - kPredictedUvBits));
  }
  if (layout.has_color) out.colors = bytes(kColorBits * varying_channels(mesh));
  out.topology = stored * kTriangleBits / 8.0;
  return out;
}

}  // namespace meshlode::app
