// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/pictures/id_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/try.h"

namespace meshlode::judge {

Result<SourceIds> IdJudge::draw_source_ids(const run::Camera& camera) const {
  TRY_LET(projection, draw::make_projection(camera));
  projection->far_distance = draw::scene_depth(asset_, *projection);
  SourceIds out{*projection, draw_source(asset_, source_, *projection, masks_), {}};
  out.ids = painter_.of_source(source_, out.drawn);
  return out;
}

Result<IdDistance> IdJudge::judge_cut(SourceIds& truth, const run::Camera& camera,
                                      std::span<const run::ClusterInstance> cut, const draw::VisibilityBuffer& drawn,
                                      double pixel_error) const {
  TRY_LET(ids, painter_.of_cut(cut, drawn));
  const AllowedPixels allowed(truth.projection, pixel_error);
  const IdDistance distance = measure_ids(truth.ids, *ids, allowed);
  if (distance.astray == 0) return distance;
  // Backs are looked for where something is astray without.
  TRY_LET(both_sides, draw::draw_cut(asset_, cut, camera, masks_, draw::Sides::kBoth));
  ids->is_behind_backs = find_backs(drawn, *both_sides);
  if (truth.ids.is_behind_backs.empty()) {
    truth.ids.is_behind_backs =
        find_backs(truth.drawn, draw_source(asset_, source_, truth.projection, masks_, draw::Sides::kBoth));
  }
  return measure_ids(truth.ids, *ids, allowed);
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
