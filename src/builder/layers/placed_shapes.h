// SPDX-License-Identifier: GPL-3.0-or-later
// All meshes of a scene where their instances stand, for short rays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/ids.h"
#include "base/vec.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surface_tree.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// The triangles of one mesh, primitive by primitive, and a tree over them.
struct Shape {
  std::vector<Vec3d> joined;  ///< of several primitives
  std::span<const Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint8_t> is_double_sided;  ///< per triangle; empty: none is
  std::uint32_t plain_look = kNoId;           ///< plain_look()
  std::vector<std::uint32_t> looks;           ///< the same per triangle; empty: all have plain_look
  Box3d box;
  double diagonal = 0.0;  ///< 0: there is nothing to meet, or nothing whose square is a sound double
  double per_unit = 1.0;  ///< a power of two that makes the diagonal about 1
  SurfaceTree tree;

  [[nodiscard]] bool faces_both_ways(std::uint32_t triangle) const {
    return !is_double_sided.empty() && is_double_sided[triangle] != 0;
  }
  [[nodiscard]] std::uint32_t look_of(std::uint32_t triangle) const {
    return looks.empty() ? plain_look : looks[triangle];
  }
};

/// The material of all of a mesh, where that is one colour all over: nobody sees which of its surfaces is in front of
/// another. kNoId: there are several, or textures or vertex colours.
[[nodiscard]] std::uint32_t plain_look(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials);

/// Empty for a mesh that a build refuses: an index out of range, a position that is not finite.
[[nodiscard]] Shape make_shape(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials);

/// A triangle's corners, the least of them first: the same whatever numbers they have.
[[nodiscard]] TriangleCorners canonical_corners(const Shape& shape, std::uint32_t triangle);

/// A ray to both sides of a triangle, as a segment: what it meets lies between -1 and 1 along it.
struct LayerRay {
  Vec3d from{0.0}, along{0.0};
  Vec3d facing{0.0};  ///< the normal of the triangle that it starts from, of unit length
  bool faces_both_ways = false;
  double least = 0.0;  ///< nearer than this nothing counts: the triangle itself
  std::uint32_t mesh = kNoId,
                look = kNoId;  ///< of that triangle: others of this mesh that look the same are passed over
};

struct LayerHit {
  double at = 1.0;  ///< along the ray, whichever way
  std::uint32_t mesh = kNoId, triangle = kNoId;
  double gap = 0.0;            ///< in the frame of that mesh
  bool is_from_above = false;  ///< the ray comes from the side that its normal points to
  TriangleCorners corners{};   ///< canonical, in that frame: of two in one place the lesser is met
};

struct LayerHits {
  LayerHit ahead, behind;   ///< along the ray, and against it
  bool is_crowded = false;  ///< too many triangles are near to the ray: no layers, and what was met is not all
};

class PlacedShapes {
 public:
  /// The scene outlives this. Instances of meshes in `stands_alone` meet nothing but themselves.
  PlacedShapes(const scene::Scene& scene, std::span<const std::uint8_t> stands_alone);

  [[nodiscard]] const Shape& shape(std::size_t mesh) const { return shapes_[mesh]; }
  /// How many instances of the mesh others may stand around.
  [[nodiscard]] std::size_t place_count(std::size_t mesh) const { return places_of_[mesh].size(); }

  /// The next triangles of the mesh itself that face as the ray says, where they are nearer than `hits`.
  void meet_itself(std::uint32_t mesh, const LayerRay& ray, LayerHits& hits) const;
  /// The same of all others around one instance of the mesh. The ray is in the mesh's frame.
  void meet_others(std::uint32_t mesh, std::size_t place, const LayerRay& ray, LayerHits& hits) const;

 private:
  struct Place {
    std::uint32_t mesh = 0;
    Mat3d linear{1.0}, inverse{1.0};
    Vec3d offset{0.0};
    Box3d box;  ///< in the world
  };
  void place(const scene::Scene& scene, std::span<const std::uint8_t> stands_alone);

  std::vector<Shape> shapes_;
  std::vector<Place> places_;                          ///< ordered by where they are
  std::vector<std::vector<std::uint32_t>> places_of_;  ///< by mesh
  std::vector<Vec3d> corners_;                         ///< of the places' boxes
  std::vector<std::array<std::uint32_t, 3>> boxes_;    ///< a triangle whose box is the place's
  SurfaceTree world_;                                  ///< over boxes_
};

}  // namespace meshlode::builder
