// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/api/scene_input.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/hash.h"
#include "base/try.h"

namespace meshlode::builder {
namespace {

std::string at(const std::string& array, std::size_t index) {
  return array + '[' + std::to_string(index) + ']';
}

Error invalid(std::string where, std::string detail) {
  return Error{ErrorCode::kInvalid, std::move(where), std::move(detail)};
}

template <class T>
Status check_array(std::span<const T> values, std::size_t components, std::size_t vertex_count,
                   const std::string& where) {
  if (values.empty()) return Ok{};
  if (values.size() != components * vertex_count) {
    return invalid(where, "has " + std::to_string(values.size()) + " numbers, " + std::to_string(vertex_count) +
                              " vertices need " + std::to_string(components * vertex_count));
  }
  const auto bad = std::find_if(values.begin(), values.end(), [](T v) { return !std::isfinite(v); });
  if (bad != values.end()) return invalid(at(where, static_cast<std::size_t>(bad - values.begin())), "is not finite");
  return Ok{};
}

/// The positions, and which of them are usable: the others only pass with `repair`, and become the origin because no
/// triangle will touch them.
template <class T>
Status copy_positions(std::span<const T> values, const std::string& where, bool repair, std::vector<Vec3d>& out,
                      std::vector<bool>& is_usable) {
  if (values.size() % 3 != 0) return invalid(where, "its length is not a multiple of 3");
  out.resize(values.size() / 3);
  is_usable.assign(out.size(), true);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const T value = values[3 * i + c];
      if (std::isfinite(value)) {
        out[i][static_cast<int>(c)] = static_cast<double>(value);
        continue;
      }
      if (!repair) return invalid(at(where, 3 * i + c), "is not finite");
      is_usable[i] = false;
    }
    if (!is_usable[i]) out[i] = Vec3d(0.0);
  }
  return Ok{};
}

Result<scene::Primitive> make_primitive(const PrimitiveInput& input, const std::string& where,
                                        std::size_t material_count, bool repair, std::uint64_t& repaired) {
  scene::Primitive primitive;
  std::vector<bool> is_usable;
  if (!input.positions.empty() && !input.positions_double.empty()) {
    return invalid(where, "has both positions and positions_double");
  }
  TRY_LET(status, input.positions_double.empty()
                      ? copy_positions(input.positions, where + ".positions", repair, primitive.positions, is_usable)
                      : copy_positions(input.positions_double, where + ".positions_double", repair, primitive.positions,
                                       is_usable));
  const std::size_t count = primitive.positions.size();
  if (count >= format::kNone) return invalid(where, "has too many vertices for 32-bit indices");

  status = check_array(input.normals, 3, count, where + ".normals");
  if (!status) return status.error();
  primitive.normals.resize(input.normals.size() / 3);
  for (std::size_t i = 0; i < primitive.normals.size(); ++i) {
    const Vec3d n(input.normals[3 * i], input.normals[3 * i + 1], input.normals[3 * i + 2]);
    const double length = glm::length(n);  // in doubles: no float overflows or vanishes when squared
    primitive.normals[i] = Vec3f(length > 0.0 ? n / length : n);
  }
  for (std::size_t k = 0; k < input.uvs.size(); ++k) {
    const std::span<const float> uvs = input.uvs[k];
    status = check_array(uvs, 2, count, at(where + ".uvs", k));
    if (!status) return status.error();
    primitive.uvs[k].resize(uvs.size() / 2);
    for (std::size_t i = 0; i < primitive.uvs[k].size(); ++i) primitive.uvs[k][i] = {uvs[2 * i], uvs[2 * i + 1]};
  }
  status = check_array(input.colors, 4, count, where + ".colors");
  if (!status) return status.error();
  primitive.colors.resize(input.colors.size() / 4);
  for (std::size_t i = 0; i < primitive.colors.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      primitive.colors[i][c] = std::clamp(input.colors[4 * i + static_cast<std::size_t>(c)], 0.0F, 1.0F);
    }
  }

  if (input.indices.size() % 3 != 0) return invalid(where + ".indices", "its length is not a multiple of 3");
  primitive.indices.reserve(input.indices.size());
  for (std::size_t t = 0; t < input.indices.size(); t += 3) {
    bool is_good = true;
    for (std::size_t c = t; c < t + 3; ++c) {
      const std::uint32_t index = input.indices[c];
      if (index >= count && !repair) {
        return invalid(at(where + ".indices", c),
                       std::to_string(index) + " is out of range, there are " + std::to_string(count) + " vertices");
      }
      is_good = is_good && index < count && is_usable[index];
    }
    if (is_good)
      primitive.indices.insert(primitive.indices.end(), input.indices.begin() + static_cast<std::ptrdiff_t>(t),
                               input.indices.begin() + static_cast<std::ptrdiff_t>(t + 3));
    else
      ++repaired;
  }
  if (input.material != kDefaultMaterial && input.material >= material_count) {
    return invalid(where + ".material", std::to_string(input.material) + " does not exist");
  }
  // The default material has the last id, as import gives it.
  primitive.material = MaterialId(input.material == kDefaultMaterial ? material_count : std::size_t{input.material});
  return primitive;
}

Result<scene::SceneMaterial> make_material(const MaterialInput& input, std::size_t index) {
  const std::string where = at("materials", index);
  scene::SceneMaterial material;
  material.name = input.name;
  material.source_index = static_cast<std::uint32_t>(index);
  for (std::size_t c = 0; c < 4; ++c) {
    if (!std::isfinite(input.base_color[c])) return invalid(at(where + ".base_color", c), "is not finite");
    material.base_color[static_cast<int>(c)] = std::clamp(input.base_color[c], 0.0F, 1.0F);
  }
  switch (input.alpha_mode) {
    case format::AlphaMode::kOpaque: material.alpha_mode = scene::AlphaMode::kOpaque; break;
    case format::AlphaMode::kMask: material.alpha_mode = scene::AlphaMode::kMask; break;
    case format::AlphaMode::kBlend: material.alpha_mode = scene::AlphaMode::kBlend; break;
    default: return invalid(where + ".alpha_mode", "is not a mode");
  }
  if (!(input.alpha_cutoff >= 0.0F) || !std::isfinite(input.alpha_cutoff)) {
    return invalid(where + ".alpha_cutoff", "is not a number >= 0");
  }
  material.alpha_cutoff = input.alpha_cutoff;
  material.double_sided = input.double_sided;
  material.uv_sets_used = input.uv_sets_used;
  return material;
}

Result<scene::SceneInstance> make_instance(const InstanceInput& input, std::size_t index, std::size_t mesh_count) {
  const std::string where = at("instances", index);
  if (input.mesh >= mesh_count) return invalid(where + ".mesh", std::to_string(input.mesh) + " does not exist");
  scene::SceneInstance instance;
  instance.name = input.name;
  instance.node = static_cast<std::uint32_t>(index);
  instance.mesh = MeshId(input.mesh);
  for (std::size_t i = 0; i < 16; ++i) {
    const double value = input.transform[i];
    if (!std::isfinite(value)) return invalid(at(where + ".transform", i), "is not finite");
    if (i % 4 == 3 && value != (i == 15 ? 1.0 : 0.0))
      return invalid(where + ".transform", "its last row is not 0 0 0 1");
    instance.transform[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = value;
  }
  return instance;
}

template <class T>
void hash_span(Hasher& hasher, std::span<const T> values) {
  const std::uint64_t size = values.size();
  hasher.update({reinterpret_cast<const std::uint8_t*>(&size), sizeof size});
  hasher.update({reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()});
}

/// Of the geometry, as it was given.
std::string hash_geometry(const SceneInput& input) {
  Hasher hasher;
  for (const MeshInput& mesh : input.meshes) {
    const std::uint64_t count = mesh.primitives.size();
    hash_span(hasher, std::span(&count, 1));
    for (const PrimitiveInput& primitive : mesh.primitives) {
      hash_span(hasher, primitive.positions);
      hash_span(hasher, primitive.positions_double);
      hash_span(hasher, primitive.normals);
      for (const auto& uvs : primitive.uvs) hash_span(hasher, uvs);
      hash_span(hasher, primitive.colors);
      hash_span(hasher, primitive.indices);
      hash_span(hasher, std::span(&primitive.material, 1));
    }
  }
  return to_hex(hasher.digest());
}

}  // namespace

Result<scene::Scene> make_scene(const SceneInput& input, bool repair) {
  scene::Scene scene;
  scene.source_name = input.name;
  scene.source_hash = hash_geometry(input);
  bool needs_default_material = false;
  for (std::size_t m = 0; m < input.meshes.size(); ++m) {
    scene::SourceMesh& mesh = scene.meshes.emplace_back();
    mesh.name = input.meshes[m].name;
    const auto primitives = input.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      TRY_LET(primitive, make_primitive(primitives[p], at(at("meshes", m) + ".primitives", p), input.materials.size(),
                                        repair, mesh.drops.repaired));
      needs_default_material = needs_default_material || primitive->material.value == input.materials.size();
      mesh.primitives.push_back(std::move(*primitive));
    }
  }
  for (std::size_t i = 0; i < input.materials.size(); ++i) {
    TRY_LET(material, make_material(input.materials[i], i));
    scene.materials.push_back(std::move(*material));
  }
  if (needs_default_material) {
    scene::SceneMaterial& material = scene.materials.emplace_back();
    material.uv_sets_used = 0xF;  // nobody said what it samples: what was given is kept
  }
  for (std::size_t i = 0; i < input.instances.size(); ++i) {
    TRY_LET(instance, make_instance(input.instances[i], i, input.meshes.size()));
    scene.instances.push_back(std::move(*instance));
  }
  if (input.instances.empty()) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      scene::SceneInstance& instance = scene.instances.emplace_back();
      instance.name = scene.meshes[m].name;
      instance.node = static_cast<std::uint32_t>(m);
      instance.mesh = MeshId(m);
    }
  }
  return scene;
}

}  // namespace meshlode::builder
