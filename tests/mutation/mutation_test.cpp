// SPDX-License-Identifier: GPL-3.0-or-later
// Can the judge fail? One field of a sound asset is changed at random, every checksum and hash is made true again, and
// validate and verify must find it. Mutants that are as valid as the original are counted apart, by kind, with the
// reason. The few that run always are of a hand-made asset of the qem tier; the long series is of built assets of the
// measured tier, whose cuts verify measures too, and prints the table of docs/log/mutations.md as it stands there.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "judge/validate/judged_sample.h"
#include "judge/validate/validate.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "mutation/mutators.h"
#include "run/read/asset.h"
#include "support/sample_asset.h"

namespace meshlode {
namespace {

#ifndef MESHLODE_MUTANTS_PER_KIND
#define MESHLODE_MUTANTS_PER_KIND 4
#endif

constexpr std::uint64_t kSeed = 20260101;
/// Each way of each measured cut, beside all vertices: the scenes have a few thousand triangles.
constexpr std::uint64_t kDeviationSamples = 20000;

struct Original {
  const char* name;
  std::vector<std::uint8_t> bytes;
  scene::Scene scene;
};

/// The rule that finds it, the structural ones first; empty where nothing is found.
std::string find_killer(const std::vector<std::uint8_t>& bytes, const scene::Scene& scene) {
  const judge::ValidationReport structure = judge::validate_asset(bytes);
  if (structure.finding_count > 0) return structure.findings.front().id;
  const Result<run::Asset> asset = run::Asset::from_bytes(bytes);
  if (!asset) return "L099";
  const judge::VerifyReport report =
      judge::verify_asset(*asset, scene, {.uniform_cuts = 4, .cameras = 2, .deviation_samples = kDeviationSamples});
  return report.finding_count > 0 ? report.findings.front().id : std::string();
}

struct Tally {
  std::uint64_t mutants = 0, killed = 0;
  std::map<std::string, std::uint64_t> by_rule;
};

std::string name_killers(const Tally& tally) {
  std::vector<std::pair<std::uint64_t, std::string>> order;
  for (const auto& [rule, count] : tally.by_rule) order.emplace_back(count, rule);
  std::sort(order.rbegin(), order.rend());
  std::string text;
  for (const auto& [count, rule] : order) text += (text.empty() ? "" : " ") + rule + ":" + std::to_string(count);
  return text;
}

/// The first byte that differs behind the header and section table: what was changed, before checksums.
std::string describe_change(const test::AssetEdit& before, const test::AssetEdit& after) {
  for (const format::SectionId id :
       {format::SectionId::kMeta, format::SectionId::kScene, format::SectionId::kStrings, format::SectionId::kMeshes,
        format::SectionId::kMaterials, format::SectionId::kInstances, format::SectionId::kGroups,
        format::SectionId::kClusters, format::SectionId::kNodes, format::SectionId::kPageDeps,
        format::SectionId::kBlobs, format::SectionId::kPageData, format::SectionId::kBlobData}) {
    const format::SectionEntry section = before.section(id);
    for (std::uint64_t i = 0; i < section.bytes; ++i) {
      if (before.bytes()[section.offset + i] == after.bytes()[section.offset + i]) continue;
      const std::uint64_t stride = std::max<std::uint64_t>(section.record_bytes, 1);
      return "section " + std::string(reinterpret_cast<const char*>(&section.id), 4) + ", record " +
             std::to_string(i / stride) + ", byte " + std::to_string(i % stride);
    }
  }
  return "header or tables";
}

void run_kind(const test::MutantKind& kind, const Original& original, std::uint64_t seed, std::uint64_t count,
              Tally& tally) {
  SplitMix64 random(seed);
  std::uint64_t made = 0;
  for (std::uint64_t draw = 0; made < count && draw < 20 * count; ++draw) {
    test::AssetEdit edit(original.bytes);
    if (!kind.mutate(edit, random) || edit.bytes() == original.bytes) continue;
    edit.seal();
    ++made;
    ++tally.mutants;
    const std::string killer = find_killer(edit.bytes(), original.scene);
    if (!killer.empty()) {
      ++tally.killed;
      ++tally.by_rule[killer];
    } else if (kind.equivalent == nullptr) {
      ADD_FAILURE() << kind.name << ": mutant " << made << " of " << original.name << ", seed " << seed
                    << ", is not found: " << describe_change(test::AssetEdit(original.bytes), edit);
    }
  }
}

/// A built asset of several pages, so that there are dependencies.
const Original& several_pages();
/// One that promises appearance, of small clusters so that it has many groups.
const Original& promised();

void run_mutants(const std::vector<Original>& originals, std::uint64_t per_kind) {
  std::uint64_t must = 0;
  std::uint64_t must_killed = 0;
  std::uint64_t may = 0;
  std::uint64_t may_killed = 0;
  std::printf("%s", "| kind | mutants | found | by rule | those not found |\n| --- | ---: | ---: | --- | --- |\n");
  for (const test::MutantKind& kind : test::mutant_kinds()) {
    Tally tally;
    for (std::size_t o = 0; o < originals.size(); ++o) run_kind(kind, originals[o], kSeed + o, per_kind, tally);
    if (tally.mutants == 0) run_kind(kind, several_pages(), kSeed, per_kind, tally);
    if (tally.mutants == 0) run_kind(kind, promised(), kSeed, per_kind, tally);
    EXPECT_GT(tally.mutants, 0U) << kind.name;
    (kind.equivalent == nullptr ? must : may) += tally.mutants;
    (kind.equivalent == nullptr ? must_killed : may_killed) += tally.killed;
    const char* reason = kind.equivalent != nullptr && tally.killed < tally.mutants ? kind.equivalent : "";
    std::printf("| %s | %llu | %llu | %s | %s |\n", kind.name, static_cast<unsigned long long>(tally.mutants),
                static_cast<unsigned long long>(tally.killed), name_killers(tally).c_str(), reason);
  }
  std::printf(
      "\nof kinds that change the meaning: %llu mutants, %llu found; of kinds that may keep it: %llu mutants, %llu "
      "found\n",
      static_cast<unsigned long long>(must), static_cast<unsigned long long>(must_killed),
      static_cast<unsigned long long>(may), static_cast<unsigned long long>(may_killed));
  EXPECT_EQ(must_killed, must);
}

Original make_built(const char* name, scene::Scene scene, const builder::PipelineOptions& options = {}) {
  Original out{name, {}, std::move(scene)};
  builder::PipelineReport report;
  Result<std::vector<std::uint8_t>> bytes = builder::build_lode(out.scene, options, {}, report);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message();
  if (bytes) out.bytes = std::move(*bytes);
  EXPECT_EQ(find_killer(out.bytes, out.scene), "") << name;
  return out;
}

scene::Scene alone(scene::Primitive shape) {
  return lab::as_scene(lab::as_mesh(std::move(shape)));
}

const Original& several_pages() {
  static const Original rock = make_built("a rock of several pages", alone(lab::make_rock(48)));
  return rock;
}

const Original& promised() {
  static const Original ball = [] {
    builder::PipelineOptions options;
    options.max_cluster_triangles = 48;
    options.promise = format::Promise::kAppearance;
    return make_built("a ball that promises appearance", alone(lab::with_smooth_normals(lab::make_sphere(16))),
                      options);
  }();
  return ball;
}

#ifndef MESHLODE_LONG_SERIES
TEST(Mutation, AFewMutantsOfEachKindAreFound) {
  run_mutants({{"the hand-made sample", test::judged_sample_bytes(), test::sample_scene()}}, MESHLODE_MUTANTS_PER_KIND);
}

TEST(Mutation, APromiseThatIsNotKeptByTheTablesIsFoundByItsRule) {
  using Mesh = format::PromiseMeshRecord;
  using Group = format::PromiseGroupRecord;
  const std::vector<std::uint8_t> promised = test::judged_sample_bytes(format::Codec::kNone, true);
  SplitMix64 random(31);
  const auto is_found = [&](const test::AssetEdit& edit, const char* rule) {
    const judge::ValidationReport report = judge::validate_asset(edit.bytes());
    return std::any_of(report.findings.begin(), report.findings.end(),
                       [&](const judge::Finding& finding) { return finding.id == rule; });
  };
  for (int i = 0; i < 60; ++i) {
    test::AssetEdit edit(promised);
    const auto groups = edit.groups();
    const std::uint64_t g = random.below(groups.size());
    const bool is_terminal = (groups[g].flags & format::kGroupTerminal) != 0;
    edit.change_at<Group>(edit.offset_of<Group>(format::SectionId::kPromiseErrors, g), [&](Group& e) {
      float& error = random.below(2) == 0 ? e.texel_error : e.appearance_error;
      // In the sample all errors of a group are one: whichever falls is below the one before it.
      error = is_terminal            ? static_cast<float>(random.between(0.0, 9.0))
              : random.below(3) == 0 ? format::kInfiniteError
                                     : error * static_cast<float>(random.between(0.1, 0.99)) - 1e-30F;
    });
    edit.seal();
    EXPECT_TRUE(is_found(edit, "L313")) << i;
  }
  for (int i = 0; i < 60; ++i) {
    test::AssetEdit edit(promised);
    edit.change_at<Mesh>(edit.offset_of<Mesh>(format::SectionId::kPromises, random.below(edit.meshes().size())),
                         [&](Mesh& m) {
                           switch (random.below(5)) {
                             case 0: m.promises ^= 1U << random.below(32); break;
                             case 1: m.normal_object = -1.0F - m.normal_object; break;
                             case 2: m.uv_object[random.below(4)][random.below(2)] += -9.0F; break;
                             case 3: m.level0_texels = m.level0_appearance + 1.0F; break;
                             default: m.level0_appearance = -1.0F; break;
                           }
                         });
    edit.seal();
    EXPECT_TRUE(is_found(edit, "L117")) << i;
  }
}

TEST(Mutation, ADependencyLeftOutIsFoundByItsRule) {
  test::AssetEdit edit(several_pages().bytes);
  const auto pages = edit.pages();
  ASSERT_GT(pages.size(), 1U);
  const auto needy =
      std::find_if(pages.begin(), pages.end(), [](const format::PageRecord& p) { return p.dependency_count > 0; });
  ASSERT_NE(needy, pages.end());
  edit.put<std::uint32_t>(edit.section(format::SectionId::kPageDeps).offset + 4 * needy->first_dependency,
                          static_cast<std::uint32_t>(needy - pages.begin()));
  edit.seal();
  const judge::ValidationReport report = judge::validate_asset(edit.bytes());
  EXPECT_TRUE(std::any_of(report.findings.begin(), report.findings.end(),
                          [](const judge::Finding& f) { return f.id == "L213"; }));
}
#else
/// Small clusters, so that few triangles make a DAG of many groups. The sample's scene has what one mesh has not:
/// several materials, two UV sets, colours, mirrored and singular instances, an empty mesh, blobs.
TEST(Mutation, ThousandsOfMutantsOfTheMeasuredTierAreFound) {
  builder::PipelineOptions options, smallest;
  options.max_cluster_triangles = 48;
  smallest.max_cluster_triangles = 16;
  run_mutants({make_built("the sample's scene", test::sample_scene(), smallest),
               make_built("a rock", alone(lab::make_rock(16)), options),
               make_built("a terrain", alone(lab::make_terrain(48, 48)), options)},
              MESHLODE_MUTANTS_PER_KIND);
}
#endif

}  // namespace
}  // namespace meshlode
