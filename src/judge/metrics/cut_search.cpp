// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/cut_search.h"

#include <algorithm>

namespace meshlode::judge {
namespace {

constexpr double kReach = 3.0;          // stored errors of cuts that are tried for the maximum, over x
constexpr std::size_t kNeighbours = 6;  // coarser cuts that are tried for the RMS, each a full measurement

}  // namespace

std::vector<double> cut_thresholds(const run::Asset& asset, MeshId mesh, run::CutError by) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<double> thresholds{0.0};
  for (const format::GroupRecord& group : asset.groups().subspan(record.first_group, record.group_count)) {
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    thresholds.push_back(double{by == run::CutError::kQuadric ? group.quadric_error : group.error});
  }
  std::sort(thresholds.begin(), thresholds.end());
  thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
  return thresholds;
}

std::optional<FoundCut> find_fewest_triangles(CutJudge& judge, const run::Asset& asset, MeshId mesh,
                                              const CutSearch& search) {
  const auto& [by, figure, x, few_cuts, accepts] = search;
  const std::vector<double> thresholds = cut_thresholds(asset, mesh, by);
  std::optional<FoundCut> found;
  std::size_t measured = 0;
  // A cut that is within x and coarser than what was found becomes what was found.
  const auto is_within = [&, by = by, figure = figure, x = x, &accepts = accepts](std::size_t i) {
    ++measured;
    run::UniformCut cut = run::select_uniform(asset, mesh, thresholds[i], by);
    CutJudge::Limit limit;
    (figure == Figure::kMax ? limit.max : limit.rms) = x;
    const std::optional<CutFigures> figures = judge.measure_within(cut.clusters, limit);
    if (!figures || (accepts && !accepts(cut, *figures))) return false;
    if (!found || figures->triangles < found->figures.triangles) {
      found = FoundCut{thresholds[i], std::move(cut), *figures, 0, thresholds.size()};
    }
    return true;
  };

  if (thresholds.size() <= few_cuts) {
    for (std::size_t i = 0; i < thresholds.size(); ++i) (void)is_within(i);
    if (found) found->cuts_measured = measured;
    return found;
  }
  // Stored errors are near true ones, so the search starts there and steps away from it, wider and wider. In the end
  // low is within x and high is not, or does not exist. A quadric error is a few times the RMS that comes with it, a
  // measured one several times.
  const double start = figure == Figure::kMax ? x : by == run::CutError::kQuadric ? 3.0 * x : 7.0 * x;
  const auto above = std::upper_bound(thresholds.begin(), thresholds.end(), start);
  std::size_t low = static_cast<std::size_t>(above - thresholds.begin()) - 1;  // x > 0 is above the first, 0
  std::size_t high = thresholds.size();
  if (is_within(low)) {
    for (std::size_t step = 1; low + step < high; step *= 2) {
      (is_within(low + step) ? low : high) = low + step;
    }
  } else {
    high = low;
    for (std::size_t step = 1; high > 0 && low == high; step *= 2) {
      low = high - std::min(step, high);
      if (!is_within(low)) high = low;
    }
  }
  while (high > low + 1) {
    const std::size_t middle = low + (high - low) / 2;
    (is_within(middle) ? low : high) = middle;
  }
  const double farthest = kReach * std::max(x, thresholds[low]);
  for (std::size_t i = high + 1; i < thresholds.size(); ++i) {
    if (figure == Figure::kMax ? thresholds[i] > farthest : i > high + kNeighbours) break;
    (void)is_within(i);
  }
  if (found) found->cuts_measured = measured;
  return found;
}

}  // namespace meshlode::judge
