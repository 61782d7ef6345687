// SPDX-License-Identifier: GPL-3.0-or-later
// The files of data/.
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "lab/samples/city.h"
#include "lab/samples/samples.h"
#include "lab/samples/write_glb.h"
#include "lab/samples/write_png.h"

namespace meshlode::lab {

using namespace scene;

namespace {

/// One mesh, one material, one node.
GlbScene scene_of(const char* name, Primitive shape, GlbMaterial material) {
  GlbScene scene;
  scene.name = name;
  add_object(scene, name, std::move(shape), std::move(material));
  return scene;
}

GlbScene textured_scene_of(const char* name, Primitive shape, GlbMaterial material, const Texture& texture) {
  material.base_color_image = 0u;
  GlbScene scene = scene_of(name, std::move(shape), std::move(material));
  scene.images.push_back({name, encode_png(texture)});
  return scene;
}

GlbScene make_rock_scene() {
  return textured_scene_of("rock", make_rock(41), {}, make_stone_texture(128));
}

GlbScene make_terrain_scene(std::uint32_t columns, std::uint32_t rows) {
  return textured_scene_of("terrain", make_terrain(columns, rows), {}, make_ground_texture(128));
}

GlbScene make_crystal_scene() {
  GlbMaterial material;
  material.base_color = {0.45F, 0.62F, 0.85F, 1.0F};
  material.roughness = 0.2;
  return scene_of("crystal", make_crystal(9, 8), material);
}

GlbScene make_foliage_scene() {
  GlbMaterial material;
  material.is_masked = true;
  material.double_sided = true;
  GlbScene scene = textured_scene_of("foliage", make_foliage(4000), material, make_leaf_texture(64));
  scene.meshes[0].quantize = true;
  return scene;
}

struct NamedScene {
  const char* name;
  GlbScene (*make)();
};

constexpr std::array<NamedScene, 5> kScenes{{
    {"rock.glb", make_rock_scene},
    {"terrain.glb", [] { return make_terrain_scene(142, 142); }},
    {"crystal.glb", make_crystal_scene},
    {"foliage.glb", make_foliage_scene},
    {"city.glb", [] { return make_city(); }},
}};

}  // namespace

std::vector<std::string> sample_names() {
  std::vector<std::string> names;
  names.reserve(kScenes.size());
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

SampleFile make_sample_file(const std::string& name) {
  for (const NamedScene& scene : kScenes) {
    if (name == scene.name) return {name, write_glb(scene.make())};
  }
  assert(false && "the name of a sample");
  return {};
}

std::vector<std::string> aggregate_names() {
  std::vector<std::string> names{"tree", "grass", "soup"};
  for (std::string& kind : aggregate_kinds()) names.push_back(std::move(kind));
  return names;
}

SampleFile make_aggregate_file(const std::string& name) {
  GlbMaterial material;
  if (name == "tree") {
    material.is_masked = material.double_sided = true;
    return {"tree.glb", write_glb(textured_scene_of("tree", make_crown(40000), material, make_leaf_texture(64)))};
  }
  const bool is_soup = name == "soup";
  material.base_color = is_soup ? Vec4f{0.5F, 0.45F, 0.4F, 1.0F} : Vec4f{0.2F, 0.4F, 0.1F, 1.0F};
  material.double_sided = !is_soup;
  Primitive shape = is_soup           ? make_box_soup(20000)
                    : name == "grass" ? make_grass(20000)
                                      : make_aggregate_kind(name, 10000);
  return {name + ".glb", write_glb(scene_of(name.c_str(), std::move(shape), material))};
}

SampleFile make_painted_tree_file(std::uint32_t around, std::uint32_t leaves) {
  GlbScene scene = textured_scene_of("painted-tree", make_tree_wood(around), {}, make_bark_texture(256));
  scene.meshes[0].primitives.push_back(make_tree_leaves(leaves));
  scene.meshes[0].primitives.back().material = MaterialId(1u);
  GlbMaterial leaf;
  leaf.name = "leaf";
  leaf.is_masked = leaf.double_sided = true;
  leaf.base_color_image = 1u;
  scene.materials.push_back(std::move(leaf));
  scene.images.push_back({"leaf", encode_png(make_leaf_texture(64))});
  return {"painted-tree.glb", write_glb(scene)};
}

SampleFile make_terrain_file(std::uint64_t triangles) {
  assert(triangles >= 2 && triangles <= 100'000'000);
  const auto side = static_cast<std::uint32_t>(std::floor(std::sqrt(static_cast<double>(triangles) / 2.0) + 0.5));
  const std::uint32_t cells = side < 1 ? 1 : side;
  return {"terrain-" + std::to_string(triangles) + ".glb", write_glb(make_terrain_scene(cells, cells))};
}

}  // namespace meshlode::lab
