// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/promises.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "format/names.h"
#include "judge/metrics/coverage.h"
#include "judge/metrics/shaded_surface.h"
#include "judge/metrics/triangle_area.h"
#include "judge/verify/texel_budget.h"

namespace meshlode::judge {

namespace {

/// The mesh's groups with the promise's errors in the place of the position's.
std::vector<format::GroupRecord> groups_of(const run::Asset& asset, format::Promise promise) {
  std::vector<format::GroupRecord> groups(asset.groups().begin(), asset.groups().end());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const format::PromiseGroupRecord& errors = asset.promise_errors()[g];
    groups[g].error = promise == format::Promise::kTexels ? errors.texel_error : errors.appearance_error;
  }
  return groups;
}

double level0_of(const run::Asset& asset, MeshId mesh, format::Promise promise) {
  const format::PromiseMeshRecord& record = asset.promises()[mesh.value];
  return promise == format::Promise::kTexels ? record.level0_texels : record.level0_appearance;
}

/// How many texels one unit of each TEXCOORD_n crosses in u and in v, the most of any texture that a material samples.
struct Texels {
  std::array<Vec2d, scene::kMaxUvSets> most{};
  std::array<bool, scene::kMaxUvSets> is_known{};  ///< the sizes of all of them are
};

std::vector<Texels> texels_of_materials(const scene::Scene& scene) {
  std::vector<std::optional<std::pair<std::uint32_t, std::uint32_t>>> sizes;  // of the blobs
  for (const scene::SceneBlob& blob : scene.blobs) {
    const bool is_image = blob.kind == scene::SceneBlob::Kind::kImage;
    sizes.push_back(is_image ? stated_image_size(blob.bytes) : std::nullopt);
  }
  std::vector<Texels> out(scene.materials.size());
  for (std::size_t m = 0; m < out.size(); ++m) {
    out[m].is_known.fill(true);
    for (const scene::TextureUse& use : scene.materials[m].textures) {
      if (use.uv_set >= scene::kMaxUvSets) continue;
      const auto size = use.blob < sizes.size() ? sizes[use.blob] : std::nullopt;
      if (!size) out[m].is_known[use.uv_set] = false;
      // What is not known is something all the same: the set is sampled.
      const Vec2d texels(std::abs(use.scale[0]) * (size ? size->first : 1U),
                         std::abs(use.scale[1]) * (size ? size->second : 1U));
      if (std::isfinite(texels.x) && std::isfinite(texels.y)) {
        out[m].most[use.uv_set] = glm::max(out[m].most[use.uv_set], texels);
      }
    }
  }
  return out;
}

/// Object units of a UV unit in u and v by the mean size of a texel; nothing where that cannot be told.
std::optional<Vec2d> uv_units_of(const scene::SourceMesh& mesh, std::span<const Texels> of_materials, std::size_t set) {
  Vec2d most(0.0);
  double surface = 0.0, uv_area = 0.0;
  for (const scene::Primitive& p : mesh.primitives) {
    if (p.material.value >= of_materials.size()) continue;
    const Texels& texels = of_materials[p.material.value];
    if (!(texels.most[set].x > 0.0) || !(texels.most[set].y > 0.0)) continue;
    if (!texels.is_known[set] || p.uvs[set].empty()) return std::nullopt;
    most = glm::max(most, texels.most[set]);
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      const std::uint32_t* v = &p.indices[i];
      if (!has_area(p.positions[v[0]], p.positions[v[1]], p.positions[v[2]])) continue;
      const Vec3d n = glm::cross(p.positions[v[1]] - p.positions[v[0]], p.positions[v[2]] - p.positions[v[0]]);
      const Vec2d a(p.uvs[set][v[0]]), b = Vec2d(p.uvs[set][v[1]]) - a, c = Vec2d(p.uvs[set][v[2]]) - a;
      const double crossed = std::abs(b.x * c.y - b.y * c.x);
      if (!std::isfinite(crossed)) return std::nullopt;
      surface += 0.5 * glm::length(n);
      uv_area += 0.5 * crossed;
    }
  }
  if (!(most.x > 0.0) || !(surface > 0.0) || !(uv_area > 0.0)) return std::nullopt;
  return most * std::sqrt(surface / (most.x * most.y * uv_area));
}

}  // namespace

Result<std::vector<CutDeviation>> measure_promised_cuts(const run::Asset& asset, MeshId mesh,
                                                        const scene::SourceMesh& source, format::Promise promise,
                                                        std::uint32_t cuts, std::uint64_t samples) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const std::vector<format::GroupRecord> groups = groups_of(asset, promise);
  run::SelectTables tables = run::tables_of(asset);
  tables.groups = groups;
  const ProductScales scales = scales_of(asset, mesh, promise);
  const ShadedSurface truth = painted_surface_of_source(source);
  const double rounding = position_rounding(record) + rounding_of(truth, scales);
  const ProductDistanceFrom from_truth(truth, scales, {.samples = samples});
  const auto own = tables.groups.subspan(record.first_group, record.group_count);
  std::vector<double> thresholds = spread_thresholds(own, cuts);
  if (cuts > 1) thresholds.insert(thresholds.begin(), -1.0);  // level 0 alone
  std::vector<CutDeviation> measured;
  std::vector<ClusterId> previous;
  for (const double threshold : thresholds) {
    const run::UniformCut cut = run::select_uniform(tables, mesh, threshold);
    if (cut.clusters == previous) continue;
    previous = cut.clusters;
    TRY_LET(surface, shaded_surface_of_clusters(asset, mesh, cut.clusters));
    double stored = level0_of(asset, mesh, promise);
    for (const ClusterId id : cut.clusters) {
      const std::uint32_t group = asset.clusters()[id.value].own_group;
      if (group != format::kNone) stored = std::max(stored, double{groups[group].error});
    }
    measured.push_back({threshold, stored, from_truth.find_largest(*surface), rounding});
  }
  return measured;
}

DeviationTotals check_promise(const run::Asset& asset, const scene::Scene& source, format::Promise promise,
                              std::uint32_t cuts, std::uint64_t samples, RuleLog& log) {
  const std::string name(format::name_of(promise));
  DeviationTotals totals;
  std::vector<double> ratios;
  for (std::uint32_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    if (has_aggregates(asset, MeshId(m))) continue;
    const bool is_proven = asset.meshes()[m].error_tier == format::ErrorTier::kCertified;
    const double limit = is_proven ? 1.0 : 1.0 + kMeasuredShortfall;
    const auto measured = measure_promised_cuts(asset, MeshId(m), source.meshes[m], promise, cuts, samples);
    if (!measured) {
      log.add(Rule::kL204, measured.error().where, measured.error().detail);
      continue;
    }
    for (const CutDeviation& cut : *measured) {
      ratios.push_back(cut.ratio());
      ++totals.cuts;
      if (cut.is_above(1.0)) ++totals.exceeded;
      log.expect(
          !cut.is_above(limit), Rule::kV209, [&] { return place("mesh", m); },
          [&] {
            char text[200];
            std::snprintf(text, sizeof text,
                          "%s: the cut at error %.6g stores %.6g and is %.6g from the source, %.3f times that, most at "
                          "(%.6g %.6g %.6g)",
                          name.c_str(), cut.threshold, cut.stored, cut.truth.max, cut.ratio(), cut.truth.worst.x,
                          cut.truth.worst.y, cut.truth.worst.z);
            return std::string(text);
          });
    }
  }
  if (ratios.empty()) return totals;
  std::sort(ratios.begin(), ratios.end());
  totals.worst = ratios.back();
  totals.median = ratios[ratios.size() / 2];
  return totals;
}

void check_promise_units(const run::Asset& asset, const scene::Scene& source, RuleLog& log) {
  constexpr double kRounding = 1e-5;  // of sums over triangles, and of the floats that are stored
  constexpr double kHighlightRadius = 0.125;
  const std::vector<Texels> of_materials = texels_of_materials(source);
  for (std::uint32_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    if (has_aggregates(asset, MeshId(m))) continue;
    const format::MeshRecord& record = asset.meshes()[m];
    const format::PromiseMeshRecord& units = asset.promises()[m];
    const auto is_near = [](double a, double b) { return std::abs(a - b) <= kRounding * std::abs(b); };
    const double radius = record.normal_mode == format::NormalMode::kNone ? 0.0 : kHighlightRadius * record.diagonal;
    if ((units.promises & format::kPromisesAppearance) != 0 && radius <= 1e30 && (radius == 0.0 || radius >= 1e-30)) {
      log.expect(
          is_near(double{units.normal_object}, radius), Rule::kV210, [&] { return place("mesh", m); },
          [&] { return differs("normal_object", double{units.normal_object}, "diagonal / 8", radius); });
    }
    for (std::uint32_t k = 0; k < record.uv_set_count; ++k) {
      if (record.uv_set_source[k] >= scene::kMaxUvSets) continue;
      const std::optional<Vec2d> expected = uv_units_of(source.meshes[m], of_materials, record.uv_set_source[k]);
      if (!expected || !(std::min(expected->x, expected->y) >= 1e-30) || std::max(expected->x, expected->y) > 1e30) {
        continue;
      }
      for (int axis = 0; axis < 2; ++axis) {
        const double stored = units.uv_object[k][axis];
        log.expect(
            is_near(stored, (*expected)[axis]), Rule::kV210, [&] { return place("mesh", m, "UV set", k); },
            [&] { return differs(axis == 0 ? "u" : "v", stored, "by the source's texels", (*expected)[axis]); });
      }
    }
  }
}

}  // namespace meshlode::judge
