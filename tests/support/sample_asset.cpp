// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/sample_asset.h"

#include <cstdio>
#include <cstdlib>

#include "builder/promise/measure_promise.h"
#include "builder/write/write.h"
#include "format/names.h"
#include "run/read/asset.h"
#include "support/old_codecs/old_codecs.h"

namespace meshlode::test {

namespace {

/// A sample that cannot be made is a broken test program, not a failed expectation.
template <class T>
T value_or_abort(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "sample asset: %s\n", result.error().message().c_str());
    std::abort();
  }
  return std::move(*result);
}

builder::PreparedMesh empty_mesh() {
  builder::PreparedMesh mesh;
  mesh.name = "empty";
  mesh.source_triangles = 1;
  mesh.source_vertices = 3;
  mesh.dropped_degenerate = 1;
  return mesh;
}

scene::SourceMesh empty_source() {
  scene::SourceMesh mesh;
  mesh.name = "empty";
  scene::Primitive primitive;
  primitive.positions.assign(3, Vec3d(0.0));
  primitive.indices = {0, 1, 2};
  primitive.material = MaterialId{0U};
  mesh.primitives.push_back(primitive);
  return mesh;
}

std::vector<scene::SceneMaterial> sample_materials() {
  scene::SceneMaterial first;
  first.name = "stone";
  first.source_index = 0;
  first.base_color = {0.8F, 0.7F, 0.6F, 1.0F};
  first.base_color_texture = 0;
  first.base_color_uv_set = 0;
  first.uv_sets_used = 1;
  scene::SceneMaterial second;
  second.name = "leaf";
  second.source_index = 1;
  second.alpha_mode = scene::AlphaMode::kMask;
  second.alpha_cutoff = 0.25F;
  second.double_sided = true;
  return {first, second};
}

scene::SceneInstance make_instance(const char* name, std::uint32_t node, std::uint32_t mesh, const Vec3d& scale,
                                   const Vec3d& move) {
  scene::SceneInstance instance;
  instance.name = name;
  instance.node = node;
  instance.mesh = MeshId{mesh};
  for (int i = 0; i < 3; ++i) {
    instance.transform[i][i] = scale[i];
    instance.transform[3][i] = move[i];
  }
  return instance;
}

}  // namespace

scene::Scene sample_scene() {
  scene::Scene scene;
  scene.source_name = "sample.glb";
  scene.source_hash = "00000000000000000000000000000000";
  scene.meshes = {sample_patch().source, sample_sphere().source, sample_tetrahedron().source, empty_source()};
  scene.materials = sample_materials();
  scene.instances = {make_instance("ground", 0, 0, {1.0, 1.0, 1.0}, {-100.0, 20.0, -3.0}),
                     make_instance("ball", 1, 1, {1.0, 1.0, 1.0}, {0.0, 0.0, 6.0}),
                     make_instance("mirrored ball", 2, 1, {-2.0, 2.0, 2.0}, {4.0, 0.0, 8.0}),
                     make_instance("flattened ball", 3, 1, {1.0, 1.0, 0.0}, {0.0, 4.0, 8.0}),
                     make_instance("far away", 4, 2, {1.0, 1.0, 1.0}, {-1e6, -1e6, -1e6})};
  scene::SceneBlob image;
  image.name = "stone.png";
  image.mime_type = "image/png";
  image.bytes = {0x89, 'P', 'N', 'G', 1, 2, 3};
  scene::SceneBlob buffer;
  buffer.kind = scene::SceneBlob::Kind::kBuffer;
  buffer.name = "stone.png";  // the same string on purpose: stored once
  buffer.mime_type = "application/octet-stream";
  buffer.bytes = {9, 8, 7, 6};
  scene.blobs = {image, buffer};
  scene.document = R"({"asset":{"version":"2.0"},"images":[{"blob":0}],"textures":[{"source":0}]})";
  return scene;
}

std::vector<std::uint8_t> sample_asset_bytes(format::Codec codec) {
  return sample_asset_bytes(sample_scene(), codec);
}

void add_promises(builder::WriteInput& input) {
  input.has_page_hints = true;
  input.promises = format::kPromisesTexels | format::kPromisesAppearance;
  for (builder::EncodedMesh& mesh : input.meshes) {
    builder::PromiseErrors errors = builder::promises_of_positions(mesh.record, mesh.groups, input.promises);
    if (mesh.record.normal_mode != format::NormalMode::kNone) errors.mesh.normal_object = 0.25F;
    for (std::uint32_t set = 0; set < mesh.record.uv_set_count; ++set) {
      errors.mesh.uv_object[set][0] = 2.0F;
      errors.mesh.uv_object[set][1] = 0.5F;
    }
    mesh.promise = errors.mesh;
    mesh.promise_errors = std::move(errors.groups);
  }
}

namespace {

builder::WriteInput sample_input(const scene::Scene& scene) {
  builder::WriteInput input;
  for (const SampleMesh& sample : {sample_patch(), sample_sphere(), sample_tetrahedron()}) {
    input.meshes.push_back(value_or_abort(builder::encode_mesh(sample.mesh, sample.dag, sample.hierarchy, {})));
    input.mesh_names.push_back(sample.mesh.name);
  }
  input.meshes.push_back(value_or_abort(builder::encode_mesh(empty_mesh(), {}, {}, {})));
  input.mesh_names.emplace_back("empty");
  input.scene = &scene;
  input.meta_json = R"({"source":{"file":"sample.glb"},"settings":{}})";
  return input;
}

}  // namespace

std::vector<std::uint8_t> write_by(builder::WriteInput input, format::Codec codec) {
  input.codec = format::is_written(codec) ? codec : format::Codec::kNone;
  std::vector<std::uint8_t> bytes = value_or_abort(builder::write_asset(std::move(input)));
  if (format::is_written(codec)) return bytes;
  const run::Asset asset = value_or_abort(run::Asset::from_bytes(bytes));
  return value_or_abort(stored_by(asset, codec, std::string(asset.meta_json())));
}

std::vector<std::uint8_t> sample_asset_bytes(const scene::Scene& scene, format::Codec codec) {
  return write_by(sample_input(scene), codec);
}

std::vector<std::uint8_t> promised_asset_bytes(format::Codec codec) {
  const scene::Scene scene = sample_scene();
  builder::WriteInput input = sample_input(scene);
  add_promises(input);
  return write_by(std::move(input), codec);
}

std::vector<std::uint8_t> asset_bytes_of(const SampleMesh& sample, format::Codec codec,
                                         const builder::EncodeOptions& options) {
  scene::Scene scene;
  scene.meshes = {sample.source};
  scene.materials = sample_materials();
  scene.instances = {make_instance("one", 0, 0, {1.0, 1.0, 1.0}, {0.0, 0.0, 0.0})};
  builder::WriteInput input;
  input.meshes.push_back(value_or_abort(builder::encode_mesh(sample.mesh, sample.dag, sample.hierarchy, options)));
  input.mesh_names.push_back(sample.mesh.name);
  input.scene = &scene;
  input.meta_json = "{}";
  return write_by(std::move(input), codec);
}

}  // namespace meshlode::test
