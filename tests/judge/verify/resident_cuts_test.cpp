// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts of resident pages: nothing is found in the real selection, and each way to be wrong is.
#include "judge/verify/resident_cuts.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "builder/builder.h"
#include "judge/validate/edit.h"
#include "judge/verify/resident_judge.h"
#include "judge/verify/verify.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {
namespace {

constexpr std::uint32_t kTried = 1000;

/// A closed and an open mesh in pages of 16 KiB, so that there are many; three instances.
const std::vector<std::uint8_t>& paged_bytes() {
  static const std::vector<std::uint8_t> bytes = [] {
    scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_rock(60)));
    scene.meshes.push_back(lab::as_mesh(lab::make_terrain(70, 70), "terrain"));
    scene.instances.push_back(scene.instances.front());
    scene.instances.back().mesh = MeshId(1U);
    scene.instances.push_back(scene.instances.front());
    builder::PipelineOptions options;
    options.page_kib = 16;
    builder::PipelineReport report;
    auto built = builder::build_lode(scene, options, {}, report);
    EXPECT_TRUE(built.ok()) << built.error().message();
    return std::move(*built);
  }();
  return bytes;
}

class ResidentCuts : public testing::Test {
 protected:
  ResidentCuts()
      : asset_(std::move(*run::Asset::from_vector(paged_bytes()))), clusters_(std::move(*run::decode_all(asset_))) {
    for (std::uint32_t m = 0; m < asset_.meshes().size(); ++m) {
      judges_.push_back(make_mesh_judge(asset_, MeshId(m), clusters_));
    }
  }

  using Make = std::function<ResidentSelection(const run::SelectTables&)>;
  /// How many findings there are, and in totals_ what was looked at.
  std::uint64_t found(const Make& make = make_resident_selection, std::uint32_t count = kTried) {
    RuleLog log;
    totals_ = check_resident_cuts(asset_, judges_, count, 11, log, make);
    const auto findings = log.take_findings();
    first_ = findings.empty() ? "" : findings[0].where + ": " + findings[0].detail;
    return log.count_of(Rule::kV212);
  }
  /// Every cut of the real selection, changed.
  template <class Change>
  std::uint64_t found_after(const Change& change) {
    return found([&](const run::SelectTables& tables) {
      return [select = make_resident_selection(tables), &change](const run::SelectTables& seen,
                                                                 const run::ResidentQuery& query) {
        ResidentCut cut = select(seen, query);
        change(cut, query);
        return cut;
      };
    });
  }
  /// The real selection with links that are made from other clusters.
  template <class Change>
  std::uint64_t found_with_links(const Change& change) {
    return found([&](const run::SelectTables& tables) {
      std::vector<format::ClusterRecord> clusters(tables.clusters.begin(), tables.clusters.end());
      change(clusters);
      run::SelectTables changed = tables;
      changed.clusters = clusters;
      return make_resident_selection(changed);  // keeps the links alone
    });
  }

  run::Asset asset_;
  std::vector<run::DecodedCluster> clusters_;
  std::vector<MeshJudge> judges_;
  ResidentTotals totals_;
  std::string first_;
};

TEST_F(ResidentCuts, TheRealSelectionPasses) {
  EXPECT_EQ(found(make_resident_selection, 1010), 0U) << first_;
  EXPECT_EQ(totals_.cameras, 21U);
  EXPECT_EQ(totals_.residencies, 1010U);
  EXPECT_EQ(totals_.others, 21U * 9U);
  EXPECT_EQ(totals_.borders, 21U);
  EXPECT_GT(totals_.requests, 1000U);
  EXPECT_GT(totals_.naive_open, 200U) << "residencies and cameras that nothing could be wrong for";
  EXPECT_EQ(totals_.samples.size(), kSampledCuts);
}

TEST_F(ResidentCuts, AreTheSameForAnyNumberOfThreads) {
  const auto figures = [&] {
    (void)found(make_resident_selection, 300);
    return std::tuple(totals_.naive_open, totals_.requests, totals_.borders);
  };
  const auto many = figures();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(figures(), many);
}

TEST_F(ResidentCuts, WithoutLinksTheCutIsOpen) {
  const std::uint64_t findings = found_with_links([](auto& clusters) {
    for (format::ClusterRecord& cluster : clusters) cluster.own_group = format::kNone;
  });
  EXPECT_GE(findings, totals_.naive_open) << "the rule that looks at a group's own page alone";
}

TEST_F(ResidentCuts, AForgottenParentIsFound) {
  // Of each group that was replaced by members of several groups one of these, the last.
  EXPECT_GT(found_with_links([](auto& clusters) {
              std::vector<std::uint32_t> last(clusters.size(), format::kNone), first(clusters.size(), format::kNone);
              for (const format::ClusterRecord& cluster : clusters) {
                if (cluster.own_group == format::kNone) continue;
                if (first[cluster.own_group] == format::kNone) first[cluster.own_group] = cluster.coarser_group;
                last[cluster.own_group] = cluster.coarser_group;
              }
              for (format::ClusterRecord& cluster : clusters) {
                const std::uint32_t own = cluster.own_group;
                if (own != format::kNone && last[own] != first[own] && cluster.coarser_group == last[own]) {
                  cluster.own_group = format::kNone;
                }
              }
            }),
            0U);
}

TEST_F(ResidentCuts, APageUsedAFrameEarlyIsFound) {
  EXPECT_GT(found([](const run::SelectTables& tables) {
              return [select = make_resident_selection(tables)](const run::SelectTables& seen,
                                                                const run::ResidentQuery& query) {
                const ResidentCut now = select(seen, query);
                if (now.requests.empty()) return now;
                std::vector<std::uint32_t> words(query.resident.begin(), query.resident.end());
                const std::uint32_t page = now.requests.front().page;
                words[page / 32] |= 1U << page % 32;
                run::ResidentQuery early = query;
                early.resident = words;
                ResidentCut cut = select(seen, early);
                cut.requests = now.requests;
                return cut;
              };
            }),
            kTried / 10);
}

/// Of each group the largest error of the groups that its members were made from: the own error for the coarser.
std::vector<format::GroupRecord> with_own_errors(const run::SelectTables& tables) {
  std::vector<format::GroupRecord> groups(tables.groups.begin(), tables.groups.end());
  for (format::GroupRecord& group : groups) {
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    group.error = 0.0F;
    for (const format::ClusterRecord& cluster : tables.clusters.subspan(group.first_cluster, group.cluster_count)) {
      if (cluster.own_group != format::kNone) {
        group.error = std::max(group.error, tables.groups[cluster.own_group].error);
      }
    }
  }
  return groups;
}

TEST_F(ResidentCuts, TheOwnErrorForTheCoarserIsFound) {
  const auto groups = with_own_errors(run::tables_of(asset_));
  std::vector<format::NodeRecord> nodes(asset_.nodes().begin(), asset_.nodes().end());
  for (format::NodeRecord& node : nodes) {
    if (node.child_count == 0) node.error = groups[node.first].error;
  }
  const auto found_with = [&](bool changes_nodes) {
    return found([&, changes_nodes](const run::SelectTables& tables) {
      return [&, changes_nodes, select = make_resident_selection(tables)](const run::SelectTables& seen,
                                                                          const run::ResidentQuery& query) {
        run::SelectTables changed = seen;
        changed.groups = groups;
        if (changes_nodes) changed.nodes = nodes;
        return select(changed, query);
      };
    });
  };
  EXPECT_GT(found_with(true), kTried / 10) << "in what is drawn";
  EXPECT_GT(found_with(false), kTried / 10) << "in what is requested alone";
}

TEST_F(ResidentCuts, APageLeftUnusedIsFound) {
  EXPECT_GT(found([](const run::SelectTables& tables) {
              return [select = make_resident_selection(tables)](const run::SelectTables& seen,
                                                                const run::ResidentQuery& query) {
                std::vector<std::uint32_t> words(query.resident.begin(), query.resident.end());
                words.back() &= 0x7FFFFFFFU >> (31 - (seen.groups.back().page % 32));  // the finest page of a mesh
                run::ResidentQuery fewer = query;
                fewer.resident = words;
                ResidentCut cut = select(seen, fewer);
                std::erase_if(cut.requests, [&](const run::PageRequest& request) {
                  return (query.resident[request.page / 32] >> request.page % 32 & 1U) != 0;
                });
                return cut;
              };
            }),
            0U);
}

TEST_F(ResidentCuts, WhatIsDrawnOrRequestedAmissIsFound) {
  using Query = run::ResidentQuery;
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              if (!cut.items.empty()) cut.items.pop_back();
            }),
            kTried)
      << "a cluster is missing";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              if (!cut.items.empty()) cut.items.push_back(cut.items.back());
            }),
            kTried)
      << "a cluster is drawn twice";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              if (!cut.requests.empty()) cut.requests.pop_back();
            }),
            kTried / 10)
      << "a page is not requested";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) { std::reverse(cut.requests.begin(), cut.requests.end()); }),
            kTried / 10)
      << "pages are requested out of order";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              for (run::PageRequest& request : cut.requests) request.priority *= 0.5F;
            }),
            kTried / 10)
      << "priorities are too small";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              for (run::PageRequest& request : cut.requests) request.priority *= 2.0F;
            }),
            kTried / 10)
      << "priorities are too large";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query&) {
              cut.requests.push_back({0xFFFFFFF0U, 1e-37F});
            }),
            kTried)
      << "a page is requested that does not exist";
  EXPECT_GT(found_after([](ResidentCut& cut, const Query& query) {
              if (query.frustum != nullptr && !cut.items.empty()) cut.items.erase(cut.items.begin());
            }),
            kTried / kResidenciesPerCamera)
      << "what is inside the picture is culled";
  EXPECT_GT(found([](const run::SelectTables& tables) {
              return [select = make_resident_selection(tables)](const run::SelectTables& seen, const Query& query) {
                Query whole = query;
                whole.frustum = nullptr;
                return select(seen, whole);
              };
            }),
            0U)
      << "nothing is culled";
}

TEST_F(ResidentCuts, ErrorsThatAreTooSmallForWhatIsShownAreFound) {
  ASSERT_EQ(found(), 0U) << first_;
  RuleLog none;
  const ShownErrors real = check_shown_errors(asset_, clusters_, totals_.samples, none);
  EXPECT_EQ(real.cuts, kSampledCuts);
  EXPECT_EQ(none.finding_count(), 0U);
  EXPECT_GT(real.largest_ratio, 0.5);
  test::AssetEdit edit(paged_bytes());
  for (std::uint32_t g = 0; g < asset_.groups().size(); ++g) {
    edit.group(g, [](format::GroupRecord& group) {
      if (group.error < format::kInfiniteError) group.error *= 0.25F;
    });
  }
  edit.seal();
  const Result<run::Asset> smaller = run::Asset::from_vector(edit.bytes());
  ASSERT_TRUE(smaller.ok()) << smaller.error().message();
  RuleLog log;
  (void)check_shown_errors(*smaller, clusters_, totals_.samples, log);
  EXPECT_GT(log.count_of(Rule::kV212), 0U);
}

TEST_F(ResidentCuts, AreVerifiedWithoutASource) {
  const VerifyReport report = verify_streaming(asset_, {.residencies = 100});
  EXPECT_EQ(report.finding_count, 0U);
  ASSERT_TRUE(report.streaming);
  EXPECT_EQ(report.streaming->residencies.residencies, 100U);
  EXPECT_TRUE(std::any_of(report.checks.begin(), report.checks.end(), [](const VerifyReport::Check& check) {
    return check.skipped && check.what.find("no source") != std::string::npos;
  }));
}

}  // namespace
}  // namespace meshlode::judge
