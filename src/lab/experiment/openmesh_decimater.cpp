// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/experiment/openmesh_decimater.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <utility>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "base/disjoint_sets.h"
#include "base/ids.h"
#include "builder/simplify/border_rule.h"
#include "builder/simplify/group_places.h"

namespace meshlode::lab {

namespace {

using namespace builder;

namespace om = OpenMesh;
namespace od = OpenMesh::Decimater;

struct DoubleTraits : om::DefaultTraits {
  using Point = om::Vec3d;
  using Normal = om::Vec3d;
};
using Mesh = om::TriMesh_ArrayKernelT<DoubleTraits>;
using Collapse = od::CollapseInfoT<Mesh>;

std::uint32_t id_of(const om::BaseHandle& handle) {
  return static_cast<std::uint32_t>(handle.idx());
}

/// One use of an edge between two positions.
struct EdgeUseOfPosition {
  std::uint32_t low, high;
  std::uint32_t corner;  ///< whose edge to the next corner this is
  std::int32_t sign;     ///< +1 from low to high
  auto operator<=>(const EdgeUseOfPosition&) const = default;
};

std::uint32_t next_in_triangle(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/// The group in OpenMesh, and what OpenMesh knows nothing of: wedges, materials, witnesses, and triangles that it does
/// not take.
///
/// It refuses edges of more than two triangles and vertices with more than one fan of them, aloud. So a vertex of it is
/// one fan at one position: a position with several has several vertices, all of them locked, as is everything at such
/// an edge. Triangles without area, at which it aborts, are carried through with their corners locked.
class DecimatedGroup {
 public:
  enum class Refusal : std::uint8_t { kNone, kLocked, kTopology, kFlips, kSeams };

  /// The input must outlive this.
  explicit DecimatedGroup(const SimplifyInput& input);

  [[nodiscard]] Mesh& mesh() { return mesh_; }
  /// Of OpenMesh's; the others are `carried_count`.
  [[nodiscard]] std::size_t alive_count() const { return alive_count_; }
  [[nodiscard]] std::size_t carried_count() const { return carried_count_; }

  /// What of the contract the collapse would break: kNone, kLocked, kTopology or kSeams.
  [[nodiscard]] Refusal why_not(const Collapse& collapse) const;
  /// Follows a collapse that is about to be done. `error` is its quadric's, area times squared distance in the frame.
  void follow(const Collapse& collapse, double error);
  [[nodiscard]] SimplifyResult result() const;
  [[nodiscard]] std::size_t count_pieces() const;

 private:
  void lock(std::uint32_t corner) { is_locked_[position_of(corner)] = 1; }
  [[nodiscard]] std::uint32_t wedge_of_input(std::uint32_t corner) const {
    return input_.triangles[corner / 3][corner % 3];
  }
  [[nodiscard]] std::uint32_t position_of_input(std::uint32_t corner) const {
    return input_.wedge_position[wedge_of_input(corner)];
  }
  [[nodiscard]] std::uint32_t position_of(std::uint32_t corner) const { return corner_position_[corner]; }
  [[nodiscard]] bool has_area(std::uint32_t triangle) const;
  [[nodiscard]] bool has_corners_in_one_place(std::uint32_t triangle) const;
  void sort_out_triangles();
  void join_fans(DisjointSets& fans);
  void add_vertices(DisjointSets& fans);
  void add_faces();

  [[nodiscard]] std::uint32_t triangle_of(om::FaceHandle face) const { return face_triangle_[id_of(face)]; }
  /// The corner of the face at the position.
  [[nodiscard]] std::uint32_t corner_at(om::FaceHandle face, std::uint32_t position) const;
  [[nodiscard]] std::uint32_t wedge_at(om::FaceHandle face, std::uint32_t position) const {
    return corner_wedge_[corner_at(face, position)];
  }
  /// What the wedge of v0 becomes at v1: one that it meets in a triangle on the edge, or itself, at its new place;
  /// kNoId where two would do, or where it may not move.
  [[nodiscard]] std::uint32_t heir_of(const Collapse& collapse, std::uint32_t wedge) const;
  [[nodiscard]] bool keeps_shared_corners(const Collapse& collapse, om::FaceHandle going, om::VertexHandle tip,
                                          om::HalfedgeHandle from_v0_to_tip) const;

  const SimplifyInput& input_;
  GroupPlaces places_;
  bool has_attributes_ = false;
  std::vector<std::uint8_t> is_locked_;         ///< per position
  std::vector<std::uint8_t> is_dropped_;        ///< per triangle: two corners in one place
  std::vector<std::uint8_t> is_face_;           ///< per triangle: OpenMesh has it
  std::vector<std::uint32_t> corner_position_;  ///< per corner, as it is now
  std::vector<std::uint32_t> corner_wedge_;   ///< per corner, as it is now; the position where there are no attributes
  std::vector<std::uint32_t> corner_vertex_;  ///< per corner, OpenMesh's, as it was
  std::vector<std::uint32_t> vertex_position_;  ///< per vertex of OpenMesh
  std::vector<std::uint32_t> face_triangle_;    ///< per face of OpenMesh
  std::vector<double> weight_;                  ///< per vertex of OpenMesh: area around all that came to it
  std::vector<Witnesses> witnesses_;            ///< per position
  std::size_t alive_count_ = 0, carried_count_ = 0;
  double error2_ = 0.0;  ///< frame units
  Mesh mesh_;
};

DecimatedGroup::DecimatedGroup(const SimplifyInput& input)
    : input_(input),
      places_(input.positions),
      has_attributes_(input.layout.stride() > 0),
      is_locked_(input.is_locked),
      is_dropped_(input.triangles.size(), 0),
      is_face_(input.triangles.size(), 0),
      corner_vertex_(3 * input.triangles.size(), kNoId),
      witnesses_(input.witnesses) {
  for (std::uint32_t corner = 0; corner < 3 * input.triangles.size(); ++corner) {
    corner_position_.push_back(position_of_input(corner));
    corner_wedge_.push_back(has_attributes_ ? wedge_of_input(corner) : position_of_input(corner));
  }
  mesh_.request_face_status();
  mesh_.request_edge_status();
  mesh_.request_halfedge_status();
  mesh_.request_vertex_status();
  mesh_.request_face_normals();
  sort_out_triangles();
  DisjointSets fans(corner_position_.size());
  join_fans(fans);
  add_vertices(fans);
  add_faces();
  mesh_.update_face_normals();
}

bool DecimatedGroup::has_area(std::uint32_t triangle) const {
  constexpr double kFlattest = 1e-12;  // of its longest side: below, its normal is made of roundings
  const Vec3d& a = places_[position_of(3 * triangle)];
  const Vec3d u = places_[position_of(3 * triangle + 1)] - a;
  const Vec3d v = places_[position_of(3 * triangle + 2)] - a;
  const Vec3d w = v - u;
  const double longest2 = std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)});
  const Vec3d n = glm::cross(u, v);
  return std::sqrt(glm::dot(n, n)) > kFlattest * longest2;
}

bool DecimatedGroup::has_corners_in_one_place(std::uint32_t triangle) const {
  const Vec3i& p = places_.on_grid(position_of(3 * triangle));
  const Vec3i& q = places_.on_grid(position_of(3 * triangle + 1));
  const Vec3i& r = places_.on_grid(position_of(3 * triangle + 2));
  return p == q || q == r || r == p;
}

void DecimatedGroup::sort_out_triangles() {
  for (std::uint32_t t = 0; t < is_face_.size(); ++t) {
    is_dropped_[t] = has_corners_in_one_place(t) ? 1 : 0;
    is_face_[t] = is_dropped_[t] == 0 && has_area(t) ? 1 : 0;
    if (is_face_[t] != 0) continue;
    for (std::uint32_t k = 0; k < 3; ++k) lock(3 * t + k);
  }
}

/// Corners at one position whose triangles meet in an edge of just these two, which run along it in opposite ways.
void DecimatedGroup::join_fans(DisjointSets& fans) {
  std::vector<EdgeUseOfPosition> uses;
  for (std::uint32_t corner = 0; corner < corner_position_.size(); ++corner) {
    if (is_face_[corner / 3] == 0) continue;
    const std::uint32_t a = position_of(corner);
    const std::uint32_t b = position_of(next_in_triangle(corner));
    uses.push_back({std::min(a, b), std::max(a, b), corner, a < b ? 1 : -1});
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 0; i < uses.size();) {
    const std::size_t first = i;
    while (i < uses.size() && uses[i].low == uses[first].low && uses[i].high == uses[first].high) ++i;
    if (i - first == 1) continue;  // open
    const std::uint32_t x = uses[first].corner, y = uses[first + 1].corner;
    const bool is_one_surface = i - first == 2 && uses[first].sign + uses[first + 1].sign == 0;
    if (is_one_surface) {
      fans.join(x, next_in_triangle(y));
      fans.join(y, next_in_triangle(x));
    }
    if (!is_one_surface || input_.triangle_material[x / 3] != input_.triangle_material[y / 3]) {
      is_locked_[uses[first].low] = is_locked_[uses[first].high] = 1;
    }
  }
}

void DecimatedGroup::add_vertices(DisjointSets& fans) {
  std::vector<std::uint32_t> vertex_of_fan(corner_position_.size(), kNoId);
  std::vector<std::uint8_t> has_vertex(input_.positions.size(), 0);
  for (std::uint32_t corner = 0; corner < corner_position_.size(); ++corner) {
    if (is_face_[corner / 3] == 0) continue;
    std::uint32_t& vertex = vertex_of_fan[fans.find(corner)];
    if (vertex == kNoId) {
      const std::uint32_t p = position_of(corner);
      const Vec3d& place = places_[p];
      vertex = id_of(mesh_.add_vertex({place.x, place.y, place.z}));
      vertex_position_.push_back(p);
      if (has_vertex[p] != 0) is_locked_[p] = 1;
      has_vertex[p] = 1;
    }
    corner_vertex_[corner] = vertex;
  }
  weight_.assign(vertex_position_.size(), 0.0);
}

void DecimatedGroup::add_faces() {
  // The same way along the same edge twice, by three triangles that fans join elsewhere: the later one is carried.
  std::vector<std::array<std::uint32_t, 3>> sides;  // from, to, triangle
  for (std::uint32_t corner = 0; corner < corner_position_.size(); ++corner) {
    if (is_face_[corner / 3] == 0) continue;
    sides.push_back({corner_vertex_[corner], corner_vertex_[next_in_triangle(corner)], corner / 3});
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i][0] == sides[i - 1][0] && sides[i][1] == sides[i - 1][1]) is_face_[sides[i][2]] = 0;
  }
  for (std::uint32_t t = 0; t < is_face_.size(); ++t) {
    if (is_face_[t] == 0) continue;
    const auto vertex = [&](std::uint32_t k) { return om::VertexHandle(static_cast<int>(corner_vertex_[3 * t + k])); };
    const om::FaceHandle face = mesh_.add_face(vertex(0), vertex(1), vertex(2));
    if (!face.is_valid()) {
      is_face_[t] = 0;
      continue;
    }
    face_triangle_.push_back(t);
    const Vec3d& a = places_[position_of(3 * t)];
    const Vec3d n = glm::cross(places_[position_of(3 * t + 1)] - a, places_[position_of(3 * t + 2)] - a);
    for (std::uint32_t k = 0; k < 3; ++k) weight_[corner_vertex_[3 * t + k]] += 0.5 * std::sqrt(glm::dot(n, n));
  }
  for (std::uint32_t t = 0; t < is_face_.size(); ++t) {
    alive_count_ += is_face_[t];
    if (is_face_[t] != 0 || is_dropped_[t] != 0) continue;
    ++carried_count_;
    for (std::uint32_t k = 0; k < 3; ++k) lock(3 * t + k);
  }
  for (const auto v : mesh_.vertices()) mesh_.status(v).set_locked(is_locked_[vertex_position_[id_of(v)]] != 0);
}

std::uint32_t DecimatedGroup::corner_at(om::FaceHandle face, std::uint32_t position) const {
  std::uint32_t corner = 3 * triangle_of(face);
  while (position_of(corner) != position) ++corner;
  return corner;
}

std::uint32_t DecimatedGroup::heir_of(const Collapse& collapse, std::uint32_t wedge) const {
  const std::uint32_t from = vertex_position_[id_of(collapse.v0)], to = vertex_position_[id_of(collapse.v1)];
  if (!has_attributes_) return to;
  std::uint32_t heir = kNoId;
  for (const om::FaceHandle going : {collapse.fl, collapse.fr}) {
    if (!going.is_valid() || wedge_at(going, from) != wedge) continue;
    const std::uint32_t found = wedge_at(going, to);
    if (heir != kNoId && heir != found) return kNoId;
    heir = found;
  }
  // A crease of normals may move with its vertex; a texture would be torn. A locked vertex takes on nothing new.
  if (heir == kNoId && is_locked_[to] == 0 && input_.layout.uv_set_count == 0) return wedge;
  return heir;
}

/// Where the edge between v1 and the tip of a triangle that goes is shared, the triangle that comes to it must have the
/// same wedges there.
bool DecimatedGroup::keeps_shared_corners(const Collapse& collapse, om::FaceHandle going, om::VertexHandle tip,
                                          om::HalfedgeHandle from_v0_to_tip) const {
  if (!going.is_valid() || !has_attributes_) return true;
  const std::uint32_t from = vertex_position_[id_of(collapse.v0)], to = vertex_position_[id_of(collapse.v1)];
  const std::uint32_t at_tip = vertex_position_[id_of(tip)];
  if (is_locked_[to] == 0 || is_locked_[at_tip] == 0) return true;
  om::FaceHandle heir = mesh_.face_handle(from_v0_to_tip);
  if (heir == going) heir = mesh_.face_handle(mesh_.opposite_halfedge_handle(from_v0_to_tip));
  if (!heir.is_valid()) return false;
  const std::uint32_t tip_wedge = wedge_at(going, at_tip);
  if (input_.is_wedge_shared[tip_wedge] != 0 && wedge_at(heir, at_tip) != tip_wedge) return false;
  return input_.is_wedge_shared[wedge_at(going, to)] == 0 || wedge_at(heir, from) == wedge_at(going, from);
}

DecimatedGroup::Refusal DecimatedGroup::why_not(const Collapse& collapse) const {
  const std::uint32_t from = vertex_position_[id_of(collapse.v0)], to = vertex_position_[id_of(collapse.v1)];
  if (is_locked_[from] != 0) return Refusal::kLocked;
  for (const om::HalfedgeHandle out : mesh_.voh_range(collapse.v0)) {
    const om::VertexHandle tip = mesh_.to_vertex_handle(out);
    // An open edge would come to lie between two locked vertices, where another group may have one.
    const bool is_open = mesh_.is_boundary(mesh_.edge_handle(out));
    if (is_open && tip != collapse.v1 && is_locked_[to] != 0 && is_locked_[vertex_position_[id_of(tip)]] != 0) {
      return Refusal::kLocked;
    }
    const om::FaceHandle face = mesh_.face_handle(out);
    if (!face.is_valid() || face == collapse.fl || face == collapse.fr) continue;
    const std::uint32_t t = triangle_of(face);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (places_.on_grid(position_of(3 * t + k)) == places_.on_grid(to)) return Refusal::kTopology;
    }
    if (heir_of(collapse, wedge_at(face, from)) == kNoId) return Refusal::kSeams;
  }
  const bool keeps = keeps_shared_corners(collapse, collapse.fl, collapse.vl, collapse.v0vl) &&
                     keeps_shared_corners(collapse, collapse.fr, collapse.vr, collapse.vrv0);
  return keeps ? Refusal::kNone : Refusal::kSeams;
}

void DecimatedGroup::follow(const Collapse& collapse, double error) {
  const std::uint32_t from = vertex_position_[id_of(collapse.v0)], to = vertex_position_[id_of(collapse.v1)];
  double& weight = weight_[id_of(collapse.v1)];
  weight += weight_[id_of(collapse.v0)];
  if (weight > 0.0) error2_ = std::max(error2_, error / weight);
  // All heirs first: they are found by what is as it was.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> heirs;
  for (const om::FaceHandle face : mesh_.vf_range(collapse.v0)) {
    if (face == collapse.fl || face == collapse.fr) {
      is_face_[triangle_of(face)] = 0;
      is_dropped_[triangle_of(face)] = 1;
      --alive_count_;
      continue;
    }
    const std::uint32_t corner = corner_at(face, from);
    heirs.emplace_back(corner, heir_of(collapse, corner_wedge_[corner]));
  }
  for (const auto& [corner, wedge] : heirs) {
    corner_position_[corner] = to;
    corner_wedge_[corner] = wedge;
  }
  Witnesses& kept = witnesses_[to];
  const Witnesses& gone = witnesses_[from];
  for (std::uint32_t i = 0; i < gone.count && kept.count < Witnesses::kCapacity; ++i) {
    kept.points[kept.count] = gone.points[i];
    kept.ids[kept.count++] = gone.ids[i];
  }
}

std::size_t DecimatedGroup::count_pieces() const {
  DisjointSets pieces(input_.positions.size());
  std::vector<std::uint8_t> is_used(input_.positions.size(), 0);
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < is_dropped_.size(); ++t) {
    if (is_dropped_[t] != 0) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint8_t& used = is_used[position_of(3 * t + k)];
      count += used == 0 ? 1 : 0;
      used = 1;
      if (k > 0 && pieces.join(position_of(3 * t), position_of(3 * t + k))) --count;
    }
  }
  return count;
}

SimplifyResult DecimatedGroup::result() const {
  SimplifyResult out;
  out.quadric_error = std::sqrt(error2_) * places_.scale() * input_.grid.step();
  const std::uint32_t stride = input_.layout.stride();
  std::vector<std::uint32_t> new_position(input_.positions.size(), kNoId);
  std::vector<std::uint32_t> new_wedge(std::max(input_.wedge_position.size(), input_.positions.size()), kNoId);
  for (std::uint32_t t = 0; t < is_dropped_.size(); ++t) {
    if (is_dropped_[t] != 0) continue;
    WedgeTriangle triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t p = position_of(3 * t + k), w = corner_wedge_[3 * t + k];
      if (new_position[p] == kNoId) {
        new_position[p] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(input_.positions[p]);
        out.witnesses.push_back(witnesses_[p]);
      }
      if (new_wedge[w] == kNoId) {
        new_wedge[w] = static_cast<std::uint32_t>(out.wedge_position.size());
        out.wedge_position.push_back(new_position[p]);
        const auto first = input_.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(std::size_t{w} * stride);
        if (has_attributes_) out.wedge_attributes.insert(out.wedge_attributes.end(), first, first + stride);
      }
      triangle[k] = new_wedge[w];
    }
    out.triangles.push_back(triangle);
    out.triangle_material.push_back(input_.triangle_material[t]);
  }
  return out;
}

/// Its priority is never below zero: what roundings make of a flat region would be illegal to the decimater.
class Quadrics : public od::ModQuadricT<Mesh> {
 public:
  using Handle = od::ModHandleT<Quadrics>;
  using Base = od::ModQuadricT<Mesh>;
  using Base::Base;
  float collapse_priority(const Collapse& collapse) override {
    return std::max(0.0F, Base::collapse_priority(collapse));
  }
};

/// Without it flat regions fold over, because that costs no quadric error.
class Flips : public od::ModNormalFlippingT<Mesh> {
 public:
  using Handle = od::ModHandleT<Flips>;
  using Base = od::ModNormalFlippingT<Mesh>;
  using Base::Base;
  float collapse_priority(const Collapse& collapse) override {
    return is_relaxed ? static_cast<float>(Base::LEGAL_COLLAPSE) : Base::collapse_priority(collapse);
  }
  bool is_relaxed = false;
};

/// Keeps the contract, and the group in step with the mesh.
class Contract : public od::ModBaseT<Mesh> {
 public:
  using Handle = od::ModHandleT<Contract>;
  using Base = od::ModBaseT<Mesh>;
  explicit Contract(Mesh& mesh) : Base(mesh, true) {}
  void set(DecimatedGroup& group, Quadrics& quadrics) {
    group_ = &group;
    quadrics_ = &quadrics;
  }
  [[nodiscard]] const std::string& name() const override {
    static const std::string name = "Contract";
    return name;
  }
  float collapse_priority(const Collapse& collapse) override {
    const bool is_legal = group_->why_not(collapse) == DecimatedGroup::Refusal::kNone;
    return static_cast<float>(is_legal ? Base::LEGAL_COLLAPSE : Base::ILLEGAL_COLLAPSE);
  }
  void preprocess_collapse(const Collapse& collapse) override {
    group_->follow(collapse, double{quadrics_->collapse_priority(collapse)});
  }

 private:
  DecimatedGroup* group_ = nullptr;
  Quadrics* quadrics_ = nullptr;
};

/// By what most of the collapses that are left are refused.
StuckReason reason_for_stopping(DecimatedGroup& group, Flips& flips, std::uint32_t target) {
  if (group.alive_count() + group.carried_count() <= target) return StuckReason::kNotStuck;
  std::array<std::size_t, 5> refused{};
  const auto count = [&](DecimatedGroup::Refusal refusal) { ++refused[static_cast<std::size_t>(refusal)]; };
  Mesh& mesh = group.mesh();
  for (const auto halfedge : mesh.halfedges()) {
    if (mesh.status(mesh.edge_handle(halfedge)).deleted()) continue;
    const Collapse collapse(mesh, halfedge);
    const DecimatedGroup::Refusal refusal = group.why_not(collapse);
    if (refusal != DecimatedGroup::Refusal::kNone) {
      count(refusal);
    } else if (flips.collapse_priority(collapse) < 0.0F) {
      count(DecimatedGroup::Refusal::kFlips);
    } else {
      count(DecimatedGroup::Refusal::kTopology);  // what else OpenMesh refuses
    }
  }
  const auto largest = std::max_element(refused.begin(), refused.end());
  const auto what = static_cast<DecimatedGroup::Refusal>(largest - refused.begin());
  if (what != DecimatedGroup::Refusal::kLocked && 2 * group.count_pieces() > target) return StuckReason::kComponents;
  if (*largest == 0) return group.carried_count() > 0 ? StuckReason::kLocked : StuckReason::kTooSmall;
  switch (what) {
    case DecimatedGroup::Refusal::kLocked: return StuckReason::kLocked;
    case DecimatedGroup::Refusal::kTopology: return StuckReason::kTopology;
    case DecimatedGroup::Refusal::kFlips: return StuckReason::kFlips;
    case DecimatedGroup::Refusal::kSeams: return StuckReason::kSeams;
    case DecimatedGroup::Refusal::kNone: break;
  }
  return StuckReason::kTooSmall;
}

SimplifyResult decimate(const SimplifyInput& input, const SimplifyOptions& options) {
  DecimatedGroup group(input);
  Mesh& mesh = group.mesh();
  od::DecimaterT<Mesh> decimater(mesh);
  Flips::Handle flips;
  Quadrics::Handle quadrics;
  Contract::Handle contract;
  decimater.add(contract);
  decimater.add(flips);
  decimater.add(quadrics);
  decimater.module(contract).set(group, decimater.module(quadrics));
  decimater.module(quadrics).unset_max_err();  // a priority, no limit
  decimater.initialize();
  const auto run = [&] {
    const std::size_t all = group.alive_count() + group.carried_count();
    if (all <= options.target_triangles) return;
    // OpenMesh counts the faces that are deleted too.
    const std::size_t excess = std::min(all - options.target_triangles, group.alive_count());
    (void)decimater.decimate_to_faces(0, mesh.n_faces() - excess);
  };
  run();
  decimater.module(flips).is_relaxed = options.may_relax_flips;
  if (options.may_relax_flips) run();
  SimplifyResult result = group.result();
  result.reason = reason_for_stopping(group, decimater.module(flips), options.target_triangles);
  return result;
}

}  // namespace

SimplifyResult simplify_group_by_openmesh(const SimplifyInput& input, const SimplifyOptions& options) {
  SimplifyResult result = decimate(input, options);
  if (keeps_border(input, result)) return result;
  return decimate(with_locked_border(input), options);
}

}  // namespace meshlode::lab
