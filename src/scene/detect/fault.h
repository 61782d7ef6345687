// SPDX-License-Identifier: GPL-3.0-or-later
// What a detector finds: how often, which triangles, and what it is thought to cost. Words are somebody else's.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/enum_names.h"
#include "base/ids.h"

namespace meshlode::scene {

/// One fault of a source. What `Fault::count` counts and what `Fault::measure` is stands behind each.
enum class FaultKind : std::uint8_t {
  kNothingToDraw,    ///< 1 where no mesh has a triangle with area; triangles that the file plainly holds
  kMissing,          ///< triangles that the file plainly holds and the scene has not; those that it holds
  kNotFinite,        ///< vertices with an infinity or a NaN, and corners without a vertex
  kDegenerate,       ///< triangles without area
  kDuplicate,        ///< triangles on the points of an earlier one; those of them that face the other way
  kNonManifold,      ///< edges of more than two triangles; the most triangles of one
  kMisoriented,      ///< edges whose two triangles run along them in one direction
  kUnweldedSeam,     ///< points of borders that are nearly another one; the widest gap, object units
  kNeedles,          ///< triangles much longer than high; the largest ratio
  kErrorInFew,       ///< triangles; the share of the error that they hold
  kFarFromOrigin,    ///< vertices; the step of floats at the farthest coordinate, object units
  kFinerThanGrid,    ///< triangles; the step of the position grid that they vanish on, object units
  kSplitNormals,     ///< wedges that a normal made and no angle justifies; points
  kUvIslands,        ///< pieces of the worst used UV set; pieces of the surface itself
  kMissingUvs,       ///< primitives whose material samples a UV set that they have not
  kUnusedUvs,        ///< UV sets of primitives that their material does not sample
  kManyMaterials,    ///< materials of one mesh; triangles at edges between two of them
  kSmallMeshes,      ///< meshes of one cluster; how often they are drawn
  kUndrawnMeshes,    ///< meshes that no node draws; their triangles
  kUnsampledImages,  ///< images that no material samples
};

/// Stable: what `--fail-on` names.
inline constexpr std::array<EnumName<FaultKind>, 20> kFaultNames{{
    {FaultKind::kNothingToDraw, "nothing-to-draw"},
    {FaultKind::kMissing, "triangles-missing"},
    {FaultKind::kNotFinite, "not-finite"},
    {FaultKind::kDegenerate, "degenerate-faces"},
    {FaultKind::kDuplicate, "duplicate-faces"},
    {FaultKind::kNonManifold, "non-manifold-edges"},
    {FaultKind::kMisoriented, "inconsistent-orientation"},
    {FaultKind::kUnweldedSeam, "unwelded-seams"},
    {FaultKind::kNeedles, "needles"},
    {FaultKind::kErrorInFew, "error-in-few-triangles"},
    {FaultKind::kFarFromOrigin, "far-from-origin"},
    {FaultKind::kFinerThanGrid, "finer-than-grid"},
    {FaultKind::kSplitNormals, "split-normals"},
    {FaultKind::kUvIslands, "uv-islands"},
    {FaultKind::kMissingUvs, "missing-uvs"},
    {FaultKind::kUnusedUvs, "unused-uvs"},
    {FaultKind::kManyMaterials, "many-materials"},
    {FaultKind::kSmallMeshes, "small-meshes"},
    {FaultKind::kUndrawnMeshes, "undrawn-meshes"},
    {FaultKind::kUnsampledImages, "unsampled-images"},
}};
constexpr const char* name_of(FaultKind kind) {
  return name_in(kFaultNames, kind);
}

enum class CostKind : std::uint8_t { kBytes, kAccuracy, kTime };
inline constexpr std::array<EnumName<CostKind>, 3> kCostNames{
    {{CostKind::kBytes, "bytes"}, {CostKind::kAccuracy, "accuracy"}, {CostKind::kTime, "time"}}};
constexpr const char* name_of(CostKind kind) {
  return name_in(kCostNames, kind);
}

enum class CostUnit : std::uint8_t {
  kAssetBytes,   ///< of the asset, estimated (kBytesPerTriangle, kBytesPerWedge), of images exact
  kSourceBytes,  ///< of the source alone: a build leaves them out
  kObjectUnits,  ///< a distance in the mesh's own space
  kTriangles,    ///< that look wrong, or that are simplified or drawn in vain
};
inline constexpr std::array<EnumName<CostUnit>, 4> kUnitNames{{{CostUnit::kAssetBytes, "asset bytes"},
                                                               {CostUnit::kSourceBytes, "source bytes"},
                                                               {CostUnit::kObjectUnits, "object units"},
                                                               {CostUnit::kTriangles, "triangles"}}};
constexpr const char* name_of(CostUnit unit) {
  return name_in(kUnitNames, unit);
}

/// Of an asset, all levels and tables together: what a triangle of a textured surface takes (README.md, rock), and what
/// one vertex more does. Round figures: they rank, they do not predict (`plan` does).
constexpr double kBytesPerTriangle = 15.0;
constexpr double kBytesPerWedge = 12.0;

struct FaultCost {
  CostKind kind = CostKind::kTime;
  CostUnit unit = CostUnit::kTriangles;
  double amount = 0.0;  ///< in `unit`
  double share = 0.0;   ///< of what the mesh (or of a fault of the scene: the scene) has of it, 0 … 1, estimated
};

/// A triangle of a mesh: indices 3 · triangle … of a primitive.
struct FaultTriangle {
  std::uint32_t primitive = 0, triangle = 0;
  constexpr auto operator<=>(const FaultTriangle&) const = default;
};

/// Of what most sources have a little of, one in so many and more are a fault.
constexpr std::uint64_t kOneInAHundred = 100;

constexpr std::size_t kMaxListedTriangles = 16;
constexpr std::size_t kMaxListedMeshes = 16;

struct Fault {
  FaultKind kind = FaultKind::kNotFinite;
  std::uint32_t mesh = kNoId;        ///< kNoId: of the scene
  std::uint64_t count = 0;           ///< 0: nothing was found
  std::uint64_t triangle_count = 0;  ///< triangles concerned
  double measure = 0.0;
  std::vector<FaultTriangle> triangles;  ///< the first of those concerned in the order of the file, or the worst first
  std::vector<std::uint32_t> meshes;     ///< of a fault of the scene: the first of those concerned
  std::vector<FaultCost> costs;          ///< of what examine_mesh() and examine_scene() return, the largest share first
};

/// Nothing found yet.
[[nodiscard]] inline Fault fault_of(FaultKind kind) {
  Fault fault;
  fault.kind = kind;
  return fault;
}

}  // namespace meshlode::scene
