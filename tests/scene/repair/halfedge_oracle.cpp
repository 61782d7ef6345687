// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/repair/halfedge_oracle.h"

#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

namespace meshlode::test {

HalfedgeVerdict judge_by_halfedges(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  omerr().disable();  // its complaints are counted
  OpenMesh::TriMesh_ArrayKernelT<> mesh;
  std::vector<OpenMesh::VertexHandle> handles;
  for (std::size_t v = 0; v < vertex_count; ++v) handles.push_back(mesh.add_vertex({0.0F, 0.0F, 0.0F}));
  HalfedgeVerdict verdict;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const auto face = mesh.add_face(handles[indices[i]], handles[indices[i + 1]], handles[indices[i + 2]]);
    verdict.refused += face.is_valid() ? 0U : 1U;
  }
  for (const OpenMesh::VertexHandle v : mesh.vertices()) verdict.complex_vertices += mesh.is_manifold(v) ? 0U : 1U;
  omerr().enable();
  return verdict;
}

}  // namespace meshlode::test
