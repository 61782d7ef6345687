// SPDX-License-Identifier: GPL-3.0-or-later
// A sample shape as the plain arrays that a user of the API has.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <meshlode/build.h>

#include "format/names.h"
#include "lab/samples/samples.h"
#include "support/old_codecs/old_codecs.h"

namespace meshlode::test {

struct Arrays {
  std::vector<double> exact;
  std::vector<float> positions;
  std::vector<float> normals;
  std::vector<float> uvs;
  std::vector<std::uint32_t> indices;

  explicit Arrays(const scene::Primitive& shape) : indices(shape.indices) {
    for (const Vec3d& p : shape.positions) {
      for (int c = 0; c < 3; ++c) {
        exact.push_back(p[c]);
        positions.push_back(static_cast<float>(p[c]));
      }
    }
    for (const Vec3f& n : shape.normals) normals.insert(normals.end(), {n.x, n.y, n.z});
    for (const Vec2f& uv : shape.uvs[0]) uvs.insert(uvs.end(), {uv.x, uv.y});
  }
  [[nodiscard]] PrimitiveInput primitive() const {
    PrimitiveInput input;
    input.positions = positions;
    input.normals = normals;
    input.uvs[0] = uvs;
    input.indices = indices;
    return input;
  }
};

/// One primitive as a whole scene.
inline Result<std::vector<std::uint8_t>> build_one(const PrimitiveInput& primitive, const BuildOptions& options = {}) {
  MeshInput mesh;
  mesh.name = "one";
  mesh.primitives = {&primitive, 1};
  SceneInput scene;
  scene.meshes = {&mesh, 1};
  return build_asset(scene, options);
}

/// A plain asset by a codec that is not written any more; as it is where `codec` is one that is. Empty where it fails.
inline std::vector<std::uint8_t> stored_as(std::vector<std::uint8_t> bytes, format::Codec codec) {
  if (format::is_written(codec)) return bytes;
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset) return {};
  auto stored = stored_by(*asset, codec, std::string(asset->meta_json()));
  return stored ? std::move(*stored) : std::vector<std::uint8_t>{};
}

}  // namespace meshlode::test
