// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/measure.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/release.h"
#include "builder/deviation/deviation.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/certify_levels.h"
#include "builder/measure/material_errors.h"
#include "builder/measure/measure_levels.h"

namespace meshlode::builder {

namespace {

/// What coverage is off by is found when the DAG is made; a tier adds its margin.
void add_margin(format::ErrorTier tier, LodDag& dag) {
  if (tier == format::ErrorTier::kQem) return;
  for (DagGroup& group : dag.groups) {
    if (group.is_terminal) continue;
    group.deviation = group.quadric_error;
    if (tier == format::ErrorTier::kMeasured) group.error = kMeasuredMargin * group.quadric_error;
  }
}

/// What an asset can tell again: the simplifier's estimate as it is stored, and that nothing is measured.
void forget_errors(LodDag& dag) {
  for (DagGroup& group : dag.groups) {
    if (!group.is_terminal && group.quadric_error < double{format::kInfiniteError}) {
      group.quadric_error = static_cast<float>(group.quadric_error);
    }
    group.error = group.quadric_error;
    group.deviation = group.normal_deviation = group.uv_deviation = std::numeric_limits<double>::infinity();
  }
}

/// `on_form`: is called once the canonical form is made.
template <class OnForm>
Status measure(const PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag, const OnForm& on_form) {
  forget_errors(dag);
  const bool is_aggregate =
      std::any_of(dag.groups.begin(), dag.groups.end(), [](const DagGroup& group) { return group.is_aggregate; });
  if (is_aggregate) add_margin(tier, dag);
  if (is_aggregate || tier == format::ErrorTier::kQem || dag.triangles.empty()) return Ok{};
  Result<CanonicalForm> form = CanonicalForm{};
  std::optional<SourceTree> source;
  parallel_all([&] { form = canonical_form(mesh, dag); },
               [&] { source.emplace(mesh.exact_positions, mesh.exact_triangles); });
  if (!form) return form.error();
  on_form();
  dag.triangles.swap(form->triangles);
  const std::vector<double> least = material_errors(mesh, *form, dag);
  release(form->triangle_material);
  if (tier == format::ErrorTier::kCertified) {
    certify_levels(mesh, *std::move(source), *form, least, dag);
  } else {
    measure_levels(mesh, *std::move(source), *form, kMeasuredMargin, dag, kMostRounds, least);
  }
  dag.triangles.swap(form->triangles);
  return Ok{};
}

}  // namespace

Status measure(const PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag) {
  return measure(mesh, tier, dag, [] {});
}

Status measure_and_free(PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag) {
  const Status status = measure(mesh, tier, dag, [&] { release(mesh.exact_on_grid); });
  release(mesh.exact_positions, mesh.exact_on_grid, mesh.exact_triangles);
  return status;
}

}  // namespace meshlode::builder
