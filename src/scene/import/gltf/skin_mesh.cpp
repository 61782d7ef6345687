// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/skin_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/box.h"
#include "scene/import/gltf/normals.h"

namespace meshlode::scene {

namespace {

struct Influence {
  std::uint32_t joint = 0;
  double weight = 1.0;
};

/// Those of a vertex that mean something, their weights as they are; where none does, its first joint alone.
/// \returns whether some mean nothing. \pre joint_count > 0
bool find_influences(const VertexWeights& weights, std::size_t vertex, std::size_t joint_count,
                     std::vector<Influence>& out) {
  out.clear();
  bool has_bad = false;
  const std::size_t first = vertex * weights.width;
  for (std::size_t i = first; i < first + weights.width; ++i) {
    const double weight = weights.weights[i];
    if (weight == 0.0) continue;
    if (weight > 0.0 && std::isfinite(weight) && weights.joints[i] < joint_count) {
      out.push_back({weights.joints[i], weight});
    } else {
      has_bad = true;
    }
  }
  if (!out.empty()) return has_bad;
  const std::uint32_t joint = weights.width > 0 ? weights.joints[first] : 0;
  out.push_back({joint < joint_count ? joint : 0, 1.0});
  return true;
}

Mat4d blend(const std::vector<Influence>& influences, const std::vector<Mat4d>& matrices) {
  double sum = 0.0;
  for (const Influence& each : influences) sum += each.weight;
  Mat4d out(0.0);
  for (const Influence& each : influences) {
    const double weight = each.weight / sum;
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 3; ++r) out[c][r] += weight * matrices[each.joint][c][r];
    }
  }
  out[3][3] = 1.0;
  return out;
}

Vec3d moved(const Mat4d& m, const Vec3d& p) {
  Vec3d out;
  for (int r = 0; r < 3; ++r) out[r] = m[0][r] * p.x + m[1][r] * p.y + m[2][r] * p.z + m[3][r];
  return out;
}

/// The cofactors of the left 3 x 3 part: the inverse transpose times the determinant.
struct NormalMatrix {
  explicit NormalMatrix(const Mat4d& m) {
    const Vec3d x(m[0]), y(m[1]), z(m[2]);
    columns[0] = glm::cross(y, z);
    columns[1] = glm::cross(z, x);
    columns[2] = glm::cross(x, y);
    is_mirror = glm::dot(x, columns[0]) < 0.0;
  }
  [[nodiscard]] Vec3f turned(const Vec3f& normal) const {
    Vec3d n = columns[0] * static_cast<double>(normal.x) + columns[1] * static_cast<double>(normal.y) +
              columns[2] * static_cast<double>(normal.z);
    if (is_mirror) n = -n;
    const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
    if (!(largest > 0.0) || !std::isfinite(largest)) return Vec3f(0.0F);
    n /= largest;
    return Vec3f(n / std::sqrt(glm::dot(n, n)));
  }
  Vec3d columns[3];
  bool is_mirror = false;
};

/// Whether both put every point of the box into one place, up to rounding.
bool agree(const Mat4d& a, const Mat4d& b, const Box3d& box) {
  const auto& [low, high] = box;
  constexpr double kRounding = 1e-6;
  double far = 0.0, size = 0.0;
  for (int r = 0; r < 3; ++r) {
    double least = a[3][r] - b[3][r], most = least, reach = std::fabs(a[3][r]);
    for (int c = 0; c < 3; ++c) {
      const double d = a[c][r] - b[c][r];
      least += std::min(d * low[c], d * high[c]);
      most += std::max(d * low[c], d * high[c]);
      reach += std::fabs(a[c][r]) * std::max(std::fabs(low[c]), std::fabs(high[c]));
    }
    far = std::max({far, std::fabs(least), std::fabs(most)});
    size = std::max(size, reach);
  }
  return far <= kRounding * size;
}

}  // namespace

Mat4d affine_matrix(const std::uint8_t* floats) {
  Mat4d out(0.0);
  for (int c = 0; floats != nullptr && c < 4; ++c) {
    for (int r = 0; r < 3; ++r) {
      float value = 0.0F;
      std::memcpy(&value, floats + sizeof(float) * static_cast<std::size_t>(4 * c + r), sizeof value);
      out[c][r] = static_cast<double>(value);
    }
  }
  out[3][3] = 1.0;
  return out;
}

bool is_finite(const Mat4d& matrix) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(matrix[c][r])) return false;
    }
  }
  return true;
}

MeshJoints find_joints(const SourceMesh& mesh, const std::vector<VertexWeights>& weights, std::size_t joint_count) {
  MeshJoints out;
  for (const VertexWeights& each : weights) out.has_weights = out.has_weights || each.width > 0;
  if (!out.has_weights || joint_count == 0) return out;
  std::vector<bool> is_used(joint_count, false);
  std::vector<Influence> influences;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    std::vector<bool> is_seen(primitive.positions.size(), false);
    for (const std::uint32_t v : primitive.indices) {
      if (is_seen[v]) continue;
      is_seen[v] = true;
      if (find_influences(weights[p], v, joint_count, influences)) {
        ++(weights[p].width == 0 ? out.unweighted_vertices : out.bad_vertices);
      }
      for (const Influence& each : influences) is_used[each.joint] = true;
      out.box.add(primitive.positions[v]);
    }
  }
  for (std::uint32_t j = 0; j < joint_count; ++j) {
    if (is_used[j]) out.used.push_back(j);
  }
  return out;
}

std::optional<Mat4d> common_matrix(const MeshJoints& joints, const std::vector<Mat4d>& matrices) {
  if (joints.used.empty()) return Mat4d(1.0);
  for (const Mat4d& candidate : {Mat4d(1.0), matrices[joints.used.front()]}) {
    const bool is_common = std::all_of(joints.used.begin(), joints.used.end(),
                                       [&](std::uint32_t j) { return agree(matrices[j], candidate, joints.box); });
    if (is_common) return candidate;
  }
  return std::nullopt;
}

bool bake_mesh(SourceMesh& mesh, const std::vector<VertexWeights>& weights, const std::vector<Mat4d>& matrices) {
  std::vector<Influence> influences;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    Primitive& primitive = mesh.primitives[p];
    std::vector<bool> is_mirrored(primitive.positions.size(), false);
    std::vector<bool> is_named(primitive.positions.size(), false);
    for (const std::uint32_t v : primitive.indices) is_named[v] = true;
    for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
      if (!is_named[v]) continue;
      find_influences(weights[p], v, matrices.size(), influences);
      const Mat4d matrix = blend(influences, matrices);
      const NormalMatrix turn(matrix);
      primitive.positions[v] = moved(matrix, primitive.positions[v]);
      const Vec3d& to = primitive.positions[v];
      if (!std::isfinite(to.x) || !std::isfinite(to.y) || !std::isfinite(to.z)) return false;
      if (!primitive.normals.empty()) primitive.normals[v] = turn.turned(primitive.normals[v]);
      is_mirrored[v] = turn.is_mirror;
    }
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
      std::uint32_t* corners = &primitive.indices[t];
      if (is_mirrored[corners[0]] && is_mirrored[corners[1]] && is_mirrored[corners[2]]) {
        std::swap(corners[1], corners[2]);
      }
    }
    mend_normals(primitive);
  }
  return true;
}

}  // namespace meshlode::scene
