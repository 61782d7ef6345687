// SPDX-License-Identifier: GPL-3.0-or-later
// A small GLB writer for the samples. It shares nothing with src/app/export, so that one can be tested with the other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace meshlode::lab {

struct GlbMaterial {
  std::string name;
  Vec4f base_color{1.0F, 1.0F, 1.0F, 1.0F};
  double metallic = 0.0, roughness = 0.9;
  std::optional<std::uint32_t> base_color_image;
  bool is_masked = false;
  bool double_sided = false;
};

struct GlbImage {
  std::string name;
  std::vector<std::uint8_t> png;
};

/// Primitive::material indexes GlbScene::materials.
struct GlbMesh {
  std::string name;
  std::vector<scene::Primitive> primitives;
  /// Writes positions as 16-bit integers, normals as 8-bit and UVs as 16-bit (KHR_mesh_quantization). Nodes then draw
  /// it through a child that scales it back. UVs must be in [0, 1].
  bool quantize = false;
};

struct GlbNode {
  std::string name;
  std::vector<std::uint32_t> children;
  std::optional<std::uint32_t> mesh, camera;
  bool has_light = false;                        ///< the scene's one directional light
  std::optional<std::array<double, 16>> matrix;  ///< column-major; else translation, rotation, scale
  std::optional<std::array<double, 3>> translation, scale;
  std::optional<std::array<double, 4>> rotation;  ///< x y z w, unit
};

struct GlbCamera {
  std::string name;
  bool is_orthographic = false;
  double size = 0.8;  ///< vertical field of view in radians, or half the height
  double near_distance = 0.1, far_distance = 1000.0;
};

/// A rotation over time of one node, linear between keys.
struct GlbAnimation {
  std::string name;
  std::uint32_t node = 0;
  std::vector<float> times;
  std::vector<std::array<float, 4>> rotations;
};

struct GlbScene {
  std::string name;
  std::vector<GlbMaterial> materials;
  std::vector<GlbImage> images;
  std::vector<GlbMesh> meshes;
  std::vector<GlbNode> nodes;
  std::vector<std::uint32_t> roots;
  std::vector<GlbCamera> cameras;
  std::optional<GlbAnimation> animation;
};

/// Adds a mesh of one primitive with its material and its node, all of one name, as a root.
void add_object(GlbScene& scene, const std::string& name, scene::Primitive shape, GlbMaterial material);

[[nodiscard]] std::vector<std::uint8_t> write_glb(const GlbScene& scene);

}  // namespace meshlode::lab
