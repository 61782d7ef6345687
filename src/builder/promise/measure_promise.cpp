// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/promise/measure_promise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "builder/hierarchy/lod_bounds.h"
#include "builder/hierarchy/margins.h"
#include "builder/promise/product_surfaces.h"
#include "builder/promise/promise_certifier.h"
#include "builder/promise/promise_meter.h"

namespace meshlode::builder {

namespace {

/// Measured, or of the tier certified proven.
template <std::size_t D>
ProductDeviations measure_in(const PaintedSource& source, const ProductSpace& space, const LodDag& dag,
                             const format::MeshRecord& record, std::vector<double> least) {
  if (record.error_tier != format::ErrorTier::kCertified)
    return PromiseMeter<D>(source, space, dag, record).measure(std::move(least));
  const ProductSurfaces<D> surfaces(space, dag, record);
  return PromiseCertifier<D>(surfaces, dag, {record.grid.log2, record.grid.mantissa}, quantization_of(space, record))
      .certify(source);
}

/// Nothing where the space has positions alone and their errors are known. `errors`: per group, what its error is at
/// least.
std::optional<ProductDeviations> measure(const PaintedSource& source, const ProductSpace& space, const LodDag& dag,
                                         const format::MeshRecord& record, double margin,
                                         const std::vector<float>& errors) {
  const std::size_t dimensions = space.dimensions();
  if (dimensions <= 3 && record.error_tier != format::ErrorTier::kQem) return std::nullopt;
  std::vector<double> least;
  least.reserve(errors.size());
  for (const float error : errors) least.push_back(double{error} / margin);
  if (dimensions <= 5) return measure_in<5>(source, space, dag, record, std::move(least));
  if (dimensions <= 6) return measure_in<6>(source, space, dag, record, std::move(least));
  if (dimensions <= 8) return measure_in<8>(source, space, dag, record, std::move(least));
  return measure_in<14>(source, space, dag, record, std::move(least));
}

/// Makes errors nest along the DAG and above `least`, which does. Groups come coarse to fine.
std::vector<float> nest(const LodDag& dag, const std::optional<ProductDeviations>& measured, double margin,
                        const std::vector<float>& least) {
  if (!measured) return least;
  std::vector<float> errors(least.size());
  for (std::size_t g = errors.size(); g-- > 0;) {
    const DagGroup& group = dag.groups[g];
    if (group.is_terminal) {
      errors[g] = format::kInfiniteError;
      continue;
    }
    float finer = 0.0F;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const GroupId own = dag.clusters[c].own_group;
      if (own.is_valid()) finer = std::max(finer, errors[own.value]);
    }
    errors[g] = grow_error(std::max(margin * measured->groups[g], double{least[g]}), finer);
  }
  return errors;
}

}  // namespace

PromiseErrors measure_promises(const PaintedSource& source, const LodDag& dag, const format::MeshRecord& record,
                               std::span<const format::GroupRecord> groups, double margin, std::uint32_t promises) {
  PromiseErrors out;
  out.mesh = source.units;
  out.mesh.promises = promises;
  std::vector<float> least;
  for (const format::GroupRecord& group : groups) least.push_back(group.error);

  const auto texels = measure(source, product_space_of(source, false), dag, record, margin, least);
  const std::vector<float> texel_errors = nest(dag, texels, margin, least);
  out.mesh.level0_texels = std::max(record.level0_deviation, texels ? float_above(texels->level0) : 0.0F);
  const bool has_appearance = (promises & format::kPromisesAppearance) != 0;
  std::vector<float> appearance_errors(groups.size(), 0.0F);
  if (has_appearance) {
    auto appearance = source.units.normal_object > 0.0F
                          ? measure(source, product_space_of(source, true), dag, record, margin, texel_errors)
                          : std::nullopt;
    if (appearance && record.error_tier == format::ErrorTier::kCertified) {
      // Normals are at most 2 apart, and what has none is not compared in them. Not by hypot(): it depends on the C
      // library.
      const double apart = 2.0 * double{source.units.normal_object};
      const auto at_most = [&](double proven, double proven_texels) {
        return std::min(proven, std::sqrt(proven_texels * proven_texels + apart * apart));
      };
      appearance->level0 = at_most(appearance->level0, out.mesh.level0_texels);
      for (std::size_t g = 0; g < groups.size(); ++g)
        appearance->groups[g] = at_most(appearance->groups[g], std::max(out.mesh.level0_texels, texel_errors[g]));
    }
    appearance_errors = nest(dag, appearance, margin, texel_errors);
    // Level 0 is measured where the normals are those of triangles: with the margin of what samples find. Proven it is
    // in any case, and the margin is 1 then.
    const double level0 = appearance ? appearance->level0 * (source.layout.flat_normal ? margin : 1.0) : 0.0;
    out.mesh.level0_appearance = std::max(out.mesh.level0_texels, float_above(level0));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) out.groups.push_back({texel_errors[g], appearance_errors[g]});
  return out;
}

PromiseErrors promises_of_positions(const format::MeshRecord& record, std::span<const format::GroupRecord> groups,
                                    std::uint32_t promises) {
  PromiseErrors out;
  out.mesh.promises = promises;
  const bool has_appearance = (promises & format::kPromisesAppearance) != 0;
  out.mesh.level0_texels = record.level0_deviation;
  out.mesh.level0_appearance = has_appearance ? record.level0_deviation : 0.0F;
  for (const format::GroupRecord& group : groups) {
    out.groups.push_back({group.error, has_appearance ? group.error : 0.0F});
  }
  return out;
}

}  // namespace meshlode::builder
