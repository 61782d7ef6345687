// SPDX-License-Identifier: GPL-3.0-or-later
// The encoder's records say what the stages before said, number by number, and its limits are where the format has
// them: the last value that fits is taken and the first that does not is refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/encode/encode.h"
#include "builder/encode/quantize_normal.h"
#include "builder/encode/uv_grid.h"
#include "run/decode/decode.h"
#include "support/random.h"
#include "support/sample_asset.h"
#include "support/sample_mesh.h"

namespace meshlode::builder {
namespace {

using test::SampleMesh;

Result<EncodedMesh> encoded(const SampleMesh& sample, const EncodeOptions& options = {}) {
  return encode_mesh(sample.mesh, sample.dag, sample.hierarchy, options);
}

struct Limit {
  const char* name;
  void (*fits)(SampleMesh&, EncodeOptions&);
  void (*breaks)(SampleMesh&, EncodeOptions&);
  ErrorCode code;
  const char* detail;
};

const double kNoNumber = std::nan("");

const Limit kLimits[] = {
    {"strip trials", [](auto&, auto& o) { o.strip_trials = 1; }, [](auto&, auto& o) { o.strip_trials = 0; },
     ErrorCode::kUsage, "trials"},
    {"mixed strip trials", [](auto&, auto& o) { o.mixed_strip_trials = 1; },
     [](auto&, auto& o) { o.mixed_strip_trials = 0; }, ErrorCode::kUsage, "trials"},
    {"normal error", [](auto&, auto& o) { o.normal_error = 180.0; }, [](auto&, auto& o) { o.normal_error = -1e-9; },
     ErrorCode::kUsage, "normal error"},
    {"normal error, no number", [](auto&, auto& o) { o.normal_error = 1.0; },
     [](auto&, auto& o) { o.normal_error = kNoNumber; }, ErrorCode::kUsage, "normal error"},
    {"normal scale", [](auto&, auto& o) { o.normal_error = 81.028468454139 / format::kMaxNormalScale * (1.0 + 1e-12); },
     [](auto&, auto& o) { o.normal_error = 81.028468454139 / format::kMaxNormalScale * (1.0 - 1e-9); },
     ErrorCode::kUnsupported, "0.01"},
    {"UV error", [](auto&, auto& o) { o.uv_error.fill(0.0); }, [](auto&, auto& o) { o.uv_error.back() = -1e-9; },
     ErrorCode::kUsage, "UV"},
    {"UV error, no number", [](auto&, auto& o) { o.uv_error.fill(1e-3); },
     [](auto&, auto& o) { o.uv_error.front() = kNoNumber; }, ErrorCode::kUsage, "UV"},
    {"least step", [](auto& s, auto&) { s.mesh.grid.log2 = kMinGridLog2; },
     [](auto& s, auto&) { s.mesh.grid.log2 = kMinGridLog2 - 1; }, ErrorCode::kUnsupported, "step"},
    {"largest step", [](auto& s, auto&) { s.mesh.grid.log2 = kMaxGridLog2; },
     [](auto& s, auto&) { s.mesh.grid.log2 = kMaxGridLog2 + 1; }, ErrorCode::kUnsupported, "step"},
    {"least mantissa", [](auto& s, auto&) { s.mesh.grid.mantissa = 1; },
     [](auto& s, auto&) { s.mesh.grid.mantissa = 0; }, ErrorCode::kUnsupported, "step"},
    {"largest mantissa", [](auto& s, auto&) { s.mesh.grid.mantissa = (1U << 24U) - 1; },
     [](auto& s, auto&) { s.mesh.grid.mantissa = 1U << 24U; }, ErrorCode::kUnsupported, "step"},
    {"attributes", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.vertex_attributes.push_back(0.0F); },
     ErrorCode::kBuildFailed, "attributes"},
    {"materials", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.triangle_material.push_back(0); },
     ErrorCode::kBuildFailed, "materials"},
    {"group spheres", [](auto&, auto&) {}, [](auto& s, auto&) { s.hierarchy.group_spheres.pop_back(); },
     ErrorCode::kBuildFailed, "hierarchy"},
    {"group errors", [](auto&, auto&) {}, [](auto& s, auto&) { s.hierarchy.group_errors.push_back(0.0F); },
     ErrorCode::kBuildFailed, "hierarchy"},
    {"cluster spheres", [](auto&, auto&) {}, [](auto& s, auto&) { s.hierarchy.cluster_spheres.push_back({}); },
     ErrorCode::kBuildFailed, "hierarchy"},
    {"cluster cones", [](auto&, auto&) {}, [](auto& s, auto&) { s.hierarchy.cluster_cones.pop_back(); },
     ErrorCode::kBuildFailed, "hierarchy"},
    {"least sphere unit",
     [](auto& s, auto&) {
       s.hierarchy.sphere_log2 = format::kMinSphereLog2;
       for (auto& sphere : s.hierarchy.cluster_spheres) sphere = {};
     },
     [](auto& s, auto&) { s.hierarchy.sphere_log2 = format::kMinSphereLog2 - 1; }, ErrorCode::kBuildFailed, "range"},
    {"largest sphere unit",
     [](auto& s, auto&) {
       s.hierarchy.sphere_log2 = format::kMaxSphereLog2;
       for (auto& sphere : s.hierarchy.cluster_spheres) sphere = {};
     },
     [](auto& s, auto&) { s.hierarchy.sphere_log2 = format::kMaxSphereLog2 + 1; }, ErrorCode::kBuildFailed, "range"},
    {"group clusters, none", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.groups.back().cluster_count = 0; },
     ErrorCode::kBuildFailed, "partition"},
    {"first cluster", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.groups.back().first_cluster += 1; },
     ErrorCode::kBuildFailed, "partition"},
    {"first of all", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.groups.front().first_cluster = 1; },
     ErrorCode::kBuildFailed, "partition"},
    {"clusters beyond the groups", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.groups.back().cluster_count += 1; },
     ErrorCode::kBuildFailed, "partition"},
    {"level", [](auto& s, auto&) { s.dag.groups.back().level = 65534; },
     [](auto& s, auto&) { s.dag.groups.back().level = 65535; }, ErrorCode::kBuildFailed, "levels"},
    {"vertices", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.clusters.back().first_vertex += 1; },
     ErrorCode::kBuildFailed, "arrays"},
    {"triangles", [](auto&, auto&) {}, [](auto& s, auto&) { s.dag.clusters.back().first_triangle += 1; },
     ErrorCode::kBuildFailed, "arrays"},
    {"coarser group", [](auto& s, auto&) { s.dag.clusters[0].coarser_group = GroupId(s.dag.groups.size() - 1); },
     [](auto& s, auto&) { s.dag.clusters[0].coarser_group = GroupId(s.dag.groups.size()); }, ErrorCode::kBuildFailed,
     "lacks"},
    {"own group", [](auto& s, auto&) { s.dag.clusters[0].own_group = GroupId(s.dag.groups.size() - 1); },
     [](auto& s, auto&) { s.dag.clusters[0].own_group = GroupId(s.dag.groups.size()); }, ErrorCode::kBuildFailed,
     "lacks"},
};

TEST(Records, EveryLimitIsTheLastThatFits) {
  for (const Limit& limit : kLimits) {
    SampleMesh sample = test::sample_patch();
    EncodeOptions options;
    limit.fits(sample, options);
    const auto mesh = encoded(sample, options);
    EXPECT_TRUE(mesh.ok()) << limit.name << ": " << (mesh.ok() ? "" : mesh.error().message());
    sample = test::sample_patch();
    options = {};
    limit.breaks(sample, options);
    const auto refused = encoded(sample, options);
    ASSERT_FALSE(refused.ok()) << limit.name;
    EXPECT_EQ(refused.error().code, limit.code) << limit.name;
    EXPECT_NE(refused.error().detail.find(limit.detail), std::string::npos)
        << limit.name << ": " << refused.error().detail;
  }
}

TEST(Records, WithoutNormalsAnyErrorOfTheirsWillDo) {
  EncodeOptions options;
  options.normal_error = 1e-9;
  const auto mesh = encoded(test::sample_tetrahedron(), options);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->record.normal_scale, 0U);
  EXPECT_EQ(normal_scale_of(options), static_cast<std::int32_t>(format::kMaxNormalScale));
}

// In whole units of 16 bits: each number of a sphere on its own, on either side of zero.
TEST(Records, SpheresAreWholeUnitsOfSixteenBits) {
  const SampleMesh patch = test::sample_patch();
  const auto unit = static_cast<float>(std::ldexp(1.0, patch.hierarchy.sphere_log2));
  const auto with = [&](int number, float units) {
    SampleMesh sample = patch;
    Hierarchy::Sphere& sphere = sample.hierarchy.cluster_spheres.back();
    (number < 3 ? sphere.center[number] : sphere.radius) = units * unit;
    return encoded(sample);
  };
  for (int number = 0; number < 4; ++number) {
    const float most = number < 3 ? 32767.0F : 65535.0F;
    for (const float units : {most, number < 3 ? -most : 1.0F, 0.0F, 7.0F}) {
      const auto mesh = with(number, units);
      ASSERT_TRUE(mesh.ok()) << number << ", " << units;
      const format::ClusterRecord& record = mesh->clusters.back();
      EXPECT_EQ(number < 3 ? record.center[number] : record.radius, units);
    }
    for (const float units : {most + 1.0F, 0.5F, 1.5F, number < 3 ? -most - 1.0F : 2.25F}) {
      const auto mesh = with(number, units);
      ASSERT_FALSE(mesh.ok()) << number << ", " << units;
      EXPECT_EQ(mesh.error().code, ErrorCode::kBuildFailed);
    }
  }
}

TEST(Records, OfTheMeshSayWhatItIs) {
  SampleMesh sample = test::sample_patch();
  sample.mesh.origin = {1.5, -2.25, 1e9};
  sample.mesh.diagonal = 0.1;
  sample.mesh.grid.mantissa = 3;
  sample.mesh.source_triangles = 1001;
  sample.mesh.source_vertices = 1002;
  sample.mesh.dropped_degenerate = 1003;
  sample.mesh.dropped_duplicate = 1004;
  sample.mesh.dropped_repaired = 1005;
  sample.mesh.grid_collapsed = 1006;
  const auto mesh = encoded(sample);
  ASSERT_TRUE(mesh.ok());
  const format::MeshRecord& record = mesh->record;
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(record.origin[axis], sample.mesh.origin[axis]);
  EXPECT_EQ(record.diagonal, 0.1);
  EXPECT_EQ(record.grid.log2, sample.mesh.grid.log2);
  EXPECT_EQ(record.grid.mantissa, 3U);
  EXPECT_EQ(record.source_triangles, 1001U);
  EXPECT_EQ(record.source_vertices, 1002U);
  EXPECT_EQ(record.dropped_degenerate, 1003U);
  EXPECT_EQ(record.dropped_duplicate, 1004U);
  EXPECT_EQ(record.dropped_repaired, 1005U);
  EXPECT_EQ(record.grid_collapsed, 1006U);
  EXPECT_EQ(record.level_count, sample.dag.level_count);
  EXPECT_EQ(record.group_count, sample.dag.groups.size());
  EXPECT_EQ(record.cluster_count, sample.dag.clusters.size());
  EXPECT_EQ(record.node_count, sample.hierarchy.nodes.size());
  EXPECT_EQ(record.sphere_log2, sample.hierarchy.sphere_log2);
  EXPECT_EQ(record.normal_mode, format::NormalMode::kStored);
  EXPECT_EQ(record.normal_scale, octahedral_scale_for(0.1));
  EXPECT_EQ(record.has_color, 0U);
  EXPECT_EQ(record.uv_set_count, 1U);
  EXPECT_EQ(record.material, format::kNone) << "it has two";
  const auto sphere = encoded(test::sample_sphere()), tetrahedron = encoded(test::sample_tetrahedron());
  ASSERT_TRUE(sphere.ok() && tetrahedron.ok());
  EXPECT_EQ(sphere->record.has_color, 1U);
  EXPECT_EQ(sphere->record.material, test::sample_sphere().dag.triangle_material[0]);
  EXPECT_EQ(tetrahedron->record.normal_mode, format::NormalMode::kFlat);
  SampleMesh plain = test::sample_tetrahedron();
  plain.mesh.layout.flat_normal = false;
  EXPECT_EQ(encoded(plain)->record.normal_mode, format::NormalMode::kNone);
}

// What bounds is rounded up and what is nearest to the nearest, infinity as the format writes it, whatever the sign.
TEST(Records, OfGroupsSayTheirErrorsAsFloats) {
  test::Random random(161);
  const double infinity = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 200; ++round) {
    SampleMesh sample = test::sample_patch();
    for (DagGroup& group : sample.dag.groups) {
      group.quadric_error = random.log_between(1e-30, 1e30);
      group.deviation = random.log_between(1e-30, 1e30);
      group.normal_deviation = random.log_between(1e-3, 180.0);
      group.uv_deviation = random.log_between(1e-9, 1.0);
    }
    DagGroup& odd = sample.dag.groups[round % 2 == 0 ? 1 : 2];
    ASSERT_FALSE(odd.is_terminal);
    odd.is_aggregate = true;
    odd.quadric_error = odd.deviation = odd.normal_deviation = odd.uv_deviation =
        std::array{infinity, kNoNumber, 1e300, -1.0, 0.0}[static_cast<std::size_t>(round) % 5];
    const auto mesh = encoded(sample);
    ASSERT_TRUE(mesh.ok()) << mesh.error().message();
    for (std::size_t g = 0; g < mesh->groups.size(); ++g) {
      const DagGroup& group = sample.dag.groups[g];
      const format::GroupRecord& record = mesh->groups[g];
      const auto expect_above = [&](float stored, double value) {
        if (std::isnan(value) || value >= double{format::kInfiniteError}) {
          EXPECT_EQ(stored, format::kInfiniteError);
        } else if (value <= 0.0) {
          EXPECT_EQ(stored, 0.0F);
        } else {
          EXPECT_GE(double{stored}, value);
          EXPECT_LT(double{std::nextafter(stored, 0.0F)}, value) << "the least float that is not below";
        }
      };
      expect_above(record.deviation, group.deviation);
      EXPECT_EQ(record.error, sample.hierarchy.group_errors[g] >= format::kInfiniteError || group.is_terminal
                                  ? format::kInfiniteError
                                  : sample.hierarchy.group_errors[g]);
      EXPECT_EQ(record.radius, sample.hierarchy.group_spheres[g].radius);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(record.center[axis], sample.hierarchy.group_spheres[g].center[axis]);
      EXPECT_EQ(record.level, group.level);
      EXPECT_EQ(record.first_cluster, group.first_cluster);
      EXPECT_EQ(record.cluster_count, group.cluster_count);
      EXPECT_EQ((record.flags & format::kGroupTerminal) != 0, group.is_terminal);
      EXPECT_EQ((record.flags & format::kGroupAggregate) != 0, group.is_aggregate);
      EXPECT_EQ(record.flags & format::kGroupStuck, 0);
      if (group.is_terminal) {
        EXPECT_EQ(record.quadric_error, format::kInfiniteError);
        EXPECT_EQ(record.normal_deviation, format::kInfiniteError);
        EXPECT_EQ(record.uv_deviation, format::kInfiniteError);
        continue;
      }
      expect_above(record.normal_deviation, group.normal_deviation);
      expect_above(record.uv_deviation, group.uv_deviation);
      if (group.quadric_error > 0.0 && group.quadric_error < 1e35) {
        EXPECT_EQ(record.quadric_error, static_cast<float>(group.quadric_error));
      } else {
        EXPECT_EQ(record.quadric_error, group.quadric_error <= 0.0 ? 0.0F : format::kInfiniteError);
      }
    }
  }
}

TEST(Records, AGroupThatIsStuckSaysSoWhereItIsTerminal) {
  for (const bool is_terminal : {true, false}) {
    for (const StuckReason reason : {StuckReason::kNotStuck, static_cast<StuckReason>(1)}) {
      SampleMesh sample = test::sample_patch();
      DagGroup& group = sample.dag.groups[is_terminal ? 0 : 1];
      ASSERT_EQ(group.is_terminal, is_terminal);
      group.stuck_reason = reason;
      const auto mesh = encoded(sample);
      ASSERT_TRUE(mesh.ok());
      EXPECT_EQ((mesh->groups[is_terminal ? 0 : 1].flags & format::kGroupStuck) != 0,
                is_terminal && reason != StuckReason::kNotStuck);
    }
  }
}

TEST(Records, OfClustersSayTheirGroupsAndCounts) {
  const SampleMesh sample = test::sample_patch();
  const auto mesh = encoded(sample);
  ASSERT_TRUE(mesh.ok());
  for (std::size_t c = 0; c < mesh->clusters.size(); ++c) {
    const DagCluster& cluster = sample.dag.clusters[c];
    const format::ClusterRecord& record = mesh->clusters[c];
    EXPECT_EQ(record.own_group, cluster.own_group.is_valid() ? cluster.own_group.value : format::kNone);
    EXPECT_EQ(record.coarser_group, cluster.coarser_group.value);
    EXPECT_EQ(record.vertices_less_1 + 1U, cluster.vertex_count);
    EXPECT_EQ(record.triangles_less_1 + 1U, cluster.triangle_count);
    EXPECT_EQ(record.level, cluster.level);
    EXPECT_EQ(record.cone_cutoff, sample.hierarchy.cluster_cones[c].cutoff);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(record.cone_axis[axis], sample.hierarchy.cluster_cones[c].axis[axis]);
  }
}

// A material of all triangles stands in the mesh's record alone, whichever place differs first.
TEST(Records, TheMaterialIsTheMeshsWhereItIsOne) {
  SampleMesh sample = test::sample_tetrahedron();
  const std::size_t count = sample.dag.triangle_material.size();
  std::fill(sample.dag.triangle_material.begin(), sample.dag.triangle_material.end(), 5U);
  EXPECT_EQ(encoded(sample)->record.material, 5U);
  for (std::size_t first = 1; first < count; ++first) {
    for (std::size_t t = 0; t < count; ++t) sample.dag.triangle_material[t] = t < first ? 5 : 6;
    EXPECT_EQ(encoded(sample)->record.material, format::kNone) << first;
  }
}

// Each set its own step, of u and v alike.
TEST(Records, EachSetHasTheStepOfItsOwnCoordinates) {
  for (std::size_t coordinate = 0; coordinate < 2; ++coordinate) {
    for (const float spread : {0.25F, 3e6F}) {
      SampleMesh sample = test::sample_patch();
      const std::size_t stride = sample.mesh.layout.stride(), at = sample.mesh.layout.uv_offset();
      UvRange range;
      for (std::size_t v = 0; v < sample.dag.vertex_position.size(); ++v) {
        float* uv = &sample.dag.vertex_attributes[v * stride + at];
        uv[0] = uv[1] = 0.0F;
        uv[coordinate] = spread * static_cast<float>(v % 7) / 6.0F;
        range.add(uv[0]);
        range.add(uv[1]);
      }
      const auto mesh = encoded(sample);
      ASSERT_TRUE(mesh.ok());
      EXPECT_EQ(mesh->record.uv_log2[0], choose_uv_log2(range, default_uv_error(range)))
          << coordinate << ", " << spread;
      EXPECT_EQ(mesh->record.uv_log2[1], 0);
    }
  }
}

// A budget that may not fall short is refused where half the step that the coordinates leave is more, and not before.
TEST(Records, ABudgetIsKeptToHalfAStep) {
  SampleMesh sample = test::sample_patch();
  const std::size_t stride = sample.mesh.layout.stride(), at = sample.mesh.layout.uv_offset();
  for (std::size_t v = 0; v < sample.dag.vertex_position.size(); ++v)
    sample.dag.vertex_attributes[v * stride + at] = 3e6F;  // in 24 bits: steps of a quarter
  EncodeOptions options;
  options.uv_error_may_fall_short = false;
  options.uv_error[0] = 0.125;
  EXPECT_TRUE(encoded(sample, options).ok());
  options.uv_error[0] = std::nextafter(0.125, 0.0);
  const auto refused = encoded(sample, options);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().detail, "a UV error of 0.125 needs more than 24 bits for the coordinates of TEXCOORD_0");
}

// √2 · 180 / π over the error, rounded up, as long as that is a number of bits at all.
TEST(Records, TheScaleOfNormalsIsTheLeastThatKeepsTheError) {
  for (double degrees = 1e-12; degrees < 1e4; degrees *= 1.7) {
    const long double exact = 81.02846845413886931L / degrees;
    const auto scale = static_cast<long double>(octahedral_scale_for(degrees));
    EXPECT_GE(scale * (1.0L + 1e-15L), exact) << degrees;
    EXPECT_LT(scale - 1.0L, exact * (1.0L + 1e-13L)) << degrees;
  }
  EXPECT_EQ(octahedral_scale_for(1e6), 1U);
  EXPECT_EQ(octahedral_scale_for(1e-300), std::uint64_t{1} << 60U);
  EXPECT_GT(octahedral_scale_for(1e-16), std::uint64_t{800000000000000000U});
}

TEST(Records, ATinyBudgetIsABudget) {
  SampleMesh sample = test::sample_patch();
  EncodeOptions options;
  options.uv_error_may_fall_short = false;
  options.uv_error[0] = 1e-12;
  EXPECT_FALSE(encoded(sample, options).ok()) << "coordinates of up to 1 leave it no bits";
}

// A group of 65,535 clusters is one of a page's limits, one of 65,536 of a number's.
TEST(Records, AGroupHasSixteenBitsOfClusters) {
  for (const std::uint32_t count : {65535U, 65536U}) {
    SampleMesh sample = test::sample_tetrahedron();
    sample.dag.clusters.resize(count, sample.dag.clusters[0]);
    sample.dag.groups[0].cluster_count = count;
    sample.hierarchy.cluster_spheres.resize(count, sample.hierarchy.cluster_spheres[0]);
    sample.hierarchy.cluster_cones.resize(count, sample.hierarchy.cluster_cones[0]);
    const auto mesh = encoded(sample);
    ASSERT_FALSE(mesh.ok());
    EXPECT_EQ(mesh.error().code, ErrorCode::kUnsupported);
    EXPECT_EQ(mesh.error().detail.find("more than 65,535 clusters") != std::string::npos, count > 65535) << count;
  }
}

TEST(UvGridSigns, NegativeCoordinatesAndTinyChartsCount) {
  const auto range = [](float a, float b) {
    UvRange out;
    out.add(a);
    out.add(b);
    return out;
  };
  for (const float size : {1.0F, 3e6F, 1e30F}) {
    EXPECT_EQ(choose_uv_log2(range(-size, 0.0F), 1e-5), choose_uv_log2(range(0.0F, size), 1e-5)) << size;
    EXPECT_EQ(choose_uv_log2(range(-size, size), 1e-5), choose_uv_log2(range(0.0F, size), 1e-5)) << size;
  }
  // The largest coordinate that a step holds has that step, and the next float the next.
  const auto most = static_cast<float>(kMaxUvInteger);
  EXPECT_EQ(choose_uv_log2(range(0.0F, most), 0.25), 0);
  EXPECT_EQ(choose_uv_log2(range(0.0F, std::nextafter(most, 2.0F * most)), 0.25), 1);
  for (const int log2 : {-1, -20, -40, -60}) {
    EXPECT_EQ(default_uv_error(range(0.0F, std::ldexp(1.0F, log2))), std::ldexp(1.0, log2 - 14)) << log2;
  }
}

// Each cluster of a page is found where its head says it is, with the vertices that it had.
TEST(Records, EveryClusterOfAPageComesBack) {
  for (const SampleMesh& sample : {test::sample_patch(), test::sample_sphere()}) {
    const auto asset = run::Asset::from_vector(test::asset_bytes_of(sample));
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    const auto clusters = run::decode_all(*asset);
    ASSERT_TRUE(clusters.ok()) << clusters.error().message();
    ASSERT_EQ(clusters->size(), sample.dag.clusters.size());
    for (std::size_t c = 0; c < clusters->size(); ++c) {
      const DagCluster& cluster = sample.dag.clusters[c];
      std::multiset<std::array<int, 3>> expected, stored;
      for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
        const Vec3i& p = sample.dag.vertex_position[cluster.first_vertex + v];
        const Vec3i q = (*clusters)[c].position(v);
        expected.insert({p.x, p.y, p.z});
        stored.insert({q.x, q.y, q.z});
      }
      EXPECT_EQ(stored, expected) << c;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
