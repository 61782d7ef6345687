// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/id_picture.h"

#include <cmath>

#include "base/parallel.h"
#include "base/try.h"
#include "draw/raster/cut_pages.h"
#include "judge/metrics/coverage.h"

namespace meshlode::judge {

namespace {

IdPicture blank(const draw::VisibilityBuffer& drawn) {
  IdPicture out;
  out.width = drawn.width;
  out.height = drawn.height;
  out.id.assign(drawn.pixel_count(), IdPicture::kBackground);
  out.depth = drawn.depth;
  out.level0.assign(drawn.pixel_count(), 0.0F);
  return out;
}

}  // namespace

IdPainter::IdPainter(const run::Asset& asset) : asset_(asset) {
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    is_one_surface_.push_back(has_aggregates(asset, MeshId(m)) ? 1 : 0);
  }
}

void IdPainter::paint(std::size_t pixel, std::uint32_t instance, std::uint32_t material, IdPicture& out) const {
  const format::InstanceRecord& record = asset_.instances()[instance];
  const bool is_one = is_one_surface_[record.mesh] != 0;
  out.id[pixel] = id_of(record.mesh, is_one ? format::kNone : material);
  out.level0[pixel] =
      is_one ? HUGE_VALF : asset_.meshes()[record.mesh].level0_deviation * static_cast<float>(record.scale);
}

Result<IdPicture> IdPainter::of_cut(std::span<const run::ClusterInstance> cut,
                                    const draw::VisibilityBuffer& drawn) const {
  TRY_LET(pages, draw::CutPages::load(asset_, cut));
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
      paint(pixel, cut[item].instance.value, cluster.triangle_material[drawn.triangle[pixel]], out);
    }
  });
  return out;
}

IdPicture IdPainter::of_source(std::span<const SourceSurface> source, const draw::VisibilityBuffer& drawn) const {
  IdPicture out = blank(drawn);
  parallel_for_each_index(drawn.pixel_count(), kLoopGrain, [&](std::size_t i) {
    if (drawn.item[i] == draw::VisibilityBuffer::kNothing) return;
    const std::vector<std::uint32_t>& material = source[asset_.instances()[drawn.item[i]].mesh].material;
    paint(i, drawn.item[i], material.empty() ? 0 : material[drawn.triangle[i]], out);
  });
  return out;
}

}  // namespace meshlode::judge
