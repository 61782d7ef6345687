// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/resident_cuts.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "base/parallel.h"
#include "base/random.h"
#include "judge/verify/resident_judge.h"

namespace meshlode::judge {

namespace {

/// A camera's queries without root pages, beside those that are counted.
constexpr std::uint32_t kRootlessPerCamera = 5;
/// Of one camera, whose words are kept: a selection that is wrong at all is wrong for most residencies.
constexpr std::size_t kMostFaults = 20;

/// Cuts to be measured are kept of these alone.
constexpr std::uint32_t kSampledCameras = 4 * kSampledCuts;

struct Fault {
  std::string where, what;
};

struct CameraOutcome {
  std::string kind;
  std::vector<Fault> faults;
  std::uint64_t more_faults = 0;
  ResidentTotals totals;
};

Residency random_residency(const run::Asset& asset, bool has_roots, SplitMix64& random) {
  Residency out(asset.pages().size());
  const double share = random.between(0.5, 0.95);
  for (std::uint32_t page = 0; page < asset.pages().size(); ++page) {
    if (random.chance(share)) out.add(page);
  }
  for (const format::GroupRecord& group : asset.groups()) {
    if (has_roots && (group.flags & format::kGroupTerminal) != 0) out.add(group.page);
  }
  return out;
}

enum class Side : std::uint8_t { kInside, kOutside, kTooClose };

/// A cluster's culling sphere against the view volume, in world space; inside is what is not wholly outside a plane.
Side side_of(const run::Frustum& frustum, const format::InstanceRecord& instance, const format::MeshRecord& mesh,
             const format::ClusterRecord& cluster) {
  constexpr double kRounding = 1e-9;  // of all that is summed, far above that of doubles
  const format::CullSphere sphere = format::cull_sphere(mesh, cluster);
  const double* m = instance.transform;
  Side side = Side::kInside;
  for (const auto& plane : frustum.planes) {
    double at = plane[3], size = std::fabs(plane[3]), length2 = 0.0;
    for (int row = 0; row < 3; ++row) {
      at += plane[row] * m[4 * row + 3];
      size += std::fabs(plane[row] * m[4 * row + 3]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double normal = plane[0] * m[axis] + plane[1] * m[4 + axis] + plane[2] * m[8 + axis];
      at += normal * (mesh.origin[axis] + sphere.center[axis]);
      size += std::fabs(normal) * (std::fabs(mesh.origin[axis]) + std::fabs(sphere.center[axis]));
      length2 += normal * normal;
    }
    const double reach = sphere.radius * std::sqrt(length2);
    if (!(size + reach > 0.0)) continue;  // a plane of zeros
    const double rounding = kRounding * (size + reach);
    if (at + reach < -rounding) return Side::kOutside;
    if (!(at + reach > rounding)) side = Side::kTooClose;
  }
  return side;
}

class CameraCheck {
 public:
  CameraCheck(const run::Asset& asset, std::span<const MeshJudge> judges, const ResidentSelection& selection,
              std::span<const std::uint32_t> drawable, SplitMix64& random, CameraOutcome& out)
      : asset_(asset),
        judges_(judges),
        selection_(selection),
        drawable_(drawable),
        random_(random),
        tables_(run::tables_of(asset)),
        out_(out) {}

  void run(std::uint32_t index, std::uint32_t count) {
    index_ = index;
    const std::uint32_t instance = drawable_[random_.below(drawable_.size())];
    view_ = random_view(asset_, std::span(&instance, 1), index, random_);
    out_.kind = view_.kind;
    check_instance(instance, count);
    check_scene();
    check_all_pages();
    ++out_.totals.cameras;
  }

 private:
  ResidentCut select(const run::SelectTables& tables, const Residency& residency,
                     const run::Frustum* frustum = nullptr) {
    ResidentCut cut = selection_(tables, {view_.camera, view_.pixel_error, residency.words, frustum});
    out_.totals.requests += cut.requests.size();
    return cut;
  }
  bool add(const std::string& where, std::string what) {
    if (what.empty()) return false;
    if (out_.faults.size() < kMostFaults) {
      out_.faults.push_back({where, std::move(what)});
    } else {
      ++out_.more_faults;
    }
    return true;
  }

  void check_instance(std::uint32_t instance, std::uint32_t count);
  void take_sample(std::uint32_t mesh, std::span<const run::ClusterInstance> items);
  void check_scene();
  void check_all_pages();
  std::string find_cull_fault(std::span<const run::ClusterInstance> all, std::span<const run::ClusterInstance> culled,
                              const run::Frustum& frustum) const;

  const run::Asset& asset_;
  std::span<const MeshJudge> judges_;
  const ResidentSelection& selection_;
  std::span<const std::uint32_t> drawable_;
  SplitMix64& random_;
  run::SelectTables tables_;
  JudgedView view_;
  std::uint32_t index_ = 0;
  CameraOutcome& out_;
};

/// One instance by itself, so that many residencies cost little.
void CameraCheck::check_instance(std::uint32_t instance, std::uint32_t count) {
  run::SelectTables tables = tables_;
  tables.instances = tables_.instances.subspan(instance, 1);
  const format::InstanceRecord& record = tables.instances[0];
  ResidentJudge judge(asset_, judges_[record.mesh], record, view_);
  std::vector<PageWeight> weights(asset_.pages().size());
  judge.raise_weights(weights);
  for (std::uint32_t n = 0; n < count + kRootlessPerCamera; ++n) {
    const bool has_roots = n < count;
    const Residency residency = random_residency(asset_, has_roots, random_);
    const ResidentCut cut = select(tables, residency);
    ++(has_roots ? out_.totals.residencies : out_.totals.others);
    const std::string where = place("instance", instance) + ", residency " + std::to_string(n);
    const bool is_other = std::any_of(cut.items.begin(), cut.items.end(),
                                      [](const run::ClusterInstance& item) { return item.instance.value != 0; });
    const bool is_wrong = add(where, is_other ? "another instance is drawn" : judge.find_fault(residency, cut.items)) ||
                          add(where, find_request_fault(residency, cut.requests, weights));
    if (n == 0 && !is_wrong) {  // a sum over all edges of a mesh: once per camera
      ++out_.totals.borders;
      add(where, judge.find_border_fault());
    }
    if (n == 0 && !is_wrong && index_ < kSampledCameras) take_sample(record.mesh, cut.items);
    if (has_roots && judge.does_naive_rule_fail(residency)) ++out_.totals.naive_open;
  }
}

void CameraCheck::take_sample(std::uint32_t mesh, std::span<const run::ClusterInstance> items) {
  SampledCut sample{index_, MeshId(mesh), {}};
  bool is_coarser = false;
  for (const run::ClusterInstance& item : items) {
    sample.clusters.push_back(item.cluster);
    is_coarser = is_coarser || asset_.clusters()[item.cluster.value].own_group != format::kNone;
  }
  if (is_coarser) out_.totals.samples.push_back(std::move(sample));
}

/// All instances at once, culled by the picture and not.
void CameraCheck::check_scene() {
  const Residency residency = random_residency(asset_, true, random_);
  const run::Frustum frustum = run::frustum_of(view_.camera);
  const ResidentCut cut = select(tables_, residency), culled = select(tables_, residency, &frustum);
  out_.totals.others += 2;
  const std::string where = "all instances";
  if (!std::is_sorted(cut.items.begin(), cut.items.end()) ||
      !std::is_sorted(culled.items.begin(), culled.items.end())) {
    add(where, "what is drawn is not ascending");
    return;
  }
  std::vector<float> requested(asset_.pages().size());
  for (const run::PageRequest& request : culled.requests) {
    if (request.page < requested.size()) requested[request.page] = request.priority;
  }
  std::vector<PageWeight> weights(asset_.pages().size());
  const auto items_of = [](const std::vector<run::ClusterInstance>& items, std::uint32_t instance) {
    const auto [begin, end] =
        std::equal_range(items.begin(), items.end(), run::ClusterInstance{InstanceId(instance), ClusterId(0U)},
                         [](const auto& a, const auto& b) { return a.instance.value < b.instance.value; });
    return std::span(begin, end);
  };
  if (!std::includes(cut.items.begin(), cut.items.end(), culled.items.begin(), culled.items.end())) {
    add(where, "culling draws more");
    return;
  }
  std::size_t judged = 0;
  for (const std::uint32_t i : drawable_) {
    const format::InstanceRecord& record = asset_.instances()[i];
    ResidentJudge judge(asset_, judges_[record.mesh], record, view_);
    judge.raise_weights(weights);
    judged += items_of(cut.items, i).size();
    if (add(where + ", " + place("instance", i), judge.find_fault(residency, items_of(cut.items, i)))) return;
    if (add(where + ", " + place("instance", i),
            judge.find_unexplained(residency, items_of(culled.items, i), requested))) {
      return;
    }
  }
  if (judged != cut.items.size()) {
    add(where, "an instance that is not drawable is drawn");
    return;
  }
  add(where, find_request_fault(residency, cut.requests, weights));
  add(where, find_cull_fault(cut.items, culled.items, frustum));
}

std::string CameraCheck::find_cull_fault(std::span<const run::ClusterInstance> all,
                                         std::span<const run::ClusterInstance> culled,
                                         const run::Frustum& frustum) const {
  auto next = culled.begin();
  for (const run::ClusterInstance& item : all) {
    const bool is_drawn = next != culled.end() && *next == item;
    if (is_drawn) ++next;
    const format::InstanceRecord& instance = asset_.instances()[item.instance.value];
    const Side side = side_of(frustum, instance, asset_.meshes()[instance.mesh], asset_.clusters()[item.cluster.value]);
    if (side != (is_drawn ? Side::kOutside : Side::kInside)) continue;
    return place("instance", item.instance.value, "cluster", item.cluster.value) +
           (is_drawn ? " is outside the picture and drawn" : " is inside the picture and culled");
  }
  return {};
}

/// With all pages the cut is that of the selection that knows nothing of pages (V203, V204), bit for bit.
void CameraCheck::check_all_pages() {
  Residency all(asset_.pages().size());
  for (std::uint32_t page = 0; page < asset_.pages().size(); ++page) all.add(page);
  const run::Frustum frustum = run::frustum_of(view_.camera);
  out_.totals.others += 2;
  const ResidentCut cut = select(tables_, all), culled = select(tables_, all, &frustum);
  const std::string where = "all pages";
  if (cut.items != run::select_flat(tables_, view_.camera, view_.pixel_error)) {
    add(where, "the cut is not that of select_view");
  }
  if (culled.items != run::select_bvh(tables_, view_.camera, view_.pixel_error, nullptr, {}, &frustum)) {
    add(where, "the culled cut is not that of select_view");
  }
  if (!cut.requests.empty() || !culled.requests.empty()) add(where, "a page is requested");
}

}  // namespace

ResidentSelection make_resident_selection(const run::SelectTables& tables) {
  return [selector = std::make_shared<run::ResidentSelector>(tables)](const run::SelectTables& seen,
                                                                      const run::ResidentQuery& query) {
    ResidentCut cut;
    cut.items.resize(seen.clusters.size());  // a cut of one instance has less
    const std::size_t count = selector->select(seen, query, cut.items);
    cut.items.resize(count);
    if (count > seen.clusters.size()) (void)selector->select(seen, query, cut.items);
    const auto requests = selector->requests();
    cut.requests.assign(requests.begin(), requests.end());
    return cut;
  };
}

std::string describe(const ResidentTotals& totals) {
  return "whichever pages are resident, the cut is closed, drawn from them and as fine as they allow (by each group's "
         "own page alone " +
         std::to_string(totals.naive_open) + " would not be closed)";
}

ResidentTotals check_resident_cuts(const run::Asset& asset, std::span<const MeshJudge> judges, std::uint32_t count,
                                   std::uint64_t seed, RuleLog& log,
                                   const std::function<ResidentSelection(const run::SelectTables&)>& make_selection) {
  log.check(Rule::kV212);
  ResidentTotals totals;
  std::vector<std::uint32_t> drawable;
  for (std::uint32_t i = 0; i < asset.instances().size(); ++i) {
    if (is_drawable(asset, asset.instances()[i])) drawable.push_back(i);
  }
  if (drawable.empty()) return totals;
  std::vector<CameraOutcome> outcomes(chunk_count(count, kResidenciesPerCamera));
  parallel_for_each_chunk(count, kResidenciesPerCamera, [&](std::size_t camera, std::size_t begin, std::size_t end) {
    SplitMix64 random(mix64(seed) + camera);
    const ResidentSelection selection = make_selection(run::tables_of(asset));
    CameraCheck(asset, judges, selection, drawable, random, outcomes[camera])
        .run(static_cast<std::uint32_t>(camera), static_cast<std::uint32_t>(end - begin));
  });
  for (std::size_t camera = 0; camera < outcomes.size(); ++camera) {
    const CameraOutcome& outcome = outcomes[camera];
    const std::string where = place("camera", camera) + " (" + outcome.kind + ", seed " + std::to_string(seed) + "), ";
    for (const Fault& fault : outcome.faults) log.add(Rule::kV212, where + fault.where, fault.what);
    for (std::uint64_t i = 0; i < outcome.more_faults; ++i) log.add(Rule::kV212, where, "as before");
    totals.cameras += outcome.totals.cameras;
    totals.residencies += outcome.totals.residencies;
    totals.others += outcome.totals.others;
    totals.naive_open += outcome.totals.naive_open;
    totals.borders += outcome.totals.borders;
    totals.requests += outcome.totals.requests;
    for (const SampledCut& sample : outcome.totals.samples) {
      if (totals.samples.size() < kSampledCuts) totals.samples.push_back(sample);
    }
  }
  return totals;
}

}  // namespace meshlode::judge
