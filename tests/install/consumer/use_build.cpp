// SPDX-License-Identifier: GPL-3.0-or-later
// A stranger's builder: one triangle in memory becomes an asset.
#include <cstdint>
#include <cstdio>

#include <meshlode/build.h>

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t indices[] = {0, 1, 2};
  meshlode::PrimitiveInput primitive;
  primitive.positions = positions;
  primitive.indices = indices;
  meshlode::MeshInput mesh;
  mesh.name = "triangle";
  mesh.primitives = {&primitive, 1};
  meshlode::SceneInput scene;
  scene.name = "consumer";
  scene.meshes = {&mesh, 1};
  const meshlode::Status status = meshlode::build_asset_file(scene, argv[1], {});
  if (!status) std::puts(status.error().message().c_str());
  return status ? 0 : 1;
}
