// SPDX-License-Identifier: GPL-3.0-or-later
#include "extract_cuts.h"
#include "base/try.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "app/export/choose_cuts.h"

namespace meshlode::cli {

namespace {

constexpr std::uint32_t kMaxLods = 16;

Error usage(const char* option, const char* detail) {
  return Error{ErrorCode::kUsage, option, detail};
}

/// How many units of a mesh the error 1 is: a diagonal with --relative, less for large instances with --world.
double error_unit(const CutRequest& request, const run::Asset& asset, std::size_t mesh) {
  if (request.is_relative) return asset.meshes()[mesh].diagonal;
  if (!request.is_world) return 1.0;
  double scale = 0.0;
  for (const format::InstanceRecord& instance : asset.instances()) {
    if (instance.mesh == mesh && (instance.flags & format::kInstanceSingular) == 0) {
      scale = std::max(scale, instance.scale);
    }
  }
  return scale > 0.0 ? 1.0 / scale : 1.0;
}

CutLevel make_level(const run::Asset& asset, run::UniformCut cut, std::optional<double> asked = {}) {
  CutLevel level;
  for (const ClusterId c : cut.clusters) level.triangles += asset.clusters()[c.value].triangle_count();
  level.cut = std::move(cut);
  level.asked = asked;
  return level;
}

CutLevel cut_at_error(const CutRequest& request, const run::AttributeBounds& bounds, const run::Asset& asset,
                      MeshId mesh, double error) {
  const run::CutError by = value_in(run::kCutErrorNames, request.by).value_or(run::CutError::kSelection);
  const double asked = error * error_unit(request, asset, mesh.value);
  return make_level(asset, run::select_uniform(asset, mesh, asked, by, bounds), asked);
}

Status choose_by_camera(const CutRequest& request, const run::AttributeBounds& bounds, const run::Asset& asset,
                        const std::vector<bool>& chosen, std::vector<MeshCuts>& out) {
  TRY_LET(camera, make_camera(request.camera, asset));
  std::vector<run::UniformCut> cuts = app::choose_camera_cuts(asset, *camera, request.camera.pixel_error, bounds);
  for (std::size_t m = 0; m < out.size(); ++m) {
    if (chosen[m]) out[m].levels.push_back(make_level(asset, std::move(cuts[m])));
  }
  return Ok{};
}

Status choose_by_budget(const CutRequest& request, const run::Asset& asset, const std::vector<bool>& chosen,
                        std::vector<MeshCuts>& out) {
  std::vector<double> units(out.size(), 0.0);
  for (std::size_t m = 0; m < units.size(); ++m) {
    if (!chosen[m]) continue;
    const double unit = error_unit(request, asset, m);
    units[m] = unit > 0.0 ? unit : 1.0;  // a mesh that is one point has no diagonal
  }
  app::BudgetCuts budget = app::choose_budget_cuts(asset, units, *request.triangles);
  if (!budget.is_met) {
    return Error{ErrorCode::kCheckFailed, "--triangles",
                 "the coarsest cut has " + std::to_string(budget.triangles) + " triangles"};
  }
  for (std::size_t m = 0; m < out.size(); ++m) {
    if (chosen[m]) out[m].levels.push_back(make_level(asset, std::move(budget.cuts[m])));
  }
  return Ok{};
}

/// The finest cut of one mesh with at most this share of its finest triangles, or the coarsest that there is.
CutLevel cut_at_ratio(const run::Asset& asset, MeshId mesh, double ratio, std::uint64_t finest_triangles) {
  std::vector<double> units(asset.meshes().size(), 0.0);
  units[mesh.value] = 1.0;
  const double budget = std::floor(ratio * static_cast<double>(finest_triangles));
  return make_level(
      asset, std::move(app::choose_budget_cuts(asset, units, static_cast<std::uint64_t>(budget)).cuts[mesh.value]));
}

/// A level may be shown where it is off by at most t pixels: at a distance where t pixels are its error, the mesh's
/// bounding sphere covers (diagonal / error) · t pixels of the picture's height. The level before it is meant down to
/// there.
void set_coverage(const CutRequest& request, double diagonal, std::uint32_t height, std::vector<CutLevel>& levels) {
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const double error = levels[k + 1].cut.stored_error;
    const double pixels = error > 0.0 ? diagonal / error * request.camera.pixel_error : 0.0;
    levels[k].screen_coverage = error > 0.0 ? std::min(1.0, pixels / height) : 1.0;
  }
}

Result<std::vector<double>> parse_list(const char* option, const std::string& text) {
  auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() > kMaxLods) return usage(option, "give 1 to 16 numbers, comma-separated");
  return std::move(*numbers);
}

Status choose_chains(const CutRequest& request, const run::AttributeBounds& bounds, const run::Asset& asset,
                     const std::vector<bool>& chosen, std::vector<MeshCuts>& out) {
  std::vector<double> errors;
  std::vector<double> ratios;
  if (request.lod_errors) {
    TRY_LET(list, parse_list("--lod-errors", *request.lod_errors));
    errors = std::move(*list);
    const bool rises = std::adjacent_find(errors.begin(), errors.end(), std::greater_equal<>()) == errors.end();
    if (!rises || errors.front() < 0.0) return usage("--lod-errors", "give rising errors, 0 or more");
  } else if (request.lod_ratios) {
    TRY_LET(list, parse_list("--lod-ratios", *request.lod_ratios));
    ratios = std::move(*list);
    const bool falls = std::adjacent_find(ratios.begin(), ratios.end(), std::less_equal<>()) == ratios.end();
    if (!falls || ratios.front() > 1.0 || ratios.back() < 0.0) {
      return usage("--lod-ratios", "give falling shares of the triangles, 1 at most");
    }
  } else {
    double ratio = 1.0;
    for (std::uint32_t k = 0; k < *request.lods; ++k, ratio *= 0.5) ratios.push_back(ratio);
  }
  TRY_LET(camera, make_camera(request.camera, asset));
  for (std::size_t m = 0; m < out.size(); ++m) {
    if (!chosen[m]) continue;
    const MeshId mesh(m);
    std::vector<CutLevel>& levels = out[m].levels;
    const auto add = [&](CutLevel level) {  // a mesh that is coarse already has fewer levels
      if (levels.empty() || level.cut.clusters != levels.back().cut.clusters) levels.push_back(std::move(level));
    };
    for (const double error : errors) add(cut_at_error(request, bounds, asset, mesh, error));
    const std::uint64_t finest =
        ratios.empty() ? 0 : make_level(asset, app::choose_level_cut(asset, mesh, 0)).triangles;
    for (const double ratio : ratios) add(cut_at_ratio(asset, mesh, ratio, finest));
    set_coverage(request, asset.meshes()[m].diagonal, camera->height, levels);
  }
  return Ok{};
}

}  // namespace

Status check_request(const CutRequest& r) {
  const int ways = (r.error ? 1 : 0) + (r.level ? 1 : 0) + (r.has_camera() ? 1 : 0) + (r.triangles ? 1 : 0) +
                   (r.lods ? 1 : 0) + (r.lod_errors ? 1 : 0) + (r.lod_ratios ? 1 : 0);
  if (ways != 1) {
    return usage("--error",
                 "give one of --error, --level, --triangles, --lods, --lod-errors, --lod-ratios and a camera");
  }
  if (r.error && (!(*r.error >= 0.0) || !std::isfinite(*r.error))) return usage("--error", "give a number, 0 or more");
  if (r.lods && (*r.lods == 0 || *r.lods > kMaxLods)) return usage("--lods", "give 1 to 16 levels");
  if (r.is_relative && r.is_world) return usage("--relative", "not together with --world");
  if (!r.error && !r.triangles && !r.lod_errors && (r.is_relative || r.is_world)) {
    return usage("--relative", "--relative and --world belong to --error, --triangles and --lod-errors");
  }
  if (!r.error && !r.lod_errors && r.by != CutRequest().by) {
    return usage("--by", "belongs to --error and --lod-errors");
  }
  if (!r.error && !r.lod_errors && !r.has_camera() && r.bounds.has_any()) {
    return usage("--normal-error", "--normal-error and --uv-error belong to --error, --lod-errors and a camera");
  }
  return Ok{};
}

namespace {

/// A level that one of the chosen meshes has: of a coarser one there is no cut.
Status check_level(std::uint32_t level, const run::Asset& asset, const std::vector<bool>& chosen) {
  std::uint32_t coarsest = 0;
  for (std::size_t m = 0; m < chosen.size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    if (!chosen[m]) continue;
    for (const format::ClusterRecord& cluster : asset.clusters().subspan(mesh.first_cluster, mesh.cluster_count)) {
      coarsest = std::max<std::uint32_t>(coarsest, cluster.level);
    }
  }
  if (level <= coarsest) return Ok{};
  return Error{ErrorCode::kUsage, "--level",
               "there is no level " + std::to_string(level) + ": the levels are 0, the finest, to " +
                   std::to_string(coarsest) + ", the coarsest"};
}

}  // namespace

Result<std::vector<MeshCuts>> choose_cuts(const CutRequest& request, const run::Asset& asset,
                                          const std::vector<bool>& chosen) {
  std::vector<MeshCuts> cuts(asset.meshes().size());
  for (std::size_t m = 0; m < cuts.size(); ++m) cuts[m].mesh = MeshId(m);
  TRY_LET(bounds, make_bounds(request.bounds, asset));
  Status status = Ok{};
  if (request.level) {
    TRY(check_level(*request.level, asset, chosen));
  }
  if (request.has_camera()) {
    status = choose_by_camera(request, *bounds, asset, chosen, cuts);
  } else if (request.triangles) {
    status = choose_by_budget(request, asset, chosen, cuts);
  } else if (request.is_chain()) {
    status = choose_chains(request, *bounds, asset, chosen, cuts);
  } else {
    for (std::size_t m = 0; m < cuts.size(); ++m) {
      if (!chosen[m]) continue;
      cuts[m].levels.push_back(request.error
                                   ? cut_at_error(request, *bounds, asset, MeshId(m), *request.error)
                                   : make_level(asset, app::choose_level_cut(asset, MeshId(m), *request.level)));
    }
  }
  if (!status) return status.error();
  return cuts;
}

}  // namespace meshlode::cli
