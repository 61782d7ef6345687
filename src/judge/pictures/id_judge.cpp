// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/id_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/try.h"

namespace meshlode::judge {

namespace {

/// Of a distance, what depths in 32 bits and positions in doubles leave open.
constexpr double kDepthRounding = 1e-6;
/// So many surfaces are drawn by themselves for a camera.
constexpr std::size_t kMostSurfaces = 64;

/// Pixels of a finer picture along a side of one: with 4 a slanted ribbon of a twentieth of a pixel leaves dots about
/// five finer pixels apart, which is within what is allowed.
constexpr std::uint32_t kFiner = 4;
/// Of a finer picture: those of 640 × 640, which is more than verify draws, have as many, and take 350 MB. Larger
/// ones are judged as they are.
constexpr std::uint64_t kMostFinerPixels = std::uint64_t{2560} * 2560;

double distance_of(const draw::Projection& p, std::uint32_t depth) {
  const double share = std::max(depth, 1U) / 4294967296.0;
  return p.is_orthographic ? p.far_distance - share * (p.far_distance - p.near_distance) : p.near_distance / share;
}

}  // namespace

Result<SourceIds> IdJudge::draw_source_ids(const run::Camera& camera) const {
  TRY_LET(projection, draw::make_projection(camera));
  projection->far_distance = draw::scene_depth(asset_, *projection);
  return SourceIds{
      *projection, painter_.of_source(source_, draw_source(asset_, source_, *projection, masks_)), {}, {}, {}};
}

const std::vector<std::uint32_t>& IdJudge::depths_of(SourceIds& truth, std::uint64_t id) const {
  std::vector<std::uint32_t>& depths = truth.of_surface[id];
  if (depths.empty()) {
    SourceDrawing drawing;
    drawing.mesh = static_cast<std::uint32_t>(id >> 32U);
    drawing.material = static_cast<std::uint32_t>(id);
    depths = draw_source(asset_, source_, truth.projection, masks_, drawing).depth;
  }
  return depths;
}

bool IdJudge::has_both_in_one_place(SourceIds& truth, const IdPicture& cut, std::uint32_t pixel) const {
  const std::uint64_t shown = truth.ids.id[pixel], other = cut.id[pixel];
  if (shown == IdPicture::kBackground || other == IdPicture::kBackground) return false;
  if (truth.of_surface.size() >= kMostSurfaces && !truth.of_surface.contains(other)) return false;
  const std::uint32_t behind = depths_of(truth, other)[pixel];
  if (behind == 0) return false;
  const double distance = distance_of(truth.projection, behind);
  const double gap = distance - distance_of(truth.projection, truth.ids.depth[pixel]);
  return gap <= double{truth.ids.level0[pixel]} + double{cut.level0[pixel]} + kDepthRounding * distance;
}

bool IdJudge::add_surfaces_in_one_place(std::span<const AstrayPixel> astray, SourceIds& truth, IdPicture& cut) const {
  bool has_any = false;
  for (const AstrayPixel& a : astray) {
    if (!has_both_in_one_place(truth, cut, a.pixel)) continue;
    if (!has_any) {
      truth.ids.also.assign(truth.ids.id.size(), IdPicture::kBackground);
      cut.also = truth.ids.also;
      has_any = true;
    }
    truth.ids.also[a.pixel] = cut.id[a.pixel];
    cut.also[a.pixel] = truth.ids.id[a.pixel];
  }
  return has_any;
}

Status IdJudge::look_closer(SourceIds& truth, const run::Camera& camera, std::span<const run::ClusterInstance> cut,
                            const IdPicture& ids, const AllowedPixels& allowed,
                            std::vector<AstrayPixel>& astray) const {
  if (std::uint64_t{camera.width} * camera.height > kMostFinerPixels / (kFiner * kFiner)) return Ok{};
  run::Camera closer = camera;
  closer.width *= kFiner;
  closer.height *= kFiner;
  if (truth.finer.id.empty()) {
    TRY_LET(source, draw_source_ids(closer));
    truth.finer = std::move(source->ids);
  }
  TRY_LET(drawn, draw::draw_cut(asset_, cut, closer, masks_));
  TRY_LET(finer, painter_.of_cut(cut, *drawn));
  dismiss_narrow(truth.ids, ids, truth.finer, *finer, kFiner, allowed, astray);
  return Ok{};
}

Result<IdDistance> IdJudge::judge_cut(SourceIds& truth, const run::Camera& camera,
                                      std::span<const run::ClusterInstance> cut, const draw::VisibilityBuffer& drawn,
                                      double pixel_error) const {
  TRY_LET(ids, painter_.of_cut(cut, drawn));
  std::vector<AstrayPixel> astray = find_astray(truth.ids, *ids, AllowedPixels(truth.projection, pixel_error));
  if (!astray.empty()) {
    TRY_LET(both_sides, draw::draw_cut(asset_, cut, camera, masks_, draw::Sides::kBoth));
    if (truth.both_sides.empty()) {
      SourceDrawing drawing;
      drawing.sides = draw::Sides::kBoth;
      truth.both_sides = draw_source(asset_, source_, truth.projection, masks_, drawing).depth;
    }
    const auto is_behind_a_back = [&](const AstrayPixel& a) {
      return both_sides->depth[a.pixel] > drawn.depth[a.pixel] || truth.both_sides[a.pixel] > truth.ids.depth[a.pixel];
    };
    std::erase_if(astray, is_behind_a_back);
    if (add_surfaces_in_one_place(astray, truth, *ids)) {
      astray = find_astray(truth.ids, *ids, AllowedPixels(truth.projection, pixel_error));
      std::erase_if(astray, is_behind_a_back);
      truth.ids.also.clear();
    }
  }
  if (is_beyond_limit(sum_up(truth.ids, *ids, astray))) {
    TRY(look_closer(truth, camera, cut, *ids, AllowedPixels(truth.projection, pixel_error), astray));
  }
  return sum_up(truth.ids, *ids, astray);
}

void IdTotals::add(const std::string& picture, const IdDistance& distance) {
  ++pictures;
  if (is_beyond_limit(distance)) ++beyond_limit;
  all.pixels += distance.pixels;
  all.astray += distance.astray;
  all.farthest_px = std::max(all.farthest_px, distance.farthest_px);
  if (distance.share() <= worst.share()) return;
  worst = distance;
  worst_picture = picture;
}

std::string describe(const IdTotals& totals) {
  if (totals.all.astray == 0) return "every pixel shows the surface that the source shows there";
  char head[160], tail[80];
  if (std::isfinite(totals.all.farthest_px)) {
    std::snprintf(head, sizeof head, "%.3f%% of pixels show another surface than the source, none farther than %.1f px",
                  100.0 * totals.all.share(), totals.all.farthest_px);
  } else {
    std::snprintf(head, sizeof head,
                  "%.3f%% of pixels show another surface than the source, some of which is nowhere else",
                  100.0 * totals.all.share());
  }
  std::snprintf(tail, sizeof tail, "; at worst %.3f%% (", 100.0 * totals.worst.share());
  return head + (tail + totals.worst_picture) + ")";
}

}  // namespace meshlode::judge
