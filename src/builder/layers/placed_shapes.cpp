// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/layers/placed_shapes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "base/ids.h"
#include "base/parallel.h"

namespace meshlode::builder {

namespace {

/// Surfaces face the same way where their normals are less than 60 degrees apart.
constexpr double kSameFacing = 0.5;

/// Others than these many around a ray are left out: heaps of instances in one place take no longer for it.
constexpr int kMostNeighbours = 64;

/// Near one ray. FlightHelmet, city and crystal are the same with and without this limit, to the byte. Where 20,000
/// triangles join random points of a lattice thousands are near to each ray, and looking at all of them took two
/// minutes.
constexpr int kMostTested = 512;

/// Larger and smaller ones are passed over: squares of differences are sound doubles.
constexpr double kLargest = 0x1p500, kSmallest = 0x1p-500;

bool is_sound(const Vec3d& v) {
  return std::abs(v.x) < kLargest && std::abs(v.y) < kLargest && std::abs(v.z) < kLargest;  // and no NaN
}

bool is_less(const Vec3d& a, const Vec3d& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

bool is_less(const TriangleCorners& a, const TriangleCorners& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](const Vec3d& p, const Vec3d& q) { return is_less(p, q); });
}

std::uint32_t look_of(const scene::Primitive& primitive, std::span<const scene::SceneMaterial> materials) {
  if (!primitive.colors.empty() || primitive.material.value >= materials.size()) return kNoId;
  const scene::SceneMaterial& material = materials[primitive.material.value];
  return material.textures.empty() && material.uv_sets_used == 0 ? primitive.material.value : kNoId;
}

void add_primitives(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials, Shape& shape) {
  const bool is_one = mesh.primitives.size() == 1;
  bool any_double_sided = false;
  shape.plain_look = plain_look(mesh, materials);
  for (const scene::Primitive& primitive : mesh.primitives) {
    const auto first = static_cast<std::uint32_t>(shape.joined.size());
    if (!is_one) shape.joined.insert(shape.joined.end(), primitive.positions.begin(), primitive.positions.end());
    const bool is_double_sided =
        primitive.material.value < materials.size() && materials[primitive.material.value].double_sided;
    any_double_sided |= is_double_sided && !primitive.indices.empty();
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const std::uint32_t* at = &primitive.indices[i];
      shape.triangles.push_back({first + at[0], first + at[1], first + at[2]});
    }
    shape.is_double_sided.resize(shape.triangles.size(), is_double_sided ? 1 : 0);
    if (shape.plain_look == kNoId) shape.looks.resize(shape.triangles.size(), look_of(primitive, materials));
  }
  if (!any_double_sided) shape.is_double_sided = {};
  shape.positions =
      is_one ? std::span<const Vec3d>(mesh.primitives[0].positions) : std::span<const Vec3d>(shape.joined);
}

/// Where the ray meets the triangle, in units of the ray, either way; 1: nowhere. (Moeller and Trumbore 1997.) All
/// lengths are multiplied by `per_unit` first. `facing`: in the triangle's frame, so that its product with the
/// triangle's normal is that in the ray's own; `back` takes that normal there.
double meet(const TriangleCorners& corners, const LayerRay& ray, bool both_ways, double per_unit, const Mat3d* back) {
  const Vec3d a = (corners[0] - ray.from) * per_unit;
  const Vec3d e = (corners[1] - corners[0]) * per_unit, f = (corners[2] - corners[0]) * per_unit;
  const Vec3d along = ray.along * per_unit;
  const Vec3d p = glm::cross(along, f);
  const double det = glm::dot(e, p);
  if (!(std::abs(det) > 0.0)) return 1.0;
  const double u = -glm::dot(a, p) / det;
  if (!(u >= 0.0 && u <= 1.0)) return 1.0;
  const Vec3d q = glm::cross(-a, e);
  const double v = glm::dot(along, q) / det;
  if (!(v >= 0.0 && u + v <= 1.0)) return 1.0;
  const double at = glm::dot(f, q) / det;
  if (!(std::abs(at) > ray.least && std::abs(at) < 1.0)) return 1.0;
  const Vec3d normal = back != nullptr ? *back * glm::cross(e, f) : glm::cross(e, f);
  const double length = std::sqrt(glm::dot(normal, normal)), cosine = glm::dot(normal, ray.facing);
  const double same = both_ways ? std::abs(cosine) : cosine;
  return same > kSameFacing * length ? at : 1.0;
}

/// `ray` is in the shape's frame, but for its facing, which `back` takes normals of the shape to.
void meet_shape(const Shape& shape, std::uint32_t mesh, const LayerRay& ray, const Mat3d* back, LayerHits& hits) {
  int tested = 0;
  shape.tree.visit_along(ray.from - ray.along, ray.from + ray.along, [&](TreeSlot slot) {
    hits.is_crowded = ++tested > kMostTested;
    if (hits.is_crowded) return false;
    const std::uint32_t triangle = shape.tree.triangle_at(slot);
    if (mesh == ray.mesh && ray.look != kNoId && shape.look_of(triangle) == ray.look) return true;
    const bool both_ways = ray.faces_both_ways || shape.faces_both_ways(triangle);
    const TriangleCorners corners = canonical_corners(shape, triangle);
    const double along_ray = meet(corners, ray, both_ways, shape.per_unit, back), at = std::abs(along_ray);
    LayerHit& hit = along_ray < 0.0 ? hits.behind : hits.ahead;
    if (!(at < hit.at) && !(at == hit.at && at < 1.0 && is_less(corners, hit.corners))) return true;
    const Vec3d along = ray.along * (along_ray < 0.0 ? -shape.per_unit : shape.per_unit);
    const Vec3d e = (corners[1] - corners[0]) * shape.per_unit, f = (corners[2] - corners[0]) * shape.per_unit;
    const double gap = at * std::sqrt(glm::dot(along, along)) / shape.per_unit;
    hit = {at, mesh, triangle, gap, glm::dot(along, glm::cross(e, f)) < 0.0, corners};
    return true;
  });
}

}  // namespace

TriangleCorners canonical_corners(const Shape& shape, std::uint32_t triangle) {
  const auto& [a, b, c] = shape.triangles[triangle];
  TriangleCorners corners{shape.positions[a], shape.positions[b], shape.positions[c]};
  std::rotate(
      corners.begin(),
      std::min_element(corners.begin(), corners.end(), [](const Vec3d& p, const Vec3d& q) { return is_less(p, q); }),
      corners.end());
  return corners;
}

std::uint32_t plain_look(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials) {
  std::optional<std::uint32_t> only;
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.indices.empty()) continue;
    const std::uint32_t look = look_of(primitive, materials);
    if (only && *only != look) return kNoId;
    only = look;
  }
  return only.value_or(kNoId);
}

Shape make_shape(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials) {
  Shape shape;
  add_primitives(mesh, materials, shape);
  for (const auto& triangle : shape.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= shape.positions.size() || !is_sound(shape.positions[v])) return {};  // refused later, by its name
      shape.box.add(shape.positions[v]);
    }
  }
  if (shape.triangles.empty()) return {};
  const Vec3d half = shape.box.high * 0.5 - shape.box.low * 0.5;
  const double diagonal = 2.0 * std::sqrt(glm::dot(half, half));
  if (!(diagonal > kSmallest)) return {};
  int exponent = 0;
  (void)std::frexp(diagonal, &exponent);
  shape.per_unit = std::ldexp(1.0, -exponent);
  shape.diagonal = diagonal;
  shape.tree.build({shape.positions, shape.triangles}, SurfaceTree::Leaves::kMade, SurfaceTree::Capsules::kLater);
  return shape;
}

PlacedShapes::PlacedShapes(const scene::Scene& scene, std::span<const std::uint8_t> stands_alone) {
  shapes_.resize(scene.meshes.size());
  places_of_.resize(scene.meshes.size());
  parallel_for_each_index(shapes_.size(), 1,
                          [&](std::size_t i) { shapes_[i] = make_shape(scene.meshes[i], scene.materials); });
  place(scene, stands_alone);
}

void PlacedShapes::place(const scene::Scene& scene, std::span<const std::uint8_t> stands_alone) {
  for (const scene::SceneInstance& instance : scene.instances) {
    const Shape& shape = shapes_[instance.mesh.value];
    if (shape.diagonal == 0.0 || stands_alone[instance.mesh.value] != 0) continue;
    Place place;
    place.mesh = instance.mesh.value;
    place.linear = Mat3d(instance.transform);
    place.offset = Vec3d(instance.transform[3]);
    const double det = glm::determinant(place.linear);
    if (!std::isfinite(det) || det == 0.0) continue;
    place.inverse = glm::inverse(place.linear);
    for (const Vec3d& corner : shape.box.corners()) place.box.add(place.linear * corner + place.offset);
    if (is_sound(place.box.low) && is_sound(place.box.high) && is_sound(place.inverse[0]) &&
        is_sound(place.inverse[1]) && is_sound(place.inverse[2])) {
      places_.push_back(place);
    }
  }
  if (places_.size() < 2) return;
  // By where they are, whatever numbers the file gave to meshes and nodes.
  const auto key = [](const Place& p) {
    const auto& [low, high] = p.box;
    return std::tuple(low.x, low.y, low.z, high.x, high.y, high.z);
  };
  std::stable_sort(places_.begin(), places_.end(), [&](const Place& a, const Place& b) { return key(a) < key(b); });
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    places_of_[places_[i].mesh].push_back(i);
    const auto first = static_cast<std::uint32_t>(corners_.size());
    corners_.insert(corners_.end(), {places_[i].box.low, places_[i].box.high});
    boxes_.push_back({first, first + 1, first});
  }
  world_.build({corners_, boxes_}, SurfaceTree::Leaves::kMade, SurfaceTree::Capsules::kLater);
}

void PlacedShapes::meet_itself(std::uint32_t mesh, const LayerRay& ray, LayerHits& hits) const {
  if (shapes_[mesh].plain_look != kNoId) return;
  meet_shape(shapes_[mesh], mesh, ray, nullptr, hits);
}

void PlacedShapes::meet_others(std::uint32_t mesh, std::size_t place, const LayerRay& ray, LayerHits& hits) const {
  const std::uint32_t own = places_of_[mesh][place];
  const Place& here = places_[own];
  const Vec3d from = here.linear * ray.from + here.offset, along = here.linear * ray.along;
  Box3d around;
  around.add(from - along);
  around.add(from + along);
  int neighbours = 0;
  world_.visit_along(from - along, from + along, [&](TreeSlot slot) {
    const std::uint32_t other = world_.triangle_at(slot);
    const Place& there = places_[other];
    if (other == own || !around.is_within(there.box, 0.0)) return true;
    if (there.mesh == mesh && shapes_[mesh].plain_look != kNoId) return true;
    if (++neighbours > kMostNeighbours) return false;
    LayerRay moved = ray;
    moved.from = there.inverse * (from - there.offset);
    moved.along = there.inverse * along;
    if (!is_sound(moved.from) || !is_sound(moved.along)) return true;
    // A normal comes back by the transposed way there: the cofactors of the way back, but for a factor that is positive
    // where both are mirrored or neither is, and where one is, so is its facing.
    const Mat3d back = glm::transpose(there.inverse * here.linear);
    meet_shape(shapes_[there.mesh], there.mesh, moved, &back, hits);
    return !hits.is_crowded;
  });
}

}  // namespace meshlode::builder
