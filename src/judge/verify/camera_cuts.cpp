// SPDX-License-Identifier: GPL-3.0-or-later
// Random cameras: the flat rule against the hierarchy (I8), against the rule in double precision, and each instance's
// cut against coverage and border (I5, I6).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "judge/verify/cuts.h"

namespace meshlode::judge {

namespace {

struct View {
  run::Camera camera;
  double pixel_error = 1.0;
  const char* kind = "";
};

Vec3d turn(const format::InstanceRecord& instance, const Vec3d& p) {
  const double* m = instance.transform;
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z, m[4] * p.x + m[5] * p.y + m[6] * p.z,
          m[8] * p.x + m[9] * p.y + m[10] * p.z};
}

Vec3d translation_of(const format::InstanceRecord& instance) {
  return {instance.transform[3], instance.transform[7], instance.transform[11]};
}

Vec3d transform_point(const format::InstanceRecord& instance, const Vec3d& p) {
  return turn(instance, p) + translation_of(instance);
}

/// Of the products that make turn(): their magnitudes, all rows together.
double sum_of_magnitudes(const format::InstanceRecord& instance, const Vec3d& p) {
  double sum = 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) sum += std::fabs(instance.transform[4 * row + k] * p[k]);
  }
  return sum;
}

Vec3d random_direction(SplitMix64& random) {
  for (;;) {
    const Vec3d v(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    const double length2 = glm::dot(v, v);
    if (length2 > 1e-4 && length2 <= 1.0) return v / std::sqrt(length2);
  }
}

bool is_drawable(const run::Asset& asset, const format::InstanceRecord& instance) {
  return (instance.flags & format::kInstanceSingular) == 0 && asset.meshes()[instance.mesh].cluster_count > 0;
}

/// A camera around a random cluster of a random instance, so that cuts are mixed more often than not.
View random_view(const run::Asset& asset, std::span<const std::uint32_t> instances, std::uint32_t index,
                 SplitMix64& random) {
  const format::InstanceRecord& instance = asset.instances()[instances[random.below(instances.size())]];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const format::ClusterRecord& cluster = asset.clusters()[mesh.first_cluster + random.below(mesh.cluster_count)];
  const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
  const format::CullSphere sphere = format::cull_sphere(mesh, cluster);
  const Vec3d center = transform_point(instance, origin + Vec3d(sphere.center[0], sphere.center[1], sphere.center[2]));
  const double size = std::max(mesh.diagonal * instance.scale, 1e-300);
  View view;
  double distance = 0.0;
  switch (index % 5) {
    case 0:
      view.kind = "inside";
      distance = random.between(0.0, 1.0) * double{sphere.radius} * instance.scale;
      break;
    case 1:
      view.kind = "near";
      distance = size * random.log_between(1e-2, 1.0);
      break;
    case 2:
      view.kind = "mid";
      distance = size * random.log_between(1.0, 20.0);
      break;
    case 3:
      view.kind = "far";
      distance = size * random.log_between(20.0, 1e5);
      break;
    default:
      view.kind = "orthographic";
      distance = size * random.log_between(0.5, 5.0);
      view.camera.is_orthographic = true;
      break;
  }
  view.camera.eye = center + random_direction(random) * distance;
  view.camera.target = center;
  if (distance <= 0.0) view.camera.target += Vec3d(size, 0.0, 0.0);
  view.camera.fovy = random.between(0.2, 2.2);
  view.camera.ortho_height = size * random.log_between(1e-2, 1e2);
  view.camera.near_distance = size * random.log_between(1e-6, 1e-1);
  view.camera.width = static_cast<std::uint32_t>(64 + random.below(3000));
  view.camera.height = static_cast<std::uint32_t>(64 + random.below(2100));
  view.pixel_error = random.log_between(0.02, 100.0);
  return view;
}

enum class Answer : std::uint8_t { kFails, kPasses, kTooClose };

/// What the runtime's and the judge's translation may be off by together, of the products that make it.
constexpr double kCancelled = 0x1p-49;

/// The rule of docs/reference/selection.md in doubles: e·s·k <= t·max(|M·c - eye| - r·s, near); orthographic e·s·k <=
/// t.
Answer decide(const View& view, const format::InstanceRecord& instance, const format::MeshRecord& mesh,
              const format::GroupRecord& group) {
  if (group.error >= format::kInfiniteError) return Answer::kFails;
  const run::Camera& camera = view.camera;
  const double sigma = instance.scale;
  const double k = camera.is_orthographic ? camera.height / camera.ortho_height
                                          : camera.height / (2.0 * std::tan(0.5 * camera.fovy));
  const double left = group.error * sigma * k;
  double right = view.pixel_error;
  double slack = 0.0;
  double cancelled = 0.0;
  if (!camera.is_orthographic) {
    const Vec3d c(group.center[0], group.center[1], group.center[2]);
    const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    // The eye is taken from the translation before anything is added that their size would swallow: a mesh of 1e-20
    // at 30 lies where it lies, and not at 30.
    const Vec3d moved = translation_of(instance) - camera.eye;
    const Vec3d away = turn(instance, origin + c) + moved;
    const Vec3d translation = turn(instance, origin) + moved;
    // Where squares overflow the runtime draws what is finest (docs/explanation/numerics.md); where they vanish it does
    // not care.
    if (!std::isfinite(glm::dot(away, away) + glm::dot(translation, translation))) return Answer::kTooClose;
    const double distance = std::hypot(away.x, away.y, away.z);
    const double reach = sigma * (std::sqrt(glm::dot(c, c)) + group.radius);
    right *= std::max(distance - group.radius * sigma, camera.near_distance);
    // Single precision relative to everything that was added or subtracted on the way.
    slack = view.pixel_error * (distance + reach + std::hypot(translation.x, translation.y, translation.z));
    // And double precision relative to what cancelled before: docs/explanation/numerics.md, "Where translations
    // cancel".
    cancelled = view.pixel_error * kCancelled * sum_of_magnitudes(instance, origin);
  }
  slack = (slack + left + right) * 4e-6 + cancelled;
  if (std::fabs(left - right) <= slack || !std::isfinite(left) || !std::isfinite(right)) return Answer::kTooClose;
  return left <= right ? Answer::kPasses : Answer::kFails;
}

constexpr std::size_t kMostFaultyInstances = 1000;  ///< of a camera; the rest is not looked at

struct CameraFaults {
  std::string hierarchy;  ///< V203
  std::vector<std::pair<std::uint32_t, CutFaults>> of_instance;
  CameraTotals totals;
};

void check_rule(const run::Asset& asset, const View& view, const format::InstanceRecord& instance,
                const MeshSurface& surface, std::span<const std::uint8_t> drawn, CutFaults& faults,
                CameraTotals& totals) {
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  std::vector<Answer> answers(surface.group_count);
  for (std::uint32_t k = 0; k < surface.group_count; ++k) {
    answers[k] = decide(view, instance, mesh, asset.groups()[surface.first_group + k]);
    ++totals.decisions;
    totals.too_close += answers[k] == Answer::kTooClose ? 1 : 0;
  }
  for (std::uint32_t c = 0; c < surface.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[surface.first_cluster + c];
    const Answer own =
        cluster.own_group == format::kNone ? Answer::kPasses : answers[cluster.own_group - surface.first_group];
    const Answer coarser = answers[cluster.coarser_group - surface.first_group];
    const bool surely_drawn = own == Answer::kPasses && coarser == Answer::kFails;
    const bool surely_not = own == Answer::kFails || coarser == Answer::kPasses;
    if ((surely_drawn && drawn[c] == 0) || (surely_not && drawn[c] != 0)) {
      faults.rule = place("cluster", surface.first_cluster + c) + (surely_drawn ? " is not drawn" : " is drawn");
      return;
    }
  }
}

CameraFaults judge_camera(const run::Asset& asset, std::span<const MeshJudge> judges, const View& view,
                          const Selectors& selectors) {
  CameraFaults out;
  const std::vector<run::ClusterInstance> flat = selectors.flat(asset, view.camera, view.pixel_error);
  const std::vector<run::ClusterInstance> bvh = selectors.bvh(asset, view.camera, view.pixel_error);
  if (flat != bvh) {
    const auto [a, b] = std::mismatch(flat.begin(), flat.end(), bvh.begin(), bvh.end());
    const run::ClusterInstance& first = b == bvh.end() || (a != flat.end() && *a < *b) ? *a : *b;
    out.hierarchy = std::to_string(flat.size()) + " flat, " + std::to_string(bvh.size()) +
                    " by hierarchy; first difference at " +
                    place("instance", first.instance.value, "cluster", first.cluster.value);
  }
  std::size_t next = 0;
  std::vector<std::uint8_t> drawn;
  for (std::uint32_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    const std::size_t begin = next;
    while (next < flat.size() && flat[next].instance.value == i) ++next;
    CutFaults faults;
    if (!is_drawable(asset, instance)) {
      if (next != begin) faults.coverage = "an instance that is not drawable is drawn";
    } else {
      const MeshJudge& judge = judges[instance.mesh];
      const MeshSurface& surface = judge.surface;
      drawn.assign(surface.cluster_count, 0);
      bool foreign = false;
      for (std::size_t k = begin; k < next; ++k) {
        const std::uint32_t c = flat[k].cluster.value - surface.first_cluster;
        if (c < surface.cluster_count)
          ++drawn[c];
        else
          foreign = true;
      }
      if (begin == next)
        faults.coverage = "the cut is empty";
      else if (foreign)
        faults.coverage = "clusters of another mesh are drawn";
      else
        faults.coverage = find_coverage_fault(asset, judge, drawn);
      faults.border = find_border_fault(judge, drawn);
      check_rule(asset, view, instance, surface, drawn, faults, out.totals);
      ++out.totals.cuts;
    }
    if (!faults.coverage.empty() || !faults.border.empty() || !faults.rule.empty())
      out.of_instance.emplace_back(i, faults);
    // Texts of instances times cameras are a product that a file chooses; so many say enough.
    if (out.of_instance.size() >= kMostFaultyInstances) return out;
  }
  if (next != flat.size())
    out.hierarchy = "the flat selection is not ascending or names an instance that does not exist";
  return out;
}

}  // namespace

CameraTotals check_cameras(const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t count,
                           std::uint64_t seed, RuleLog& log, const Selectors& selectors) {
  CameraTotals totals;
  std::vector<std::uint32_t> drawable;
  for (std::uint32_t i = 0; i < asset.instances().size(); ++i) {
    if (is_drawable(asset, asset.instances()[i])) drawable.push_back(i);
  }
  for (const Rule rule : {Rule::kV201, Rule::kV202, Rule::kV203, Rule::kV204}) log.check(rule);
  if (drawable.empty()) return totals;
  SplitMix64 random(seed);
  std::vector<View> views;
  for (std::uint32_t i = 0; i < count; ++i) views.push_back(random_view(asset, drawable, i, random));
  std::vector<CameraFaults> faults(views.size());
  parallel_for_each_index(views.size(), 1,
                          [&](std::size_t i) { faults[i] = judge_camera(asset, judges, views[i], selectors); });
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const std::string camera = place("camera", i) + " (" + views[i].kind + ", seed " + std::to_string(seed) + ")";
    if (!faults[i].hierarchy.empty()) log.add(Rule::kV203, camera, faults[i].hierarchy);
    for (const auto& [instance, fault] : faults[i].of_instance) {
      const std::string where = camera + ", " + place("instance", instance);
      if (!fault.coverage.empty()) log.add(Rule::kV201, where, fault.coverage);
      if (!fault.border.empty()) log.add(Rule::kV202, where, fault.border);
      if (!fault.rule.empty()) log.add(Rule::kV204, where, fault.rule);
    }
    totals.cuts += faults[i].totals.cuts;
    totals.decisions += faults[i].totals.decisions;
    totals.too_close += faults[i].totals.too_close;
  }
  totals.cameras = views.size();
  return totals;
}

}  // namespace meshlode::judge
