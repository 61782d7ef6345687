// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/plan/plan.h"

#include <algorithm>
#include <cmath>

namespace meshlode::build {

namespace {

/// Cosine of the largest angle (about half a degree) between a stored normal and its triangle's that still counts as
/// flat.
constexpr double kFlatCosine = 0.99996;

/// True if every corner's normal is its triangle's own: then nothing needs storing. Triangles without area do not vote.
bool has_flat_normals(const scene::SourceMesh& mesh) {
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
        if (!(dot > 0.0) || dot * dot < kFlatCosine * kFlatCosine * length2 * area2) return false;
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

}  // namespace

std::string mesh_label(const scene::SourceMesh& mesh, std::size_t index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " '" + mesh.name + "'");
}

MeshPlan plan_mesh(const scene::SourceMesh& mesh, const std::vector<scene::SceneMaterial>& materials,
                   AttributeChoice choice, const std::string& mesh_label) {
  MeshPlan plan;
  const auto decide = [&](const std::string& what, bool kept, const char* reason) {
    plan.decisions.push_back({mesh_label + ": " + what, kept, reason, false, what});
    return kept;
  };

  bool any_normals = false;
  bool any_colors = false;
  bool any_tangents = false;
  bool shown_tangents = false;
  std::uint32_t uv_sets_present = 0;
  std::uint32_t uv_sets_sampled = 0;
  for (const scene::Primitive& primitive : mesh.primitives) {
    any_normals |= !primitive.normals.empty();
    any_colors |= !primitive.colors.empty();
    any_tangents |= primitive.has_tangents;
    for (std::size_t set = 0; set < scene::kMaxUvSets; ++set) {
      if (!primitive.uvs[set].empty()) uv_sets_present |= 1U << set;
    }
    if (primitive.material.is_valid() && primitive.material.value < materials.size()) {
      const scene::SceneMaterial& material = materials[primitive.material.value];
      uv_sets_sampled |= material.uv_sets_used;
      shown_tangents |= primitive.has_tangents && material.needs_tangents;
    }
  }

  AttributeLayout& layout = plan.layout;
  if (choice == AttributeChoice::kNone) {
    if (any_normals) decide("NORMAL", false, "left out by option");
  } else if (!any_normals) {
    layout.flat_normal = decide("flat normals", true, "the source has none: they follow from the triangles");
  } else if (has_flat_normals(mesh)) {
    layout.flat_normal = true;
    decide("NORMAL", false, "every normal is its triangle's own: they follow from the triangles");
  } else {
    layout.has_normal = decide("NORMAL", true, "shading differs from the triangles' own normals");
  }

  for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
    if ((uv_sets_present >> set & 1U) == 0) continue;
    const std::string name = "TEXCOORD_" + std::to_string(set);
    bool kept = false;
    if (choice == AttributeChoice::kNone) {
      kept = decide(name, false, "left out by option");
    } else if (choice == AttributeChoice::kAll) {
      kept = decide(name, true, "kept by option");
    } else if ((uv_sets_sampled >> set & 1U) != 0) {
      kept = decide(name, true, "a material samples a texture through it");
    } else {
      kept = decide(name, false, "no material samples a texture through it");
    }
    if (kept) layout.uv_set_source[layout.uv_set_count++] = static_cast<std::uint8_t>(set);
  }

  if (any_colors) {
    if (choice == AttributeChoice::kNone) {
      decide("COLOR_0", false, "left out by option");
    } else if (choice == AttributeChoice::kAuto && is_all_white(mesh)) {
      decide("COLOR_0", false, "all white");
    } else {
      layout.has_color = decide("COLOR_0", true, "not all white");
    }
  }
  if (any_tangents && choice == AttributeChoice::kNone) {
    decide("TANGENT", false, "left out by option");
  } else if (shown_tangents) {
    decide("TANGENT", false, "the format has none: shading derives tangents from normals and texture coordinates");
    plan.decisions.back().is_loss = true;
  } else if (any_tangents) {
    decide("TANGENT", false, "no material has a normal map or anisotropy");
  }
  return plan;
}

}  // namespace meshlode::build
