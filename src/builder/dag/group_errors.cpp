// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/group_errors.h"

#include <algorithm>
#include <array>
#include <utility>

#include "builder/deviation/attribute_deviation.h"

namespace meshlode::builder {

namespace {

/// Carried on at least: where few triangles stand for many vanished pieces, each stands for more than two samples say.
constexpr std::size_t kSamplesPerGroup = 4096;
/// Spread over the groups of a round: coarse rounds have few, of large triangles, and cost next to nothing.
constexpr std::size_t kExtraEffort = 1500;

/// A surface as the deviation room wants it, off the grid.
struct Decoded {
  template <class Group>
  Decoded(const Group& group, const format::PositionGrid& grid) {
    positions.reserve(group.positions.size());
    for (const Vec3i& q : group.positions) positions.push_back(grid.decode(q));
    triangles.reserve(group.triangles.size());
    for (const WedgeTriangle& t : group.triangles) {
      triangles.push_back({group.wedge_position[t[0]], group.wedge_position[t[1]], group.wedge_position[t[2]]});
    }
  }
  [[nodiscard]] GroupSurface surface() const { return {positions, triangles}; }

  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The wedge of each exact position with attributes; nothing where these are the wedges themselves.
std::vector<std::uint32_t> wedges_of_exact(const PreparedMesh& mesh) {
  std::vector<std::uint32_t> wedge_of;
  if (mesh.exact_triangles == mesh.triangles) return wedge_of;
  wedge_of.resize(mesh.exact_positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) wedge_of[mesh.exact_triangles[t][k]] = mesh.triangles[t][k];
  }
  return wedge_of;
}

}  // namespace

GroupMeter::GroupMeter(const PreparedMesh& mesh, ErrorSource tier)
    : mesh_(mesh), is_certified_(tier == ErrorSource::kCertified) {
  if (tier == ErrorSource::kQuadric) return;
  source_.emplace(mesh.exact_positions, mesh.exact_triangles);
  wedge_of_exact_ = wedges_of_exact(mesh);
}

CarriedTruth GroupMeter::level0(const BuildPool& pool) const {
  CarriedTruth carried;
  if (!is_measuring()) return carried;
  if (!is_certified_) {
    carried.samples = initial_samples(*source_);
    return carried;
  }
  carried.bounds.reserve(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    TriangleCorners3 exact, on_grid;
    for (std::size_t k = 0; k < 3; ++k) {
      exact[k] = mesh_.exact_positions[mesh_.exact_triangles[t][k]];
      on_grid[k] = mesh_.grid.decode(pool.positions[pool.wedge_position[mesh_.triangles[t][k]]]);
    }
    carried.bounds.push_back(initial_bound(exact, on_grid));
  }
  return carried;
}

GroupErrors GroupMeter::measure(const BuildPool& pool, const std::vector<ClusterId>& clusters,
                                const SimplifyInput& finer, const SimplifyResult& coarser,
                                std::size_t groups_of_round) const {
  GroupErrors errors;
  if (!is_measuring()) return errors;
  const Decoded before(finer, mesh_.grid), after(coarser, mesh_.grid);
  double floor = mesh_.level0_deviation;
  for (const ClusterId c : clusters) {
    const GroupId own = pool.cluster(c).own_group;
    if (!own.is_valid()) continue;
    floor = std::max(floor, pool.group(own).error);
    errors.normal_deviation = std::max(errors.normal_deviation, pool.group(own).normal_deviation);
    errors.uv_deviation = std::max(errors.uv_deviation, pool.group(own).uv_deviation);
  }
  std::vector<TreeSlot> places;
  if (is_certified_) {
    std::vector<TriangleBound> bounds;
    bounds.reserve(finer.triangles.size());
    for (const ClusterId c : clusters) {
      const auto first = pool.triangle_bounds.begin() + pool.cluster(c).first_triangle;
      bounds.insert(bounds.end(), first, first + pool.cluster(c).triangle_count);
    }
    CertifiedGroup group = certify_group(before.surface(), bounds, after.surface());
    errors.deviation = group.deviation;
    errors.error = std::max(floor, group.deviation);
    errors.carried.bounds = std::move(group.bounds);
  } else {
    std::vector<CarriedSample> samples;
    std::size_t sample_count = 0;
    for (const ClusterId c : clusters) sample_count += pool.cluster(c).samples.size();
    samples.reserve(sample_count);
    for (const ClusterId c : clusters) pool.cluster(c).samples.append_to(samples, mesh_.exact_positions);
    // Cards and the like: no neighbour leads to a piece that went, so more of their points have to be carried.
    const std::size_t wanted =
        before.positions.size() > before.triangles.size() ? 16 * kSamplesPerGroup : kSamplesPerGroup;
    const auto per_triangle = static_cast<std::uint32_t>(wanted / std::max<std::size_t>(1, after.triangles.size()));
    GroupDeviation group = measure_group(
        *source_, after.surface(), samples,
        {.floor = floor,
         .least = floor / kMeasuredMargin,
         .margin = kMeasuredMargin,
         .samples_per_triangle = std::clamp(per_triangle, 2U, 64U),
         .extra_effort = static_cast<std::uint32_t>(kExtraEffort / std::max<std::size_t>(1, groups_of_round)),
         .finer = before.surface(),
         .finer_is_shared = finer.is_locked,
         .is_whole = groups_of_round == 1});
    errors.deviation = group.deviation;
    errors.error = std::max(floor, kMeasuredMargin * group.deviation);
    errors.carried.samples = std::move(group.carried);
    places = std::move(group.places);
  }
  const AttributeDeviation attributes =
      measure_attributes(*source_, {pool.wedge_attributes, mesh_.exact_triangles, wedge_of_exact_}, after.surface(),
                         {coarser.wedge_attributes, coarser.triangles}, mesh_.layout, places);
  errors.normal_deviation = std::max(errors.normal_deviation, attributes.normal);
  errors.uv_deviation = std::max(errors.uv_deviation, attributes.uv);
  return errors;
}

}  // namespace meshlode::builder
