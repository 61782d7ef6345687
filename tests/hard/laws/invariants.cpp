// SPDX-License-Identifier: GPL-3.0-or-later
// The judge's rules, and what a uniform cut of a closed mesh looks like.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "judge/metrics/crowded_edges.h"
#include "judge/validate/surface.h"
#include "judge/validate/validate.h"
#include "judge/verify/verify.h"
#include "laws/outcomes.h"
#include "run/decode/decode.h"
#include "run/select/select.h"

namespace meshlode::test::hard {

namespace {

/// "largest 1.037" of the line that verify prints of measured cuts.
double worst_of(const judge::VerifyReport& report) {
  for (const auto& check : report.checks) {
    const std::size_t at = check.what.find("largest ");
    if (check.invariant == "I7" && at != std::string::npos) return std::strtod(check.what.c_str() + at + 8, nullptr);
  }
  return 0.0;
}

/// Nothing in a table may be NaN: a bound that is none is never below anything.
std::string find_nan(const run::Asset& asset) {
  const auto text = [](const char* what, std::size_t i) { return std::string(what) + " " + std::to_string(i); };
  for (std::size_t g = 0; g < asset.groups().size(); ++g) {
    const format::GroupRecord& r = asset.groups()[g];
    for (const float x : {r.center[0], r.center[1], r.center[2], r.radius, r.error, r.quadric_error, r.deviation,
                          r.normal_deviation, r.uv_deviation}) {
      if (!std::isfinite(x)) return text("group", g);
    }
  }
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& r = asset.meshes()[m];
    for (const double x : {r.origin[0], r.origin[1], r.origin[2], r.diagonal, double{r.level0_deviation}}) {
      if (!std::isfinite(x)) return text("mesh", m);
    }
  }
  return {};
}

/// Object units. Infinite where nothing is drawn.
double largest_side(const scene::SourceMesh& source) {
  Vec3d low(HUGE_VAL), high(-HUGE_VAL);
  for (const scene::Primitive& primitive : source.primitives) {
    for (const std::uint32_t v : primitive.indices) {
      low = glm::min(low, primitive.positions[v]);
      high = glm::max(high, primitive.positions[v]);
    }
  }
  const Vec3d sides = high - low;
  return std::max({sides.x, sides.y, sides.z});
}

/// A mesh that has become one point and says that nothing moved, although its source is larger than that: every rule
/// holds of what is left.
bool is_lost_silently(const format::MeshRecord& mesh, const scene::SourceMesh& source) {
  if (mesh.cluster_count == 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (mesh.bounds_min[axis] != mesh.bounds_max[axis]) return false;
  }
  // Both ends of the longest side are at one point, so that one of them has moved by half of it.
  return double{mesh.level0_deviation} < 0.5 * largest_side(source);
}

/// Triangles without area at level 0, where the source's had one, as a share of all that are kept.
double collapsed_share(const format::MeshRecord& mesh) {
  const std::uint64_t dropped = mesh.dropped_degenerate + mesh.dropped_duplicate + mesh.dropped_repaired;
  const std::uint64_t kept = mesh.source_triangles - dropped;
  return kept > 0 ? static_cast<double>(mesh.grid_collapsed) / static_cast<double>(kept) : 0.0;
}

/// The edges of one cut of a mesh.
judge::EdgeCounts edges_of(const judge::MeshSurface& surface, const std::vector<ClusterId>& cut) {
  judge::EdgeCounter counter;
  for (const ClusterId id : cut) {
    const std::uint32_t c = id.value - surface.first_cluster;
    const std::uint32_t* position = &surface.vertex_position[surface.first_vertex[c]];
    for (const auto& t : surface.triangles(c)) counter.add({position[t[0]], position[t[1]], position[t[2]]});
  }
  return counter.count();
}

}  // namespace

LawResult check_invariants(const Built& base) {
  const Sample& sample = base.sample;
  const judge::ValidationReport validation = judge::validate_asset(base.bytes);
  if (!validation.findings.empty()) {
    const judge::Finding& f = validation.findings.front();
    return broken(f.id + " " + f.where + ": " + f.detail);
  }
  judge::VerifyOptions options;
  options.uniform_cuts = 24;
  options.cameras = 12;
  options.deviation_cuts = sample.crosses_itself ? 0 : 5;
  options.deviation_samples = 20000;
  const judge::VerifyReport report = judge::verify_asset(*base.asset, sample.scene, options);
  if (!report.findings.empty()) {
    const judge::Finding& f = report.findings.front();
    return broken(f.id + " " + f.where + ": " + f.detail);
  }
  if (const std::string nan = find_nan(*base.asset); !nan.empty()) return broken("not finite: " + nan);
  for (std::size_t m = 0; m < base.asset->meshes().size(); ++m) {
    if (is_lost_silently(base.asset->meshes()[m], sample.scene.meshes[m])) {
      return broken("mesh " + std::to_string(m) + " has become one point and says that nothing moved");
    }
  }
  LawResult result = kept(worst_of(report) / 1.05);  // V206 allows 5%
  double lost = sample.input_loss, collapsed = 0.0;
  for (const format::MeshRecord& mesh : base.asset->meshes()) {
    lost = std::max(lost, sample.input_loss + double{mesh.level0_deviation});
    collapsed = std::max(collapsed, collapsed_share(mesh));
  }
  char text[160];
  if (sample.feature > 0.0 && lost > 0.5 * sample.feature) {
    std::snprintf(text, sizeof text, "positions are off by up to %.2g, the smallest feature is %.2g", lost,
                  sample.feature);
    result.verdict = Verdict::kBound;
    result.detail = text;
  }
  if (collapsed > 0.5) {
    std::snprintf(text, sizeof text, "%.0f%% of the triangles have no area on the grid, which moves them by up to %.2g",
                  100.0 * collapsed, lost);
    result.verdict = Verdict::kBound;
    result.detail = text;
  }
  return result;
}

LawResult check_closed_cuts(const Built& base) {
  const run::Asset& asset = *base.asset;
  const auto decoded = run::decode_all(asset);
  if (!decoded) return broken(decoded.error().message());
  std::uint64_t most = 0, of_source = 0;
  bool is_any_closed = false;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    std::set<float> errors{0.0F};
    for (std::uint32_t g = 0; g < mesh.group_count; ++g) errors.insert(asset.groups()[mesh.first_group + g].error);
    errors.erase(format::kInfiniteError);
    const judge::MeshSurface surface = judge::build_surface(asset, MeshId(m), *decoded);
    const judge::EdgeCounts source = edges_of(surface, run::select_uniform(asset, MeshId(m), -1.0).clusters);
    of_source += source.crowded;
    is_any_closed |= source.open == 0 && mesh.cluster_count > 0;
    std::size_t at = 0;
    for (const float error : errors) {
      if (at++ % std::max<std::size_t>(1, errors.size() / 16) != 0) continue;
      const judge::EdgeCounts cut = edges_of(surface, run::select_uniform(asset, MeshId(m), double{error}).clusters);
      if (source.open == 0 && cut.open != 0) {
        char text[120];
        std::snprintf(text, sizeof text, "mesh %zu: the cut at %.6g has %llu open edges", m, double{error},
                      static_cast<unsigned long long>(cut.open));
        return broken(text);
      }
      most = std::max(most, cut.crowded);
    }
  }
  if (!is_any_closed) return not_asked("no mesh is closed");
  LawResult result = kept();
  if (most > of_source) {
    result.detail = "edges of more than two triangles: " + std::to_string(of_source) + " at level 0, up to " +
                    std::to_string(most) + " in a cut";
  }
  return result;
}

}  // namespace meshlode::test::hard
