// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/id_picture.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "draw/raster/cut_pages.h"
#include "judge/metrics/coverage.h"

namespace meshlode::judge {

namespace {

/// A pixel is one sample of what it shows, and the pixels of an edge lie up to half a diagonal to either side of it in
/// both pictures: 1.42, and something for the grid.
constexpr double kSamplingPx = 1.5;
constexpr double kDepthSteps = 4294967296.0;

}  // namespace

IdPainter::IdPainter(const run::Asset& asset, const draw::Projection& projection, double pixel_error)
    : asset_(asset), projection_(projection), pixel_error_(pixel_error) {
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    is_one_surface_.push_back(has_aggregates(asset, MeshId(m)) ? 1 : 0);
  }
}

IdPicture IdPainter::blank(const draw::VisibilityBuffer& drawn) const {
  IdPicture out;
  out.width = drawn.width;
  out.height = drawn.height;
  out.id.assign(drawn.pixel_count(), IdPicture::kBackground);
  out.allowed_px.assign(drawn.pixel_count(), 0.0F);
  return out;
}

void IdPainter::paint(std::size_t pixel, std::uint32_t depth, std::uint32_t instance, std::uint32_t material,
                      IdPicture& out) const {
  const format::InstanceRecord& record = asset_.instances()[instance];
  const std::uint32_t shown = is_one_surface_[record.mesh] != 0 ? format::kNone : material;
  out.id[pixel] = std::uint64_t{record.mesh} << 32 | shown;

  const draw::Projection& p = projection_;
  const double share = depth / kDepthSteps;  // near over distance; orthographic: 1 at the near distance, 0 far away
  const double px_per_unit = p.is_orthographic ? p.pixels_per_unit : p.pixels_per_unit * share / p.near_distance;
  const double level0 = double{asset_.meshes()[record.mesh].level0_deviation} * record.scale * px_per_unit;
  double moved = std::max(pixel_error_, level0);
  const double to_near = p.is_orthographic ? (1.0 - share) * (p.far_distance - p.near_distance) * p.pixels_per_unit
                                           : (1.0 - share) * p.pixels_per_unit;
  if (!(moved < to_near)) {
    out.allowed_px[pixel] = HUGE_VALF;
    return;
  }
  if (!p.is_orthographic) {
    // Displacement in pixels is an angle times pixels_per_unit; outwards from the middle the picture stretches angles.
    const double x = static_cast<double>(pixel % out.width) + 0.5 - 0.5 * out.width;
    const double y = static_cast<double>(pixel / out.width) + 0.5 - 0.5 * out.height;
    moved *= 1.0 + (x * x + y * y) / (p.pixels_per_unit * p.pixels_per_unit);
  }
  out.allowed_px[pixel] = static_cast<float>(moved + kSamplingPx);
}

Result<IdPicture> IdPainter::of_cut(std::span<const run::ClusterInstance> cut,
                                    const draw::VisibilityBuffer& drawn) const {
  const auto pages = draw::CutPages::load(asset_, cut);
  if (!pages) return pages.error();
  std::vector<std::vector<std::uint32_t>> pixels_of(cut.size());
  for (std::size_t i = 0; i < drawn.pixel_count(); ++i) {
    if (drawn.item[i] < cut.size()) pixels_of[drawn.item[i]].push_back(static_cast<std::uint32_t>(i));
  }
  IdPicture out = blank(drawn);
  parallel_for_each_index(cut.size(), 4, [&](std::size_t item) {
    if (pixels_of[item].empty()) return;
    run::DecodedCluster cluster;
    pages->decode(asset_, cut[item].cluster, cluster);
    for (const std::uint32_t pixel : pixels_of[item]) {
      paint(pixel, drawn.depth[pixel], cut[item].instance.value, cluster.triangle_material[drawn.triangle[pixel]], out);
    }
  });
  return out;
}

IdPicture IdPainter::of_source(std::span<const SourceSurface> source, const draw::VisibilityBuffer& drawn) const {
  IdPicture out = blank(drawn);
  parallel_for_each_index(drawn.pixel_count(), kLoopGrain, [&](std::size_t i) {
    if (drawn.item[i] == draw::VisibilityBuffer::kNothing) return;
    const std::vector<std::uint32_t>& material = source[asset_.instances()[drawn.item[i]].mesh].material;
    paint(i, drawn.depth[i], drawn.item[i], material.empty() ? 0 : material[drawn.triangle[i]], out);
  });
  return out;
}

}  // namespace meshlode::judge
