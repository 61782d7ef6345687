// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/product_scales.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace meshlode::judge {

ProductScales scales_of(const run::Asset& asset, MeshId mesh, format::Promise promise) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const format::PromiseMeshRecord& units = asset.promises()[mesh.value];
  ProductScales scales;
  for (std::uint32_t k = 0; k < record.uv_set_count; ++k) {
    if (record.uv_set_source[k] >= scene::kMaxUvSets) continue;
    scales.uv[record.uv_set_source[k]] = {units.uv_object[k][0], units.uv_object[k][1]};
  }
  if (promise == format::Promise::kAppearance) scales.normal = units.normal_object;
  return scales;
}

double rounding_of(const ShadedSurface& source, const ProductScales& scales) {
  double farthest = scales.normal;
  for (std::size_t n = 0; n < source.uvs.size(); ++n) {
    for (const Vec2f& uv : source.uvs[n]) {
      const double u = std::abs(scales.uv[n].x * double{uv.x}), v = std::abs(scales.uv[n].y * double{uv.y});
      if (std::isfinite(u) && std::isfinite(v)) farthest = std::max({farthest, u, v});
    }
  }
  return 0x1p-22 * farthest;
}

}  // namespace meshlode::judge
