// SPDX-License-Identifier: GPL-3.0-or-later
// DAGs of samples, before they are measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "builder/dag/build_dag.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder::test {

struct Built {
  PreparedMesh mesh;
  LodDag dag;
};

inline Built build(const scene::SourceMesh& source) {
  const MeshPlan plan = plan_mesh(source, {}, {AttributeChoice::kAll}, "m");
  Built built{*prepare_mesh(source, plan.layout, {}), {}};
  Result<LodDag> dag = build_dag(built.mesh, {});
  EXPECT_TRUE(dag.ok());
  if (dag.ok()) built.dag = std::move(*dag);
  return built;
}
inline Built build(const scene::Primitive& shape) {
  return build(lab::as_mesh(shape));
}

/// `is_second(triangle, centroid)`: it has the second of two materials.
template <class IsSecond>
scene::SourceMesh in_two_materials(const scene::Primitive& shape, const IsSecond& is_second) {
  scene::SourceMesh mesh = lab::as_mesh(shape);
  mesh.primitives.push_back(shape);
  for (std::uint32_t m = 0; m < 2; ++m) {
    mesh.primitives[m].material = MaterialId(m);
    mesh.primitives[m].indices.clear();
  }
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    Vec3d centroid(0.0);
    for (std::size_t k = 0; k < 3; ++k) centroid += shape.positions[shape.indices[i + k]] / 3.0;
    auto& to = mesh.primitives[is_second(i / 3, centroid) ? 1 : 0].indices;
    to.insert(to.end(), shape.indices.begin() + i, shape.indices.begin() + i + 3);
  }
  return mesh;
}

}  // namespace meshlode::builder::test
