// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "builder/plan/attributes.h"

namespace meshlode::builder {

namespace {

/// Squared cosine of the largest angle between a stored normal and its triangle's that still counts as flat: about half
/// a degree, and where normals are promised what floats of unit normals leave open, a ten-millionth.
constexpr double kFlatCosine2 = 0.99996 * 0.99996, kSameCosine2 = 1.0 - 0x1p-46;

/// True if every corner's normal is its triangle's own: then nothing needs storing. Triangles without area do not vote.
bool has_flat_normals(const scene::SourceMesh& mesh, double least_cosine2) {
  bool any = false;
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.normals.empty()) continue;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const std::uint32_t* corner = &primitive.indices[i];
      const Vec3d& a = primitive.positions[corner[0]];
      const Vec3d cross = glm::cross(primitive.positions[corner[1]] - a, primitive.positions[corner[2]] - a);
      const double area2 = glm::dot(cross, cross);
      if (!(area2 > 0.0) || !std::isfinite(area2)) continue;
      for (int k = 0; k < 3; ++k) {
        const Vec3d normal(primitive.normals[corner[k]]);
        const double length2 = glm::dot(normal, normal);
        const double dot = glm::dot(normal, cross);
        if (!(dot > 0.0) || dot * dot < least_cosine2 * length2 * area2) return false;
      }
      any = true;
    }
  }
  return any;
}

bool is_all_white(const scene::SourceMesh& mesh) {
  for (const scene::Primitive& primitive : mesh.primitives) {
    for (const Vec4f& color : primitive.colors) {
      if (color != Vec4f(1.0F)) return false;
    }
  }
  return true;
}

/// What the primitives of a mesh have, and what its materials show of it.
struct MeshContents {
  bool any_normals = false, any_colors = false;
  bool any_tangents = false, shown_tangents = false;
  std::uint32_t uv_sets = 0, sampled_uv_sets = 0;  ///< bit n: TEXCOORD_n
};

MeshContents contents_of(const scene::SourceMesh& mesh, const std::vector<scene::SceneMaterial>& materials) {
  MeshContents out;
  for (const scene::Primitive& primitive : mesh.primitives) {
    out.any_normals |= !primitive.normals.empty();
    out.any_colors |= !primitive.colors.empty();
    out.any_tangents |= primitive.has_tangents;
    for (std::size_t set = 0; set < scene::kMaxUvSets; ++set) {
      if (!primitive.uvs[set].empty()) out.uv_sets |= 1U << set;
    }
    if (primitive.material.is_valid() && primitive.material.value < materials.size()) {
      const scene::SceneMaterial& material = materials[primitive.material.value];
      out.sampled_uv_sets |= material.uv_sets_used;
      out.shown_tangents |= primitive.has_tangents && material.needs_tangents;
    }
  }
  return out;
}

/// Whether an attribute is stored, and the decision's words.
struct Verdict {
  bool kept = false;
  const char* reason = "";
};

class Planner {
 public:
  Planner(const AttributeRequest& request, const std::string& label) : request_(request), label_(label) {}

  void plan_normals(const scene::SourceMesh& mesh, bool any_normals) {
    AttributeLayout& layout = plan_.layout;
    const bool is_none = request_.choice == AttributeChoice::kNone;
    if (!any_normals) {
      if (is_none) return;
      layout.flat_normal = true;
      add("flat normals", {true, "the source has none: they follow from the triangles"});
      return;
    }
    const bool is_flat = !is_none && has_flat_normals(mesh, request_.promises_normals ? kSameCosine2 : kFlatCosine2);
    Verdict verdict{true, "shading differs from the triangles' own normals"};
    if (is_none) verdict = {false, "left out by option"};
    if (is_flat) verdict = {false, "every normal is its triangle's own: they follow from the triangles"};
    layout.has_normal = decide("NORMAL", kAttributeNormal, verdict);
    layout.flat_normal = is_flat && !layout.has_normal;
  }

  void plan_uvs(std::uint32_t sets, std::uint32_t sampled) {
    for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
      if ((sets >> set & 1U) == 0) continue;
      Verdict verdict{false, "no material samples a texture through it"};
      if ((sampled >> set & 1U) != 0) verdict = {true, "a material samples a texture through it"};
      if (request_.choice == AttributeChoice::kAll) verdict = {true, "kept by option"};
      if (request_.choice == AttributeChoice::kNone) verdict = {false, "left out by option"};
      if (!decide("TEXCOORD_" + std::to_string(set), attribute_texcoord(set), verdict)) continue;
      plan_.layout.uv_set_source[plan_.layout.uv_set_count++] = static_cast<std::uint8_t>(set);
    }
  }

  void plan_colors(const scene::SourceMesh& mesh) {
    Verdict verdict{true, "not all white"};
    if (request_.choice == AttributeChoice::kAuto && is_all_white(mesh)) verdict = {false, "all white"};
    if (request_.choice == AttributeChoice::kNone) verdict = {false, "left out by option"};
    plan_.layout.has_color = decide("COLOR_0", kAttributeColor, verdict);
  }

  /// The format stores none, whatever is asked for.
  void plan_tangents(bool are_shown) {
    if (request_.choice == AttributeChoice::kNone) return add("TANGENT", {false, "left out by option"});
    if (!are_shown) return add("TANGENT", {false, "no material has a normal map or anisotropy"});
    add("TANGENT", {false, "the format has none: shading derives tangents from normals and texture coordinates"});
    plan_.decisions.back().is_loss = true;
  }

  [[nodiscard]] MeshPlan take() { return std::move(plan_); }

 private:
  void add(const std::string& what, const Verdict& verdict) {
    plan_.decisions.push_back({label_ + ": " + what, verdict.kept, verdict.reason, false, what});
  }

  /// The rule's verdict, unless the attribute is named and that says otherwise.
  bool decide(const std::string& what, std::uint32_t bit, Verdict verdict) {
    const bool keeps = !verdict.kept && (request_.keep & bit) != 0;
    const bool drops = verdict.kept && (request_.drop & bit) != 0;
    if (keeps) verdict = {true, "kept by name"};
    if (drops) verdict = {false, "dropped by name"};
    add(what, verdict);
    plan_.decisions.back().is_forced = keeps || drops;
    return verdict.kept;
  }

  const AttributeRequest& request_;
  const std::string& label_;
  MeshPlan plan_;
};

}  // namespace

std::string mesh_label(const scene::SourceMesh& mesh, std::size_t index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " '" + mesh.name + "'");
}

MeshPlan plan_mesh(const scene::SourceMesh& mesh, const std::vector<scene::SceneMaterial>& materials,
                   const AttributeRequest& request, const std::string& mesh_label) {
  const MeshContents contents = contents_of(mesh, materials);
  Planner planner(request, mesh_label);
  planner.plan_normals(mesh, contents.any_normals);
  planner.plan_uvs(contents.uv_sets, contents.sampled_uv_sets);
  if (contents.any_colors) planner.plan_colors(mesh);
  if (contents.any_tangents) planner.plan_tangents(contents.shown_tangents);
  return planner.take();
}

std::uint32_t forced_attributes(std::span<const PlanDecision> decisions, bool kept) {
  std::uint32_t bits = 0;
  for (const PlanDecision& decision : decisions) {
    if (!decision.is_forced || decision.kept != kept) continue;
    bits |= value_in(kAttributeNames, decision.attribute).value_or(0);
  }
  return bits;
}

}  // namespace meshlode::builder
