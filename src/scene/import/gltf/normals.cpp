// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace meshlode::scene {

std::size_t mend_normals(Primitive& primitive) {
  std::vector<std::uint32_t> bad;
  for (std::size_t i = 0; i < primitive.normals.size(); ++i) {
    const Vec3d n(primitive.normals[i]);
    const double length = n.x * n.x + n.y * n.y + n.z * n.z;
    if (!(length > 0.0) || !std::isfinite(length)) bad.push_back(static_cast<std::uint32_t>(i));
  }
  if (bad.empty()) return 0;
  std::vector<Vec3d> sums(bad.size(), Vec3d(0.0));
  std::vector<bool> is_named(bad.size(), false);
  for (std::size_t t = 0; t < primitive.indices.size(); t += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto slot = std::lower_bound(bad.begin(), bad.end(), primitive.indices[t + c]);
      if (slot == bad.end() || *slot != primitive.indices[t + c]) continue;
      const Vec3d& p = primitive.positions[primitive.indices[t]];
      is_named[static_cast<std::size_t>(slot - bad.begin())] = true;
      sums[static_cast<std::size_t>(slot - bad.begin())] += glm::cross(
          primitive.positions[primitive.indices[t + 1]] - p, primitive.positions[primitive.indices[t + 2]] - p);
    }
  }
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const Vec3d& s = sums[i];
    const double largest = std::max({std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
    Vec3d n(0.0, 0.0, 1.0);
    if (largest > 0.0 && std::isfinite(largest)) {
      n = s / largest;  // so that squares neither overflow nor vanish
      n /= std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    }
    primitive.normals[bad[i]] = Vec3f(n);
  }
  return static_cast<std::size_t>(std::count(is_named.begin(), is_named.end(), true));
}

}  // namespace meshlode::scene
