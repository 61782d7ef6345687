// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/attribute_steps.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "builder/encode/quantize_normal.h"
#include "builder/encode/uv_grid.h"
#include "format/grid.h"

namespace meshlode::builder {

AttributeSteps choose_steps(const AttributeLayout& layout, const LodDag& dag, const EncodeOptions& options) {
  AttributeSteps steps;
  steps.normal_scale = layout.has_normal ? normal_scale_of(options) : 0;
  const std::size_t stride = layout.stride();
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    UvRange range;
    for (std::size_t at = layout.uv_offset() + 2U * set; at < dag.vertex_attributes.size(); at += stride) {
      range.add(dag.vertex_attributes[at]);
      range.add(dag.vertex_attributes[at + 1]);
    }
    const double error = options.uv_error[set];
    steps.uv_log2[set] = choose_uv_log2(range, error > 0.0 ? error : default_uv_error(range));
  }
  return steps;
}

std::int32_t quantize_color(float value) {
  if (!(value > 0.0F)) return 0;  // NaN too
  return static_cast<std::int32_t>(std::floor(std::min(double(value), 1.0) * 255.0 + 0.5));
}

void snap_attributes(const AttributeLayout& layout, const EncodeOptions& options, LodDag& dag) {
  const AttributeSteps steps = choose_steps(layout, dag, options);
  dag.steps = steps;
  const std::size_t stride = layout.stride();
  if (stride == 0) return;
  parallel_for_each_index(dag.vertex_position.size(), kLoopGrain, [&](std::size_t v) {
    float* const at = dag.vertex_attributes.data() + v * stride;
    if (layout.has_normal) {
      const Vec3d n = octahedral_normal(nearest_octahedral_point({at[0], at[1], at[2]}, steps.normal_scale));
      for (int k = 0; k < 3; ++k) at[k] = static_cast<float>(n[k]);
    }
    for (std::uint32_t i = 0; i < 2U * layout.uv_set_count; ++i) {
      float& value = at[layout.uv_offset() + i];
      value = static_cast<float>(format::exp2_exact(steps.uv_log2[i / 2]) * quantize_uv(value, steps.uv_log2[i / 2]));
    }
    for (std::uint32_t k = 0; layout.has_color && k < 4; ++k) {
      float& value = at[layout.color_offset() + k];
      value = static_cast<float>(quantize_color(value)) / 255.0F;
    }
  });
}

}  // namespace meshlode::builder
