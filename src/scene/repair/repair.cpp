// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/repair/repair.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "scene/repair/orient_soup.h"

namespace meshlode::scene {

namespace {

/// The same for squares of such counts, summed: 16 points of the most triangles, which is seconds. Points of as many as
/// any sound mesh has are not counted.
constexpr std::uint64_t kMaxOrientationWork = std::uint64_t{1} << 32U;
constexpr std::uint32_t kFewTriangles = 64;

struct VertexId {
  std::uint32_t primitive = 0, vertex = 0;
};

/// Where the vertices of a mesh are: equal numbers for equal positions (0 and -0 are equal), in no order that matters.
struct Points {
  std::vector<std::vector<std::uint32_t>> of;  ///< by primitive and vertex
  std::uint32_t count = 0;
};

Points find_points(const SourceMesh& mesh) {
  Points points;
  std::vector<VertexId> order;
  for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    const auto size = static_cast<std::uint32_t>(mesh.primitives[p].positions.size());
    points.of.emplace_back(size);
    for (std::uint32_t v = 0; v < size; ++v) order.push_back({p, v});
  }
  const auto position = [&](VertexId id) -> const Vec3d& { return mesh.primitives[id.primitive].positions[id.vertex]; };
  const auto key = [&](VertexId id) {
    const Vec3d& at = position(id);
    return std::tuple(at.x, at.y, at.z, id.primitive, id.vertex);
  };
  std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || position(order[i]) != position(order[i - 1])) ++points.count;
    points.of[order[i].primitive][order[i].vertex] = points.count - 1;
  }
  return points;
}

/// The triangles of all primitives, one after the other.
struct Faces {
  std::vector<SoupTriangle> points;
  std::vector<std::uint32_t> material;
  std::vector<std::uint32_t> leader;  ///< itself; the face that a layer lies on; kNoId for one that is removed
  std::vector<bool> is_turned;
  std::vector<SoupTriangle> vertices;  ///< of the oriented surface, in the order of the corners before turning
};

Faces gather_faces(const SourceMesh& mesh, const Points& points) {
  Faces faces;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      SoupTriangle t{};
      for (std::size_t k = 0; k < 3; ++k) t[k] = points.of[p][primitive.indices[i + k]];
      faces.leader.push_back(static_cast<std::uint32_t>(faces.points.size()));
      faces.points.push_back(t);
      faces.material.push_back(primitive.material.value);
    }
  }
  faces.is_turned.resize(faces.points.size(), false);
  faces.vertices = faces.points;
  return faces;
}

void remove_degenerate(Faces& faces, MeshRepairs& repairs) {
  for (std::size_t f = 0; f < faces.points.size(); ++f) {
    const SoupTriangle& t = faces.points[f];
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) continue;
    faces.leader[f] = kNoId;
    ++repairs.degenerate;
  }
}

void remove_duplicates(Faces& faces, MeshRepairs& repairs) {
  std::vector<std::pair<SoupTriangle, std::uint32_t>> order;
  for (std::uint32_t f = 0; f < faces.points.size(); ++f) {
    if (faces.leader[f] == kNoId) continue;
    SoupTriangle t = faces.points[f];
    std::sort(t.begin(), t.end());
    order.emplace_back(t, f);
  }
  std::sort(order.begin(), order.end());
  std::set<std::uint32_t> materials;  // of the faces with these points that stay
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    if (order[i].first != order[first].first) first = i;
    if (i == first) materials.clear();
    const std::uint32_t face = order[i].second;
    const bool is_new = materials.insert(faces.material[face]).second;
    faces.leader[face] = is_new ? order[first].second : kNoId;
    repairs.duplicate += is_new ? 0U : 1U;
  }
}

/// Whether the time that it takes has a bound.
bool can_be_oriented(std::span<const SoupTriangle> soup, std::uint32_t point_count) {
  std::vector<std::uint32_t> around(point_count, 0);
  for (const SoupTriangle& t : soup) {
    for (const std::uint32_t point : t) ++around[point];
  }
  std::uint64_t work = 0;
  for (const std::uint32_t count : around) {
    if (count > kFewTriangles) work += std::uint64_t{count} * count;
    if (count > kMaxTrianglesAroundPoint || work > kMaxOrientationWork) return false;
  }
  return true;
}

/// What a face of the oriented surface says of a face with the same points.
SoupTriangle vertices_at(const SoupTriangle& points, const SoupTriangle& leader_points,
                         const SoupTriangle& leader_vertices) {
  SoupTriangle out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto same = std::find(leader_points.begin(), leader_points.end(), points[k]) - leader_points.begin();
    out[k] = leader_vertices[static_cast<std::size_t>(same)];
  }
  return out;
}

/// False: too many triangles around one point.
bool orient(Faces& faces, std::uint32_t point_count, MeshRepairs& repairs) {
  std::vector<SoupTriangle> soup;
  std::vector<std::uint32_t> face_of;
  for (std::uint32_t f = 0; f < faces.points.size(); ++f) {
    if (faces.leader[f] != f) continue;
    soup.push_back(faces.points[f]);
    face_of.push_back(f);
  }
  if (!can_be_oriented(soup, point_count)) return false;
  const OrientedSoup oriented = orient_soup(std::move(soup), point_count);
  for (std::size_t i = 0; i < face_of.size(); ++i) {
    SoupTriangle vertices = oriented.triangles[i];
    if (oriented.is_turned[i]) std::swap(vertices[1], vertices[2]);
    faces.vertices[face_of[i]] = vertices;
    faces.is_turned[face_of[i]] = oriented.is_turned[i];
  }
  for (std::size_t f = 0; f < faces.points.size(); ++f) {
    const std::uint32_t leader = faces.leader[f];
    if (leader == kNoId) continue;
    faces.is_turned[f] = faces.is_turned[leader];
    faces.vertices[f] = vertices_at(faces.points[f], faces.points[leader], faces.vertices[leader]);
    repairs.turned += faces.is_turned[f] ? 1U : 0U;
  }
  repairs.cut_edges = oriented.cut_edges;
  repairs.split = oriented.copies_of.size();
  return true;
}

/// -1, 0 or 1, of the bits: what differs in no bit is one vertex.
int compare_attributes(const Primitive& primitive, std::uint32_t a, std::uint32_t b) {
  const auto compare = [&](const auto& values) {
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are what is asked about.
    return values.empty() ? 0 : std::memcmp(&values[a], &values[b], sizeof(values[a]));
  };
  int order = compare(primitive.normals);
  for (const auto& uvs : primitive.uvs) order = order != 0 ? order : compare(uvs);
  return order != 0 ? order : compare(primitive.colors);
}

/// For every vertex that a remaining face uses, the first such one with the same point and attributes.
std::vector<std::uint32_t> find_equal_vertices(const Primitive& primitive, const std::vector<std::uint32_t>& points,
                                               std::span<const std::uint32_t> leaders, MeshRepairs& repairs) {
  std::vector<std::uint32_t> used;
  for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
    if (leaders[i / 3] != kNoId) used.push_back(primitive.indices[i]);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::sort(used.begin(), used.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (points[a] != points[b]) return points[a] < points[b];
    const int order = compare_attributes(primitive, a, b);
    return order != 0 ? order < 0 : a < b;
  });
  std::vector<std::uint32_t> first(points.size(), kNoId);
  for (std::size_t i = 0; i < used.size(); ++i) {
    const bool is_same =
        i > 0 && points[used[i]] == points[used[i - 1]] && compare_attributes(primitive, used[i], used[i - 1]) == 0;
    first[used[i]] = is_same ? first[used[i - 1]] : used[i];
    repairs.stitched += is_same ? 1U : 0U;
  }
  return first;
}

template <class T>
void append_copy(std::vector<T>& values, std::uint32_t of) {
  if (!values.empty()) values.push_back(T(values[of]));
}

/// The faces that stay, turned, with one vertex for each of the surface's and each attribute that it has there.
void rewrite(Primitive& primitive, const std::vector<std::uint32_t>& points, const Faces& faces, std::size_t first_face,
             MeshRepairs& repairs) {
  const std::size_t face_count = primitive.indices.size() / 3;
  const std::vector<std::uint32_t> equal =
      find_equal_vertices(primitive, points, {faces.leader.data() + first_face, face_count}, repairs);
  using Wedge = std::pair<std::uint32_t, std::uint32_t>;  // stored vertex, vertex of the surface
  std::vector<Wedge> corners;
  for (std::size_t i = 0; i < face_count; ++i) {
    const std::size_t f = first_face + i;
    if (faces.leader[f] == kNoId) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = faces.is_turned[f] && k != 0 ? 3 - k : k;
      corners.emplace_back(equal[primitive.indices[3 * i + corner]], faces.vertices[f][corner]);
    }
  }
  std::vector<Wedge> wedges = corners;
  std::sort(wedges.begin(), wedges.end());
  wedges.erase(std::unique(wedges.begin(), wedges.end()), wedges.end());
  std::vector<std::uint32_t> stored(wedges.size());
  for (std::size_t w = 0; w < wedges.size(); ++w) {
    const std::uint32_t vertex = wedges[w].first;
    if (w == 0 || wedges[w - 1].first != vertex) {
      stored[w] = vertex;
      continue;
    }
    stored[w] = static_cast<std::uint32_t>(primitive.positions.size());
    append_copy(primitive.positions, vertex);
    append_copy(primitive.normals, vertex);
    for (auto& uvs : primitive.uvs) append_copy(uvs, vertex);
    append_copy(primitive.colors, vertex);
  }
  primitive.indices.clear();
  for (const Wedge& corner : corners) {
    primitive.indices.push_back(
        stored[static_cast<std::size_t>(std::lower_bound(wedges.begin(), wedges.end(), corner) - wedges.begin())]);
  }
}

/// False: it could not be oriented.
bool repair_mesh(SourceMesh& mesh) {
  const Points points = find_points(mesh);
  Faces faces = gather_faces(mesh, points);
  remove_degenerate(faces, mesh.repairs);
  remove_duplicates(faces, mesh.repairs);
  mesh.drops.repaired += mesh.repairs.degenerate + mesh.repairs.duplicate;
  const bool is_oriented = orient(faces, points.count, mesh.repairs);
  std::size_t first_face = 0;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const std::size_t face_count = mesh.primitives[p].indices.size() / 3;
    rewrite(mesh.primitives[p], points.of[p], faces, first_face, mesh.repairs);
    first_face += face_count;
  }
  return is_oriented;
}

}  // namespace

void repair_scene(Scene& scene) {
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (repair_mesh(scene.meshes[m])) continue;
    std::string what = "mesh ";
    what += std::to_string(m);
    scene.left_out.push_back({what + ": repair of its orientation", "too many triangles meet in one point"});
  }
}

}  // namespace meshlode::scene
