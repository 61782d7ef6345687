// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace meshlode::bench {

namespace {

namespace om = OpenMesh;

struct DoubleTraits : om::DefaultTraits {
  using Point = om::Vec3d;
  using Normal = om::Vec3d;
};
using Mesh = om::TriMesh_ArrayKernelT<DoubleTraits>;
using Decimater = om::Decimater::DecimaterT<Mesh>;
using FlipModule = om::Decimater::ModNormalFlippingT<Mesh>;
using QuadricModule = om::Decimater::ModQuadricT<Mesh>;

/// For every vertex the first one at the same position.
std::vector<std::uint32_t> weld(const std::vector<Vec3d>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z, i); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = is_same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

struct ReferenceSimplifier::State {
  Mesh mesh;
  std::unique_ptr<Decimater> decimater;
  std::size_t degenerate = 0, refused = 0;
};

ReferenceSimplifier::ReferenceSimplifier(const judge::Surface& source) : state_(std::make_unique<State>()) {
  // Its complaints about refused faces are counted here instead.
  omerr().disable();
  Mesh& mesh = state_->mesh;
  mesh.request_face_status();
  mesh.request_edge_status();
  mesh.request_halfedge_status();
  mesh.request_vertex_status();
  mesh.request_face_normals();
  const std::vector<std::uint32_t> welded = weld(source.positions);
  std::vector<Mesh::VertexHandle> handles(source.positions.size());
  for (const auto& t : source.triangles) {
    std::array<std::uint32_t, 3> corners{welded[t[0]], welded[t[1]], welded[t[2]]};
    const Vec3d a = source.positions[corners[0]];
    const Vec3d n = glm::cross(source.positions[corners[1]] - a, source.positions[corners[2]] - a);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] || !(glm::dot(n, n) > 0.0)) {
      ++state_->degenerate;
      continue;
    }
    for (const std::uint32_t c : corners) {
      if (handles[c].is_valid()) continue;
      const Vec3d& p = source.positions[c];
      handles[c] = mesh.add_vertex({p.x, p.y, p.z});
    }
    const auto face = mesh.add_face(handles[corners[0]], handles[corners[1]], handles[corners[2]]);
    state_->refused += face.is_valid() ? 0U : 1U;
  }
  omerr().enable();
  mesh.delete_isolated_vertices();
  mesh.garbage_collection();
  mesh.update_face_normals();
  state_->decimater = std::make_unique<Decimater>(mesh);
  FlipModule::Handle flip;  // without it flat regions fold over, because that costs no quadric error
  state_->decimater->add(flip);
  QuadricModule::Handle quadric;
  state_->decimater->add(quadric);
  state_->decimater->module(quadric).unset_max_err();  // a priority, no limit
  state_->decimater->initialize();
}

ReferenceSimplifier::~ReferenceSimplifier() = default;

std::size_t ReferenceSimplifier::degenerate_count() const {
  return state_->degenerate;
}
std::size_t ReferenceSimplifier::refused_count() const {
  return state_->refused;
}
std::size_t ReferenceSimplifier::face_count() const {
  return state_->mesh.n_faces();
}

bool ReferenceSimplifier::decimate_to(std::size_t faces) {
  const std::size_t before = face_count();
  (void)state_->decimater->decimate_to_faces(0, faces);
  state_->mesh.garbage_collection();
  return face_count() < before;
}

judge::Surface ReferenceSimplifier::surface() const {
  judge::Surface out;
  const Mesh& mesh = state_->mesh;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    out.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(f)) corners[k++] = static_cast<std::uint32_t>(v.idx());
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace meshlode::bench
