// SPDX-License-Identifier: GPL-3.0-or-later
// Small meshes with a LOD DAG made by hand: the same structs that the build makes, from nothing but counting. They hold
// I1 to I6, so that a test may break one thing and know that it is the only one.
#pragma once

#include "builder/hierarchy/hierarchy.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::test {

struct SampleMesh {
  builder::PreparedMesh mesh;
  builder::LodDag dag;
  builder::Hierarchy hierarchy;
  scene::SourceMesh source;  ///< what the mesh was prepared from: positions lie exactly on the grid
};

/// An open, bumpy patch of 16 × 16 quads: normals, one UV set, two materials with a UV seam along their border (x = 8).
/// Level 0: 16 clusters of 32 triangles in four groups; level 1: 8 clusters of 24 in one group; level 2: two clusters
/// of 40 in the terminal group. Every group keeps its border and the border between the materials.
[[nodiscard]] SampleMesh sample_patch();

/// A closed sphere-like cube of 6 × 8 × 8 quads: normals and colours, one material. Level 0: 24 clusters of 32
/// triangles in six groups, one a face; level 1: 12 clusters of 24 in one group; level 2: a cube of 12 triangles,
/// terminal.
[[nodiscard]] SampleMesh sample_sphere();

/// Positions alone, flat normals: a tetrahedron that is one cluster in one terminal group.
[[nodiscard]] SampleMesh sample_tetrahedron();

}  // namespace meshlode::test
