// SPDX-License-Identifier: GPL-3.0-or-later
// What a simplifier takes, of meshes that are no group of a DAG.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::test {

/// Nothing locked, each vertex its own witness, one material, and no attributes.
inline builder::SimplifyInput as_input(const std::vector<Vec3i>& positions,
                                       const std::vector<std::uint32_t>& wedge_position,
                                       const std::vector<builder::WedgeTriangle>& triangles) {
  builder::SimplifyInput input;
  input.positions = positions;
  input.is_locked.assign(positions.size(), 0);
  for (const Vec3i& p : positions) input.witnesses.push_back({{p}, 1});
  input.wedge_position = wedge_position;
  input.is_wedge_shared.assign(wedge_position.size(), 0);
  input.triangles = triangles;
  input.triangle_material.assign(triangles.size(), 0);
  return input;
}

/// All of a mesh, with what it has.
inline builder::SimplifyInput as_input(const builder::PreparedMesh& mesh) {
  builder::SimplifyInput input = as_input(mesh.positions, mesh.wedge_position, mesh.triangles);
  input.grid = mesh.grid;
  input.layout = mesh.layout;
  input.wedge_attributes = mesh.wedge_attributes;
  input.triangle_material = mesh.triangle_material;
  return input;
}

}  // namespace meshlode::test
