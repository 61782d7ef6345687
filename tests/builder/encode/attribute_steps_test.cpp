// SPDX-License-Identifier: GPL-3.0-or-later
// Snapped attributes are what a reader gets: they are stored as the ones that they came from, and stay when they are
// snapped again.
#include "builder/encode/attribute_steps.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/dag/build_dag.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

TEST(AttributeSteps, SnappedAttributesAreStoredAsTheOnesThatTheyCameFrom) {
  scene::Primitive shape = lab::make_rock(12);
  ASSERT_FALSE(shape.uvs[0].empty());
  // All but the unit square: snapped they are it, and the usual step would be another.
  for (Vec2f& uv : shape.uvs[0]) uv = Vec2f(1e-6F) + uv * (1.0F - 2e-6F);
  for (const Vec3d& p : shape.positions) shape.colors.push_back(Vec4f(Vec3f(p), 0.3F));
  const scene::SourceMesh source = lab::as_mesh(shape);
  const MeshPlan plan = plan_mesh(source, {}, {AttributeChoice::kAll}, "m");
  const PreparedMesh mesh = *prepare_mesh(source, plan.layout, {});
  ASSERT_TRUE(mesh.layout.has_normal && mesh.layout.has_color && mesh.layout.uv_set_count > 0);
  const LodDag dag = *build_dag(mesh, {});
  const Hierarchy hierarchy = build_hierarchy(dag, mesh);
  for (const double normal_error : {0.01, 0.1, 30.0}) {
    const EncodeOptions options{.normal_error = normal_error};
    LodDag once = dag;
    snap_attributes(mesh.layout, options, once);
    EXPECT_NE(once.vertex_attributes, dag.vertex_attributes);
    LodDag twice = once;
    twice.steps.reset();
    snap_attributes(mesh.layout, {.normal_error = normal_error, .uv_error = {0x1p-15, 0x1p-15}}, twice);
    const auto plain = encode_mesh(mesh, dag, hierarchy, options),
               snapped = encode_mesh(mesh, once, hierarchy, options);
    ASSERT_TRUE(plain.ok() && snapped.ok());
    EXPECT_EQ(plain->record.uv_log2[0], snapped->record.uv_log2[0]);
    ASSERT_EQ(plain->pages.size(), snapped->pages.size());
    for (std::size_t p = 0; p < plain->pages.size(); ++p) EXPECT_EQ(plain->pages[p].bytes, snapped->pages[p].bytes);
    if (twice.steps->uv_log2 == once.steps->uv_log2) {
      EXPECT_EQ(once.vertex_attributes, twice.vertex_attributes);
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
