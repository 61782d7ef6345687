// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of PLY, OBJ and STL ask of a scene.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "gltf_builder.h"

namespace meshlode::testing {

class PolygonFiles : public ::testing::Test {
 protected:
  Result<scene::Scene> read(const std::string& name, const std::string& bytes,
                            const scene::ImportOptions& options = {}) {
    return scene::import_scene(folder_.write(name, bytes), options);
  }
  static const scene::Primitive& primitive(const Result<scene::Scene>& scene) {
    return scene.value().meshes[0].primitives[0];
  }
  TempFolder folder_;
};

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

inline std::size_t triangle_count(const scene::Scene& scene) {
  std::size_t count = 0;
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& p : mesh.primitives) count += p.indices.size() / 3;
  }
  return count;
}

inline double area(const scene::Scene& scene) {
  double sum = 0.0;
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& p : mesh.primitives) {
      for (std::size_t t = 0; t < p.indices.size(); t += 3) {
        const Vec3d& a = p.positions[p.indices[t]];
        sum += glm::length(glm::cross(p.positions[p.indices[t + 1]] - a, p.positions[p.indices[t + 2]] - a)) / 2.0;
      }
    }
  }
  return sum;
}

/// "what: why; " of each.
inline std::string all_left_out(const scene::Scene& scene) {
  std::string out;
  for (const scene::LeftOut& item : scene.left_out) out += item.what + ": " + item.why + "; ";
  return out;
}

}  // namespace meshlode::testing
