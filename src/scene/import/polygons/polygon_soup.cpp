// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/polygon_soup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "scene/import/gltf/normals.h"
#include "scene/import/polygons/face_triangles.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

bool is_stored_exactly(const Vec3d& p) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::fabs(p.x) <= kMax && std::fabs(p.y) <= kMax && std::fabs(p.z) <= kMax;  // false for NaN
}

/// The triangles of `corners` with the vertices that they name, in order.
Primitive part_of(const Primitive& whole, std::vector<std::uint32_t> corners) {
  std::vector<std::uint32_t> used = corners;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(used.size());
    for (const std::uint32_t v : used) to.push_back(from[v]);
  };
  Primitive out;
  gather(whole.positions, out.positions);
  gather(whole.normals, out.normals);
  gather(whole.uvs[0], out.uvs[0]);
  gather(whole.colors, out.colors);
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
  }
  out.indices = std::move(corners);
  return out;
}

MaterialId material_id(std::uint32_t material) {
  return material == kNoId ? MaterialId() : MaterialId(std::size_t{material});
}

/// What the triangles of one primitive have in common, in the order of the meshes and their primitives.
struct PartKey {
  std::uint32_t object = kNoId, material = kNoId;
  std::uint8_t traits = kHasAll;

  /// What is in no object comes first, what has no material and what lacks attributes last.
  [[nodiscard]] auto order() const { return std::tuple(object + 1, material, static_cast<int>(kHasAll) - traits); }
  bool operator<(const PartKey& other) const { return order() < other.order(); }
};

using Parts = std::map<PartKey, std::vector<std::uint32_t>>;  // corners of triangles

void drop_what_is_not_of_all(Primitive& part, const PartKey& key) {
  if ((key.traits & kHasUvs) == 0) part.uvs[0].clear();
  if ((key.traits & kHasNormals) == 0) part.normals.clear();
  if ((key.traits & kHasColors) == 0) part.colors.clear();
  part.material = material_id(key.material);
}

/// A mesh for each object, a primitive for each of the rest of the key.
std::vector<PolygonMesh> split(Primitive whole, Parts parts, bool is_compacted) {
  std::vector<PolygonMesh> out;
  if (parts.empty()) parts[PartKey{}];
  const bool is_one = parts.size() == 1;
  for (auto& [key, corners] : parts) {
    if (out.empty() || out.back().object != key.object) out.push_back({key.object, {}});
    Primitive part;
    if (is_one && !is_compacted) {
      whole.indices = std::move(corners);
      part = std::move(whole);
    } else {
      part = part_of(whole, std::move(corners));
    }
    drop_what_is_not_of_all(part, key);
    out.back().primitives.push_back(std::move(part));
  }
  return out;
}

/// Counts those that a triangle names.
template <class Vec>
std::size_t replace_broken(std::vector<Vec>& values, int components, const Vec& stand_in,
                           const std::vector<bool>& is_named) {
  std::size_t bad = 0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    bool is_finite = true;
    for (int c = 0; c < components; ++c) is_finite = is_finite && std::isfinite(values[v][c]);
    if (is_finite) continue;
    values[v] = stand_in;
    bad += is_named[v] ? 1U : 0U;
  }
  return bad;
}

/// Broken attributes get something in their place, which is said once for all meshes.
void replace_all_broken(std::vector<PolygonMesh>& meshes, std::vector<LeftOut>& left_out) {
  std::uint64_t normals = 0, uvs = 0, colors = 0, clamped = 0;
  for (PolygonMesh& mesh : meshes) {
    for (Primitive& part : mesh.primitives) {
      std::vector<bool> is_named(part.positions.size(), false);
      for (const std::uint32_t v : part.indices) is_named[v] = true;
      normals += mend_normals(part);
      uvs += replace_broken(part.uvs[0], 2, Vec2f(0.0F), is_named);
      colors += replace_broken(part.colors, 4, Vec4f(1.0F), is_named);
      for (Vec4f& color : part.colors) {
        const Vec4f inside = glm::clamp(color, Vec4f(0.0F), Vec4f(1.0F));
        if (inside != color) ++clamped;
        color = inside;
      }
    }
  }
  if (normals != 0) {
    left_out.push_back({"normals", std::to_string(normals) +
                                       " are not finite or have no length; the triangles' own stand in for them"});
  }
  if (uvs != 0) {
    left_out.push_back({"texture coordinates", std::to_string(uvs) + " are not finite; zero stands in for them"});
  }
  if (colors != 0) {
    left_out.push_back({"colours", std::to_string(colors) + " are not finite; white stands in for them"});
  }
  if (clamped != 0) left_out.push_back({"colours", std::to_string(clamped) + " are clamped to 0 … 1"});
}

PartKey key_of(const PolygonSoup& soup, std::size_t polygon) {
  PartKey key;
  if (!soup.polygon_objects.empty()) key.object = soup.polygon_objects[polygon];
  if (!soup.polygon_materials.empty()) key.material = soup.polygon_materials[polygon];
  if (!soup.polygon_traits.empty()) key.traits = soup.polygon_traits[polygon];
  return key;
}

}  // namespace

Result<std::vector<PolygonMesh>> triangulate(PolygonSoup soup, const ImportOptions& options, ImportDrops& drops,
                                             std::vector<LeftOut>& left_out) {
  const bool needs_compaction = !std::all_of(soup.positions.begin(), soup.positions.end(), is_stored_exactly);
  std::uint32_t bad = kNoId;  // the first that a polygon names
  for (std::size_t c = 0; needs_compaction && c < soup.corners.size(); ++c) {
    if (!is_stored_exactly(soup.positions[soup.corners[c]])) bad = std::min(bad, soup.corners[c]);
  }
  if (bad != kNoId && !options.repair) {
    return Error{ErrorCode::kInvalid, "vertex " + std::to_string(bad),
                 "its position is not finite, or beyond what a float can hold"};
  }
  if (needs_compaction && bad == kNoId) {
    const auto count = std::count_if(soup.positions.begin(), soup.positions.end(),
                                     [](const Vec3d& p) { return !is_stored_exactly(p); });
    left_out.push_back({counted(static_cast<std::uint64_t>(count), "vertex", "vertices"),
                        "no face names them, and their positions are not finite or beyond what a float can hold"});
  }
  Parts parts;
  FaceTriangles faces(soup.positions);
  PartKey known;
  std::vector<std::uint32_t>* list = nullptr;  // of `known`: neighbours in the file mostly go together
  std::size_t first = 0;
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    const std::uint32_t size = soup.polygon_sizes[p];
    const std::span<const std::uint32_t> polygon(soup.corners.data() + first, size);
    first += size;
    const bool is_whole = !needs_compaction || std::all_of(polygon.begin(), polygon.end(), [&](std::uint32_t v) {
      return is_stored_exactly(soup.positions[v]);
    });
    if (!is_whole) {
      drops.repaired += size - 2;
      continue;
    }
    const PartKey key = key_of(soup, p);
    if (list == nullptr || key < known || known < key) {
      list = &parts[key];
      known = key;
    }
    faces.append(polygon, *list);
  }
  faces.report(left_out);
  Primitive out;
  out.positions = std::move(soup.positions);
  out.normals = std::move(soup.normals);
  out.uvs[0] = std::move(soup.uvs);
  out.colors = std::move(soup.colors);
  std::vector<PolygonMesh> meshes = split(std::move(out), std::move(parts), needs_compaction);
  replace_all_broken(meshes, left_out);
  return meshes;
}

}  // namespace meshlode::scene
