// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/samples/write_glb.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/json_writer.h"
#include "lab/samples/binary_chunk.h"

namespace meshlode::lab {

using namespace scene;

namespace {

struct PrimitiveAccessors {
  std::uint32_t indices = 0, position = 0;
  std::optional<std::uint32_t> normal, uv;
  std::uint32_t material = 0;
};

void number_array(JsonWriter& json, const char* name, const auto& numbers) {
  json.key(name);
  json.begin_array();
  for (const auto number : numbers) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(number)>>) {
      json.value(static_cast<double>(number));
    } else {
      json.value(number);
    }
  }
  json.end_array();
}

void write_materials(JsonWriter& json, const GlbScene& scene) {
  json.key("materials");
  json.begin_array();
  for (const GlbMaterial& material : scene.materials) {
    json.begin_object();
    json.field("name", material.name);
    json.key("pbrMetallicRoughness");
    json.begin_object();
    number_array(
        json, "baseColorFactor",
        std::array{material.base_color.x, material.base_color.y, material.base_color.z, material.base_color.w});
    json.field("metallicFactor", material.metallic);
    json.field("roughnessFactor", material.roughness);
    if (material.base_color_image) {
      json.key("baseColorTexture");
      json.begin_object();
      json.field("index", *material.base_color_image);  // textures are one to one with images
      json.end_object();
    }
    json.end_object();
    if (material.is_masked) {
      json.field("alphaMode", "MASK");
      json.field("alphaCutoff", 0.5);
    }
    if (material.double_sided) json.field("doubleSided", true);
    json.end_object();
  }
  json.end_array();
}

void write_images(JsonWriter& json, const GlbScene& scene, const std::vector<std::uint32_t>& image_views) {
  if (scene.images.empty()) return;
  json.key("images");
  json.begin_array();
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    json.begin_object();
    json.field("name", scene.images[i].name);
    json.field("mimeType", "image/png");
    json.field("bufferView", image_views[i]);
    json.end_object();
  }
  json.end_array();
  json.key("samplers");
  json.begin_array();
  json.begin_object();
  json.field("magFilter", 9729);
  json.field("minFilter", 9987);
  json.end_object();
  json.end_array();
  json.key("textures");
  json.begin_array();
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    json.begin_object();
    json.field("sampler", 0);
    json.field("source", i);
    json.end_object();
  }
  json.end_array();
}

void write_meshes(JsonWriter& json, const GlbScene& scene, const std::vector<std::vector<PrimitiveAccessors>>& meshes) {
  json.key("meshes");
  json.begin_array();
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    json.begin_object();
    json.field("name", scene.meshes[m].name);
    json.key("primitives");
    json.begin_array();
    for (const PrimitiveAccessors& primitive : meshes[m]) {
      json.begin_object();
      json.key("attributes");
      json.begin_object();
      json.field("POSITION", primitive.position);
      if (primitive.normal) json.field("NORMAL", *primitive.normal);
      if (primitive.uv) json.field("TEXCOORD_0", *primitive.uv);
      json.end_object();
      json.field("indices", primitive.indices);
      json.field("material", primitive.material);
      json.end_object();
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
}

void write_nodes(JsonWriter& json, const GlbScene& scene, const std::vector<Dequantization>& dequantizations) {
  // A quantized mesh hangs on an added child, because the node's own scale may be animated or not uniform.
  std::vector<std::uint32_t> added;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh && scene.meshes[*scene.nodes[n].mesh].quantize) added.push_back(n);
  }
  json.key("nodes");
  json.begin_array();
  std::uint32_t next_added = static_cast<std::uint32_t>(scene.nodes.size());
  for (const GlbNode& node : scene.nodes) {
    json.begin_object();
    json.field("name", node.name);
    std::vector<std::uint32_t> children = node.children;
    if (node.mesh && scene.meshes[*node.mesh].quantize) {
      children.push_back(next_added++);
    } else if (node.mesh) {
      json.field("mesh", *node.mesh);
    }
    if (node.camera) json.field("camera", *node.camera);
    if (node.matrix) number_array(json, "matrix", *node.matrix);
    if (node.translation) number_array(json, "translation", *node.translation);
    if (node.rotation) number_array(json, "rotation", *node.rotation);
    if (node.scale) number_array(json, "scale", *node.scale);
    if (node.has_light) json.key("extensions"), json.raw(R"({"KHR_lights_punctual": {"light": 0}})");
    if (!children.empty()) number_array(json, "children", children);
    json.end_object();
  }
  for (const std::uint32_t n : added) {
    const std::uint32_t mesh = *scene.nodes[n].mesh;
    const Dequantization& dq = dequantizations[mesh];
    json.begin_object();
    json.field("name", scene.nodes[n].name + " (quantized)");
    json.field("mesh", mesh);
    number_array(json, "translation", std::array{dq.center.x, dq.center.y, dq.center.z});
    number_array(json, "scale", std::array{dq.scale, dq.scale, dq.scale});
    json.end_object();
  }
  json.end_array();
}

void write_cameras(JsonWriter& json, const GlbScene& scene) {
  if (scene.cameras.empty()) return;
  json.key("cameras");
  json.begin_array();
  for (const GlbCamera& camera : scene.cameras) {
    json.begin_object();
    json.field("name", camera.name);
    json.field("type", camera.is_orthographic ? "orthographic" : "perspective");
    json.key(camera.is_orthographic ? "orthographic" : "perspective");
    json.begin_object();
    if (camera.is_orthographic) {
      json.field("xmag", camera.size * 16.0 / 9.0);
      json.field("ymag", camera.size);
    } else {
      json.field("yfov", camera.size);
    }
    json.field("znear", camera.near_distance);
    json.field("zfar", camera.far_distance);
    json.end_object();
    json.end_object();
  }
  json.end_array();
}

void write_animation(JsonWriter& json, BinaryChunk& chunk, const GlbScene& scene) {
  if (!scene.animation) return;
  const GlbAnimation& animation = *scene.animation;
  Accessor times{0, kFloat, animation.times.size(), "SCALAR", false, {}, {}};
  chunk.begin_view(0, 0);
  for (const float t : animation.times) {
    chunk.put(t);
    const auto wide = static_cast<double>(t);
    widen(times, &wide, 1);
  }
  times.view = chunk.end_view();
  const std::uint32_t input = chunk.add_accessor(times);
  chunk.begin_view(0, 0);
  for (const auto& rotation : animation.rotations) {
    for (const float c : rotation) chunk.put(c);
  }
  const std::uint32_t output =
      chunk.add_accessor({chunk.end_view(), kFloat, animation.rotations.size(), "VEC4", false, {}, {}});
  json.key("animations");
  json.begin_array();
  json.begin_object();
  json.field("name", animation.name);
  json.key("samplers");
  json.begin_array();
  json.begin_object();
  json.field("input", input);
  json.field("output", output);
  json.field("interpolation", "LINEAR");
  json.end_object();
  json.end_array();
  json.key("channels");
  json.begin_array();
  json.begin_object();
  json.field("sampler", 0);
  json.key("target");
  json.begin_object();
  json.field("node", animation.node);
  json.field("path", "rotation");
  json.end_object();
  json.end_object();
  json.end_array();
  json.end_object();
  json.end_array();
}

void write_chunk_tables(JsonWriter& json, const BinaryChunk& chunk) {
  json.key("accessors");
  json.begin_array();
  for (const Accessor& accessor : chunk.accessors) {
    json.begin_object();
    json.field("bufferView", accessor.view);
    json.field("componentType", accessor.component);
    if (accessor.normalized) json.field("normalized", true);
    json.field("count", accessor.count);
    json.field("type", accessor.type);
    if (!accessor.low.empty()) {
      number_array(json, "min", accessor.low);
      number_array(json, "max", accessor.high);
    }
    json.end_object();
  }
  json.end_array();
  json.key("bufferViews");
  json.begin_array();
  for (const BufferView& view : chunk.views) {
    json.begin_object();
    json.field("buffer", 0);
    json.field("byteOffset", view.offset);
    json.field("byteLength", view.bytes);
    if (view.stride != 0) json.field("byteStride", view.stride);
    if (view.target != 0) json.field("target", view.target);
    json.end_object();
  }
  json.end_array();
  json.key("buffers");
  json.begin_array();
  json.begin_object();
  json.field("byteLength", chunk.bytes.size());
  json.end_object();
  json.end_array();
}

void write_extensions(JsonWriter& json, const GlbScene& scene) {
  const bool has_light = std::ranges::any_of(scene.nodes, [](const GlbNode& node) { return node.has_light; });
  const bool has_quantized = std::ranges::any_of(scene.meshes, [](const GlbMesh& mesh) { return mesh.quantize; });
  if (!has_light && !has_quantized) return;
  json.key("extensionsUsed");
  json.begin_array();
  if (has_light) json.value("KHR_lights_punctual");
  if (has_quantized) json.value("KHR_mesh_quantization");
  json.end_array();
  if (has_quantized) json.key("extensionsRequired"), json.raw(R"(["KHR_mesh_quantization"])");
  if (has_light) {
    json.key("extensions");
    json.raw(R"({"KHR_lights_punctual": {"lights": [{"name": "sun", "type": "directional", "intensity": 3}]}})");
  }
}

std::vector<std::uint8_t> join_chunks(std::string json, BinaryChunk& chunk) {
  while (json.size() % 4 != 0) json.push_back(' ');
  BinaryChunk file;
  file.put(std::uint32_t{0x46546C67});  // "glTF"
  file.put(std::uint32_t{2});
  file.put(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + chunk.bytes.size()));
  file.put(static_cast<std::uint32_t>(json.size()));
  file.put(std::uint32_t{0x4E4F534A});  // "JSON"
  file.bytes.insert(file.bytes.end(), json.begin(), json.end());
  file.put(static_cast<std::uint32_t>(chunk.bytes.size()));
  file.put(std::uint32_t{0x004E4942});  // "BIN"
  file.bytes.insert(file.bytes.end(), chunk.bytes.begin(), chunk.bytes.end());
  return std::move(file.bytes);
}

}  // namespace

void add_object(GlbScene& scene, const std::string& name, Primitive shape, GlbMaterial material) {
  material.name = name;
  shape.material = MaterialId(scene.materials.size());
  scene.materials.push_back(std::move(material));
  GlbMesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(shape));
  GlbNode node;
  node.name = name;
  node.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
  scene.roots.push_back(static_cast<std::uint32_t>(scene.nodes.size()));
  scene.nodes.push_back(std::move(node));
}

std::vector<std::uint8_t> write_glb(const GlbScene& scene) {
  BinaryChunk chunk;
  std::vector<std::vector<PrimitiveAccessors>> meshes;
  std::vector<Dequantization> dequantizations;
  for (const GlbMesh& mesh : scene.meshes) {
    const Dequantization& dq = dequantizations.emplace_back(dequantization_of(mesh));
    std::vector<PrimitiveAccessors>& primitives = meshes.emplace_back();
    for (const Primitive& primitive : mesh.primitives) {
      PrimitiveAccessors accessors;
      accessors.indices = write_indices(chunk, primitive);
      accessors.position = write_positions(chunk, primitive, mesh.quantize, dq);
      if (!primitive.normals.empty()) accessors.normal = write_normals(chunk, primitive, mesh.quantize);
      if (!primitive.uvs[0].empty()) accessors.uv = write_uvs(chunk, primitive, mesh.quantize);
      accessors.material = primitive.material.value;
      primitives.push_back(accessors);
    }
  }
  std::vector<std::uint32_t> image_views;
  for (const GlbImage& image : scene.images) {
    chunk.begin_view(0, 0);
    chunk.bytes.insert(chunk.bytes.end(), image.png.begin(), image.png.end());
    image_views.push_back(chunk.end_view());
  }

  JsonWriter json;
  json.begin_object();
  json.key("asset");
  json.raw(R"({"version": "2.0", "generator": "meshlode samples"})");
  write_extensions(json, scene);
  json.field("scene", 0);
  json.key("scenes");
  json.begin_array();
  json.begin_object();
  json.field("name", scene.name);
  number_array(json, "nodes", scene.roots);
  json.end_object();
  json.end_array();
  write_nodes(json, scene, dequantizations);
  write_meshes(json, scene, meshes);
  write_materials(json, scene);
  write_images(json, scene, image_views);
  write_cameras(json, scene);
  write_animation(json, chunk, scene);
  chunk.pad(4);
  write_chunk_tables(json, chunk);
  json.end_object();
  return join_chunks(json.text(), chunk);
}

}  // namespace meshlode::lab
