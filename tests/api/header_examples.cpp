// SPDX-License-Identifier: GPL-3.0-or-later
// The examples at the top of runtime.h and build.h, so that they compile; example_test.cpp compares them line by line.
#include <cstdio>

#include <meshlode/build.h>
#include <meshlode/runtime.h>

int use_runtime(void (*draw)(const meshlode::DrawItem&));
int use_build(std::span<const float> positions, std::span<const std::uint32_t> indices);

int use_runtime(void (*draw)(const meshlode::DrawItem&)) {
  // clang-format off
  const auto asset = meshlode::AssetFile::open("scene.lode");
  if (!asset) { puts(asset.error().message().c_str()); return 1; }
  const auto items = asset->select_view({.eye = {0, 1, 5}}, 1.0);
  if (!items) { puts(items.error().message().c_str()); return 1; }
  for (const meshlode::DrawItem& item : *items) draw(item);
  // clang-format on
  return 0;
}

int use_build(std::span<const float> positions, std::span<const std::uint32_t> indices) {
  // clang-format off
  meshlode::PrimitiveInput primitive;
  primitive.positions = positions;
  primitive.indices = indices;
  meshlode::MeshInput mesh;
  mesh.primitives = {&primitive, 1};
  meshlode::SceneInput scene;
  scene.meshes = {&mesh, 1};
  const auto bytes = meshlode::build_asset(scene, {});
  if (!bytes) puts(bytes.error().message().c_str());
  // clang-format on
  return bytes ? 0 : 1;
}
