// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/drift_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/box.h"
#include "judge/metrics/seams.h"

namespace meshlode::judge {
namespace {

constexpr double kDegrees = 57.295779513082321;
constexpr float kSameNormal = 1e-3F;  // length of the difference of unit normals that is no crease
constexpr float kSameUv = 1e-6F;

double range_of(const Field& field) {
  if (field.is_normal) return 180.0;
  Box3d box;
  for (const Vec3f& value : field.values) {
    if (is_known(Vec3d(value))) box.add(Vec3d(value));
  }
  const double range = glm::length(box.size());
  return range > 0.0 && std::isfinite(range) ? range : 1.0;
}

std::vector<float> vertex_slopes(const Field& field) {
  std::vector<float> slopes(field.surface->positions.size(), 0.0F);
  for (std::uint32_t t = 0; t < field.surface->triangles.size(); ++t) {
    const auto slope = static_cast<float>(slope_of(field, t));
    for (const std::uint32_t v : field.surface->triangles[t]) slopes[v] = std::max(slopes[v], slope);
  }
  return slopes;
}

Field make_field(const Surface& surface, std::vector<Vec3f> values, bool is_normal) {
  Field field;
  field.surface = &surface;
  field.values = std::move(values);
  field.is_normal = is_normal;
  field.slopes = vertex_slopes(field);
  field.range = range_of(field);
  field.seams = find_seams(surface, field.values, is_normal ? kSameNormal : kSameUv);
  field.seam_surface.positions = surface.positions;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    if (field.seams[t] == 0) continue;
    field.seam_surface.triangles.push_back(surface.triangles[t]);
    field.seam_triangle.push_back(t);
  }
  if (!field.seam_triangle.empty()) field.seam_tree.emplace(field.seam_surface);
  return field;
}

std::vector<Vec3f> unit_normals(const std::vector<Vec3f>& normals) {
  std::vector<Vec3f> out(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) out[i] = normals[i] / glm::length(normals[i]);
  return out;
}

std::vector<Vec3f> lifted(const std::vector<Vec2f>& uvs) {
  std::vector<Vec3f> out(uvs.size());
  for (std::size_t i = 0; i < uvs.size(); ++i) out[i] = Vec3f(uvs[i], 0.0F);
  return out;
}

ClosestPoint closest_on_edge(const Vec3d& p, const Vec3d& a, const Vec3d& b, double& along) {
  const Vec3d d = b - a;
  const double dd = glm::dot(d, d);
  along = dd > 0.0 ? std::clamp(glm::dot(p - a, d) / dd, 0.0, 1.0) : 0.0;
  return {a + d * along, 0.0, 0.0, 0};
}

}  // namespace

Fields make_fields(const ShadedSurface& s) {
  Fields fields;
  if (!s.normals.empty()) fields[0].emplace(make_field(s.surface, unit_normals(s.normals), true));
  for (std::size_t n = 0; n < scene::kMaxUvSets; ++n) {
    if (!s.uvs[n].empty()) fields[1 + n].emplace(make_field(s.surface, lifted(s.uvs[n]), false));
  }
  return fields;
}

bool is_known(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Vec3d value_at(const Field& field, std::uint32_t triangle, double u, double v) {
  const auto& t = field.surface->triangles[triangle];
  const Vec3d value =
      Vec3d(field.values[t[0]]) * (1.0 - u - v) + Vec3d(field.values[t[1]]) * u + Vec3d(field.values[t[2]]) * v;
  return field.is_normal ? glm::normalize(value) : value;
}

double difference(const Field& field, const Vec3d& a, const Vec3d& b) {
  if (!field.is_normal) return glm::length(a - b);
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * kDegrees;
}

double slope_of(const Field& field, std::uint32_t triangle) {
  const auto& t = field.surface->triangles[triangle];
  const std::vector<Vec3d>& p = field.surface->positions;
  const Vec3d e0 = p[t[1]] - p[t[0]], e1 = p[t[2]] - p[t[0]];
  const Vec3d d0 = Vec3d(field.values[t[1]]) - Vec3d(field.values[t[0]]);
  const Vec3d d1 = Vec3d(field.values[t[2]]) - Vec3d(field.values[t[0]]);
  const double g00 = glm::dot(e0, e0), g01 = glm::dot(e0, e1), g11 = glm::dot(e1, e1);
  const double det = g00 * g11 - g01 * g01;
  if (!(det > 1e-12 * g00 * g11)) return 0.0;  // a needle: no slide is explained by it
  const double sum = (glm::dot(d0, d0) * g11 - 2.0 * glm::dot(d0, d1) * g01 + glm::dot(d1, d1) * g00) / det;
  return std::sqrt(std::max(0.0, sum));
}

ClosestPoint closest_on_triangle(const Vec3d& p, const Surface& s, std::uint32_t triangle) {
  const auto& t = s.triangles[triangle];
  const Vec3d a = s.positions[t[0]], ab = s.positions[t[1]] - a, ac = s.positions[t[2]] - a, ap = p - a;
  const double g00 = glm::dot(ab, ab), g01 = glm::dot(ab, ac), g11 = glm::dot(ac, ac);
  const double det = g00 * g11 - g01 * g01;
  if (det > 1e-14 * g00 * g11) {
    const double h0 = glm::dot(ap, ab), h1 = glm::dot(ap, ac);
    const double u = (g11 * h0 - g01 * h1) / det, v = (g00 * h1 - g01 * h0) / det;
    if (u > 0.0 && v > 0.0 && u + v < 1.0) return {a + ab * u + ac * v, u, v, 0};
  }
  ClosestPoint best;
  double best2 = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < 3; ++k) {
    double along = 0.0;
    ClosestPoint c = closest_on_edge(p, s.positions[t[k]], s.positions[t[(k + 1) % 3]], along);
    const double d2 = glm::dot(c.point - p, c.point - p);
    if (d2 > best2) continue;
    double weights[3] = {};
    weights[k] = 1.0 - along;
    weights[(k + 1) % 3] = along;
    c.u = weights[1];
    c.v = weights[2];
    c.edges = static_cast<std::uint8_t>(1U << k);
    if (along == 0.0) c.edges = static_cast<std::uint8_t>(c.edges | (1U << ((k + 2) % 3)));
    if (along == 1.0) c.edges = static_cast<std::uint8_t>(c.edges | (1U << ((k + 1) % 3)));
    if (d2 < best2) best = c;
    best2 = d2;
  }
  return best;
}

}  // namespace meshlode::judge
