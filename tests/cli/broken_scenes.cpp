// SPDX-License-Identifier: GPL-3.0-or-later
#include "broken_scenes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "lab/samples/samples.h"
#include "lab/samples/write_glb.h"
#include "lab/samples/write_png.h"

namespace meshlode::test {

namespace {

using scene::Primitive;
using scene::Scene;

constexpr std::uint32_t kCells = 20;  ///< along a side of the sphere's cube: 4800 triangles

Primitive sphere() {
  return lab::with_smooth_normals(lab::make_sphere(kCells));
}

Scene scene_of(Primitive shape) {
  return lab::as_scene(lab::as_mesh(std::move(shape)));
}

/// A vertex of its own for every corner.
Primitive unshared(const Primitive& shape) {
  Primitive out;
  for (const std::uint32_t v : shape.indices) {
    out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
    out.positions.push_back(shape.positions[v]);
    out.normals.push_back(shape.normals[v]);
  }
  return out;
}

Vec3d center_of(const Primitive& shape, std::size_t first_index) {
  const std::uint32_t* v = &shape.indices[first_index];
  return (shape.positions[v[0]] + shape.positions[v[1]] + shape.positions[v[2]]) / 3.0;
}

/// Each corner's normal halfway between the smooth one and its triangle's.
Scene with_normals_split_everywhere() {
  Primitive shape = unshared(sphere());
  const Primitive flat = lab::with_split_normals(sphere());
  for (std::size_t i = 0; i < shape.normals.size(); ++i) {
    shape.normals[i] = glm::normalize(shape.normals[i] + flat.normals[i]);
  }
  return scene_of(std::move(shape));
}

/// One half of the sphere has vertices of its own, a millionth away.
Scene with_seam() {
  Primitive shape = sphere();
  const std::size_t shared = shape.positions.size();
  std::vector<std::uint32_t> copies(shared, kNoId);
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    if (center_of(shape, i).x <= 0.0) continue;
    for (std::size_t k = i; k < i + 3; ++k) {
      const std::uint32_t v = shape.indices[k];
      if (copies[v] == kNoId) {
        copies[v] = static_cast<std::uint32_t>(shape.positions.size());
        shape.positions.push_back(shape.positions[v] + Vec3d(1e-6, 0.0, 0.0));
        shape.normals.push_back(shape.normals[v]);
      }
      shape.indices[k] = copies[v];
    }
  }
  return scene_of(std::move(shape));
}

Scene with_spike() {
  Primitive shape = lab::with_smooth_normals(lab::make_sphere(2 * kCells));
  shape.positions[shape.indices[3 * 1000]] *= 3.0;
  return scene_of(std::move(shape));
}

Scene with_islands() {
  Primitive shape = unshared(sphere());
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    shape.uvs[0].emplace_back(static_cast<float>(i), static_cast<float>(i % 3));
  }
  Scene scene = scene_of(std::move(shape));
  scene.materials[0].uv_sets_used = 1;
  return scene;
}

Scene far_away() {
  Primitive shape = sphere();
  for (Vec3d& p : shape.positions) p = Vec3d(Vec3f(p + Vec3d(100'000.0)));  // what a float keeps of it
  return scene_of(std::move(shape));
}

/// Pebbles on a plane that is a quarter of a million times as wide.
Scene with_pebbles() {
  Primitive shape = lab::make_plane(20, 1000.0);
  shape.normals.assign(shape.positions.size(), Vec3f(0.0F, 1.0F, 0.0F));
  const Primitive pebble = lab::with_smooth_normals(lab::make_sphere(4, 0.004));
  for (int i = 0; i < 3; ++i) {
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (const Vec3d& p : pebble.positions) shape.positions.push_back(p + Vec3d(i * 10.0, 1.0, i * 7.0));
    shape.normals.insert(shape.normals.end(), pebble.normals.begin(), pebble.normals.end());
    for (const std::uint32_t v : pebble.indices) shape.indices.push_back(first + v);
  }
  return scene_of(std::move(shape));
}

Scene of_small_meshes() {
  Scene scene;
  scene.materials.emplace_back();
  for (std::uint32_t i = 0; i < 40; ++i) {
    scene.meshes.push_back(lab::as_mesh(lab::make_cube(1)));
    scene::SceneInstance instance;
    instance.mesh = MeshId(i);
    scene.instances.push_back(instance);
  }
  return scene;
}

Scene with_coordinates(bool has_them, bool are_sampled) {
  Primitive shape = sphere();
  for (std::size_t i = 0; has_them && i < shape.positions.size(); ++i) {
    shape.uvs[0].emplace_back(shape.positions[i].x, shape.positions[i].y);
  }
  Scene scene = scene_of(std::move(shape));
  scene.materials[0].uv_sets_used = are_sampled ? 1 : 0;
  return scene;
}

/// Two images, of which the material samples one.
Scene with_unsampled_image() {
  Scene scene = with_coordinates(true, true);
  scene.blobs.resize(2);
  scene.blobs[0].bytes.resize(50'000);
  scene.blobs[1].bytes.resize(50'000);
  scene::TextureUse use;
  use.blob = 0;
  scene.materials[0].textures.push_back(use);
  return scene;
}

/// Fins on every fourth triangle's first edge.
Scene with_fins() {
  Primitive shape = sphere();
  const std::size_t count = shape.indices.size();
  for (std::size_t i = 0; i < count; i += 12) {
    const std::uint32_t a = shape.indices[i], b = shape.indices[i + 1];
    const auto tip = static_cast<std::uint32_t>(shape.positions.size());
    shape.positions.push_back(0.525 * (shape.positions[a] + shape.positions[b]));
    shape.normals.push_back(shape.normals[a]);
    shape.indices.insert(shape.indices.end(), {a, b, tip});
  }
  return scene_of(std::move(shape));
}

Scene with_turned_cap() {
  Primitive shape = sphere();
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    if (center_of(shape, i).y > 0.4) std::swap(shape.indices[i], shape.indices[i + 1]);
  }
  return scene_of(std::move(shape));
}

/// Triangle by triangle another one of two dozen.
Scene with_many_materials() {
  const Primitive shape = sphere();
  Scene scene = scene_of(shape);
  scene.materials.resize(24);
  std::vector<Primitive> primitives(scene.materials.size(), shape);
  for (std::uint32_t m = 0; m < primitives.size(); ++m) {
    primitives[m].material = MaterialId(m);
    primitives[m].indices.clear();
  }
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    std::vector<std::uint32_t>& indices = primitives[i / 3 % primitives.size()].indices;
    indices.insert(indices.end(), {shape.indices[i], shape.indices[i + 1], shape.indices[i + 2]});
  }
  scene.meshes[0].primitives = std::move(primitives);
  return scene;
}

Scene with_undrawn_mesh() {
  Scene scene = sound_scene();
  scene.meshes.push_back(lab::as_mesh(lab::with_smooth_normals(lab::make_torus(60, 40))));
  return scene;
}

Scene with_no_numbers() {
  Primitive shape = sphere();
  for (std::size_t v = 0; v < shape.normals.size(); v += 10) {
    shape.normals[v].x = std::numeric_limits<float>::quiet_NaN();
  }
  return scene_of(std::move(shape));
}

Scene without_triangles() {
  Primitive shape = sphere();
  shape.indices.clear();
  return scene_of(std::move(shape));
}

/// Two in 4802.
Scene with_few_missing() {
  Scene scene = sound_scene();
  scene.triangles_in_file = scene.meshes[0].primitives[0].indices.size() / 3 + 2;
  return scene;
}

}  // namespace

scene::Scene sound_scene() {
  return scene_of(sphere());
}

std::vector<std::uint8_t> as_glb(const scene::Scene& scene) {
  lab::GlbScene glb;
  const std::size_t images = std::max<std::size_t>(1, scene.blobs.size());
  for (std::size_t i = 0; i < images; ++i) {
    glb.images.push_back({"image " + std::to_string(i), lab::encode_png(lab::make_stone_texture(64))});
  }
  bool is_any_sampled = false;
  for (const scene::SceneMaterial& material : scene.materials) {
    glb.materials.emplace_back();
    if (material.uv_sets_used != 0) glb.materials.back().base_color_image = 0;
    is_any_sampled = is_any_sampled || material.uv_sets_used != 0;
  }
  if (!is_any_sampled) glb.images.clear();
  for (const scene::SourceMesh& mesh : scene.meshes) glb.meshes.push_back({mesh.name, mesh.primitives, false});
  for (const scene::SceneInstance& instance : scene.instances) {
    glb.roots.push_back(static_cast<std::uint32_t>(glb.nodes.size()));
    glb.nodes.emplace_back();
    glb.nodes.back().mesh = instance.mesh.value;
  }
  return lab::write_glb(glb);
}

std::vector<BrokenScene> broken_scenes() {
  std::vector<BrokenScene> scenes;
  const auto add = [&](const char* id, Scene scene) { scenes.push_back({id, std::move(scene)}); };
  add("nothing-to-draw", without_triangles());
  add("triangles-missing", with_few_missing());
  add("not-finite", with_no_numbers());
  add("degenerate-faces", scene_of(lab::with_smooth_normals(lab::make_zero_areas(kCells))));
  add("duplicate-faces", scene_of(lab::with_smooth_normals(lab::make_duplicates(kCells))));
  add("non-manifold-edges", with_fins());
  add("inconsistent-orientation", with_turned_cap());
  add("unwelded-seams", with_seam());
  add("needles", scene_of(lab::make_slivers(2000)));
  add("error-in-few-triangles", with_spike());
  add("far-from-origin", far_away());
  add("finer-than-grid", with_pebbles());
  add("split-normals", with_normals_split_everywhere());
  add("uv-islands", with_islands());
  add("missing-uvs", with_coordinates(false, true));
  add("unused-uvs", with_coordinates(true, false));
  add("many-materials", with_many_materials());
  add("small-meshes", of_small_meshes());
  add("undrawn-meshes", with_undrawn_mesh());
  add("unsampled-images", with_unsampled_image());
  return scenes;
}

}  // namespace meshlode::test
