// SPDX-License-Identifier: GPL-3.0-or-later
// The `certified` tier from end to end: a scene is built, and no cut that the rule can choose may be farther from the
// source than it stores, tolerance zero. Judged are all uniform cuts (one for each error in the asset) and cuts that
// mix levels, both ways, by the judge's own metric; then `verify` with its rule V206 over as many cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <ostream>
#include <set>
#include <utility>
#include <vector>

#include "builder/builder.h"
#include "builder/odd_shapes.h"
#include "judge/metrics/metrics.h"
#include "judge/verify/promises.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

constexpr std::uint64_t kSamples = 40000;  // and all vertices, which is where most maxima are
constexpr int kMixedCuts = 12;
constexpr std::uint32_t kClusterCap = 32;  // small clusters: small scenes have many groups then, and many cuts

struct CertifiedCase {
  friend void PrintTo(const CertifiedCase& c, std::ostream* out) { *out << c.name; }
  const char* name;
  std::function<scene::Primitive()> make;
};

/// Two sheets 1e-4 apart, closed, with noise ten times that: they run through each other.
scene::Primitive make_noisy_sheets(std::uint32_t n) {
  scene::Primitive shape = lab::make_blade(n, 1e-4);
  test::Random random(17);
  for (Vec3d& p : shape.positions) p += 1e-3 * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit());
  return shape;
}

/// An open height field with holes of all sizes in it.
scene::Primitive make_torn_terrain(std::uint32_t n) {
  scene::Primitive shape = lab::make_terrain(n, n);
  test::Random random(18);
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    const Vec3d& p = shape.positions[shape.indices[t]];
    const Vec3d from_hole = p - shape.positions[shape.positions.size() / 3];
    if (random.below(40) == 0 || glm::dot(from_hole, from_hole) < 0.02) continue;
    kept.insert(kept.end(), shape.indices.begin() + static_cast<std::ptrdiff_t>(t),
                shape.indices.begin() + static_cast<std::ptrdiff_t>(t + 3));
  }
  shape.indices = std::move(kept);
  return shape;
}

scene::Primitive moved(scene::Primitive shape, const Vec3d& by) {
  for (Vec3d& p : shape.positions) p += by;
  return shape;
}

const std::vector<CertifiedCase>& certified_cases() {
  static const std::vector<CertifiedCase> all{
      {"ClosedAndSmooth", [] { return lab::make_rock(20); }},
      {"OpenBordersAndHoles", [] { return make_torn_terrain(44); }},
      {"ThinSheetsThroughEachOther", [] { return make_noisy_sheets(26); }},
      {"BumpsOfAThousandthAMillionAway", [] { return lab::make_far_plane(28); }},
      {"SphereAHundredThousandAway",
       [] { return moved(lab::scaled(lab::make_sphere(10), 1e-3), Vec3d(1e5, -2e5, 3e5)); }},
      {"DegenerateTrianglesThatStickOut", [] { return test::make_ball_with_hairs(); }},
      {"TrianglesWithoutAreaInAClosedSurface", [] { return lab::make_zero_areas(12); }},
      {"Slivers", [] { return lab::make_slivers(800, 1e5); }},
      {"SheetsThatShareAnEdge", [] { return lab::make_three_sheets(16); }},
      {"LooseBoxes", [] { return lab::make_box_soup(120); }},
      {"SizeOfAMillionth", [] { return lab::scaled(lab::make_torus(36, 24), 1e-6); }},
      {"SizeOfABillion", [] { return lab::scaled(lab::make_torus(36, 24), 1e9); }},
  };
  return all;
}

class CertifiedScene : public testing::TestWithParam<CertifiedCase> {
 protected:
  void SetUp() override {
    scene_ = lab::as_scene(lab::as_mesh(GetParam().make()));
    asset_.push_back(build_scene(format::Promise::kPosition));
    auto decoded = run::decode_all(asset_[0]);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message();
    decoded_ = std::move(*decoded);
    source_ = surface_of_source(scene_.meshes[0]);
  }

  [[nodiscard]] run::Asset build_scene(format::Promise promise) const {
    builder::PipelineReport report;
    builder::PipelineOptions options;
    options.error_tier = format::ErrorTier::kCertified;
    options.max_cluster_triangles = kClusterCap;
    options.promise = promise;
    auto bytes = builder::build_lode(scene_, options, {}, report);
    EXPECT_TRUE(bytes.ok()) << bytes.error().message();
    auto asset = run::Asset::from_vector(std::move(*bytes));
    EXPECT_TRUE(asset.ok()) << asset.error().message();
    return std::move(*asset);
  }

  void expect_within(const std::vector<ClusterId>& cut, double stored, const char* what) {
    if (!judged_.insert(cut).second) return;
    const double truth = DeviationFrom(source_, {.samples = kSamples})
                             .measure(surface_of_clusters(asset_[0], decoded_, MeshId(0U), cut))
                             .max();
    EXPECT_LE(truth, stored) << what << " of " << cut.size() << " clusters";
    if (stored > 0.0) tightest_ = std::max(tightest_, truth / stored);
  }

  /// Errors at which the uniform cut changes: level 0, and each finite error of a group.
  [[nodiscard]] std::set<double> thresholds() const {
    std::set<double> out{0.0};
    for (const format::GroupRecord& group : asset_[0].groups()) {
      if (group.error < format::kInfiniteError) out.insert(group.error);
    }
    return out;
  }

  /// Some groups pass, and with each all that it was made from: fine here, coarse there, as a camera may choose.
  [[nodiscard]] std::pair<std::vector<ClusterId>, double> mixed_cut(test::Random& random) const {
    const auto groups = asset_[0].groups();
    const auto clusters = asset_[0].clusters();
    std::vector<bool> passes(groups.size(), false);
    for (std::uint32_t g = 0; g < groups.size(); ++g) {  // from coarse to fine
      const bool is_terminal = (groups[g].flags & format::kGroupTerminal) != 0;
      if (!is_terminal && random.below(groups[g].level == 0 ? 2 : 9) == 0) passes[g] = true;
      if (!passes[g]) continue;
      for (std::uint32_t c = groups[g].first_cluster; c < groups[g].first_cluster + groups[g].cluster_count; ++c) {
        if (clusters[c].own_group != format::kNone) passes[clusters[c].own_group] = true;
      }
    }
    std::pair<std::vector<ClusterId>, double> cut{{}, asset_[0].meshes()[0].level0_deviation};
    for (std::uint32_t c = 0; c < clusters.size(); ++c) {
      const std::uint32_t own = clusters[c].own_group;
      if ((own != format::kNone && !passes[own]) || passes[clusters[c].coarser_group]) continue;
      cut.first.emplace_back(c);
      if (own != format::kNone) cut.second = std::max(cut.second, double{groups[own].error});
    }
    return cut;
  }

  scene::Scene scene_;
  std::vector<run::Asset> asset_;  ///< one, made in SetUp
  std::vector<run::DecodedCluster> decoded_;
  Surface source_;
  std::set<std::vector<ClusterId>> judged_;
  double tightest_ = 0.0;
};

TEST_P(CertifiedScene, NoCutIsFartherFromTheSourceThanItStores) {
  const run::Asset& asset = asset_[0];
  for (const double threshold : thresholds()) {
    const run::UniformCut cut = run::select_uniform(asset, MeshId(0U), threshold);
    expect_within(cut.clusters, cut.stored_error, "uniform cut");
  }
  const std::size_t uniform = judged_.size();
  test::Random random(71);
  for (int n = 0; n < kMixedCuts; ++n) {
    const auto [clusters, stored] = mixed_cut(random);
    expect_within(clusters, stored, "mixed cut");
  }
  std::printf("%zu uniform cuts, %zu mixed ones: true/stored at most %.3f\n", uniform, judged_.size() - uniform,
              tightest_);
  EXPECT_GT(uniform, 1U) << "nothing was simplified, so nothing was judged";

  const auto cuts = static_cast<std::uint32_t>(4 * thresholds().size());
  const VerifyReport report = verify_asset(asset, scene_, {.deviation_cuts = cuts, .deviation_samples = kSamples});
  for (const Finding& f : report.findings) ADD_FAILURE() << f.id << ": " << f.where << ": " << f.detail;
  EXPECT_EQ(report.finding_count, 0U);
}

/// The same of the product space of positions and normals, which are the triangles' own where a shape has none.
TEST_P(CertifiedScene, NoCutIsFartherInWhatIsPaintedOnItThanItPromises) {
  const run::Asset asset = build_scene(format::Promise::kAppearance);
  ASSERT_EQ(asset.promises().size(), 1U);
  RuleLog log;
  const DeviationTotals totals =
      check_promise(asset, scene_, format::Promise::kAppearance, 4 * kMixedCuts, kSamples, log);
  for (const Finding& f : log.take_findings()) ADD_FAILURE() << f.id << ": " << f.where << ": " << f.detail;
  std::printf("%llu cuts: true/promised at most %.3f\n", static_cast<unsigned long long>(totals.cuts), totals.worst);
  EXPECT_GT(totals.cuts, 1U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CertifiedScene, testing::ValuesIn(certified_cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace meshlode::judge
