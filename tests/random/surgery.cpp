// SPDX-License-Identifier: GPL-3.0-or-later
#include "surgery.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace meshlode::test {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Plane {
  Vec3d through, normal;

  /// Through a point of the shape, so that it cuts.
  Plane(const Shape& shape, Dice& dice)
      : through(shape.points[dice.below(shape.points.size())]), normal(dice.direction()) {}
  [[nodiscard]] double side(const Vec3d& p) const { return glm::dot(p - through, normal); }
};

Vec3d centre(const Shape& shape, const Triangle& t) {
  return (shape.points[t[0]] + shape.points[t[1]] + shape.points[t[2]]) / 3.0;
}

/// From a part in ten million of the shape to a tenth of it; nothing at all in one of four.
double small_distance(Dice& dice) {
  return dice.chance(0.25) ? 0.0 : dice.octaves(-23, -3);
}

/// Which triangles have their centre behind a random plane.
std::vector<std::uint8_t> behind_a_plane(const Shape& shape, Dice& dice) {
  const Plane plane(shape, dice);
  std::vector<std::uint8_t> is_behind;
  for (const Triangle& t : shape.triangles) is_behind.push_back(plane.side(centre(shape, t)) < 0.0 ? 1 : 0);
  return is_behind;
}

/// 1: a vertex of triangles that are not marked, 2: of marked ones, 3: of both.
std::vector<std::uint8_t> sides_of_vertices(const Shape& shape, const std::vector<std::uint8_t>& is_marked) {
  std::vector<std::uint8_t> sides(shape.points.size(), 0U);
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const std::uint8_t side = is_marked[t] != 0 ? 2 : 1;
    for (const std::uint32_t v : shape.triangles[t]) sides[v] = static_cast<std::uint8_t>(sides[v] | side);
  }
  return sides;
}

/// Triangles that hang together, around one of them.
std::vector<std::uint8_t> patch(const Shape& shape, Dice& dice) {
  std::multimap<std::uint32_t, std::size_t> around;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    for (const std::uint32_t v : shape.triangles[t]) around.emplace(v, t);
  }
  std::vector<std::uint8_t> is_marked(shape.triangles.size(), 0U);
  const std::size_t most = 1 + dice.below(1 + shape.triangles.size() / 3);
  std::vector<std::size_t> found{dice.below(shape.triangles.size())};
  is_marked[found[0]] = 1;
  for (std::size_t next = 0; next < found.size() && found.size() < most; ++next) {
    for (const std::uint32_t v : shape.triangles[found[next]]) {
      const auto [begin, end] = around.equal_range(v);
      for (auto at = begin; at != end && found.size() < most; ++at) {
        if (is_marked[at->second]++ == 0) found.push_back(at->second);
        is_marked[at->second] = 1;
      }
    }
  }
  return is_marked;
}

/// Marked triangles get vertices of their own. \returns the copies
std::vector<std::uint32_t> part_vertices(Shape& shape, const std::vector<std::uint8_t>& is_marked) {
  std::map<std::uint32_t, std::uint32_t> copies;
  for (std::size_t t = 0; t < is_marked.size(); ++t) {
    if (is_marked[t] == 0) continue;
    for (std::uint32_t& v : shape.triangles[t]) {
      const auto found = copies.find(v);
      if (found == copies.end()) {
        const Vec3d p = shape.points[v];
        const std::uint32_t copy = shape.add(p);
        copies.emplace(v, copy);
        v = copy;
      } else {
        v = found->second;
      }
    }
  }
  std::vector<std::uint32_t> list;
  for (const auto& [old, copy] : copies) list.push_back(copy);
  return list;
}

/// One half is moved; the vertices between the halves stay where they are, shared.
void cut_and_glue(Shape& shape, Dice& dice) {
  const auto is_marked = behind_a_plane(shape, dice);
  const auto sides = sides_of_vertices(shape, is_marked);
  const Vec3d by = dice.octaves(-8, 0) * dice.direction();
  for (std::size_t v = 0; v < shape.points.size(); ++v) {
    if (sides[v] == 2U) shape.points[v] += by;
  }
}

/// One half gets vertices of its own and lies beside where it was: a crack, an overlap, or two borders in one place.
void cut_and_lay_beside(Shape& shape, Dice& dice) {
  const auto copies = part_vertices(shape, behind_a_plane(shape, dice));
  const Vec3d by = small_distance(dice) * dice.direction();
  const double scatter = dice.chance(0.3) ? small_distance(dice) : 0.0;
  for (const std::uint32_t v : copies) {
    const Vec3d own = scatter * dice.direction();
    shape.points[v] += by + own;
  }
}

/// What lies behind a plane goes, the rest is mirrored there; vertices between lie on the plane and are shared.
void mirror(Shape& shape, Dice& dice) {
  const Plane plane(shape, dice);
  std::vector<std::uint8_t> is_behind;
  for (const Triangle& t : shape.triangles) is_behind.push_back(plane.side(centre(shape, t)) < 0.0 ? 1 : 0);
  const auto sides = sides_of_vertices(shape, is_behind);
  const bool is_well_wound = dice.chance(0.7);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < is_behind.size(); ++t) {
    if (is_behind[t] == 0) kept.push_back(shape.triangles[t]);
  }
  if (kept.empty()) return;
  std::vector<std::uint32_t> image(shape.points.size());
  const std::size_t count = shape.points.size();
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec3d across = plane.side(shape.points[v]) * plane.normal;
    image[v] = v;
    if (sides[v] == 3U) shape.points[v] -= across;
    if (sides[v] != 1U) continue;
    const Vec3d mirrored = shape.points[v] - 2.0 * across;
    image[v] = shape.add(mirrored);
  }
  shape.triangles = kept;
  for (const Triangle& t : kept) {
    shape.triangle(image[t[0]], image[t[is_well_wound ? 2 : 1]], image[t[is_well_wound ? 1 : 2]]);
  }
}

/// Directed edges without an opposite, by their first vertex.
std::multimap<std::uint32_t, std::uint32_t> border_edges(const Shape& shape) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const Triangle& t : shape.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a != b) uses[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  std::multimap<std::uint32_t, std::uint32_t> border;
  for (const auto& [edge, count] : uses) {
    if (count > 0) border.emplace(edge.first, edge.second);
    if (count < 0) border.emplace(edge.second, edge.first);
  }
  return border;
}

/// A patch goes, and every border that there is then is closed by a fan around its middle, or around one of its own.
void cap_holes(Shape& shape, Dice& dice) {
  const auto is_marked = patch(shape, dice);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < is_marked.size(); ++t) {
    if (is_marked[t] == 0) kept.push_back(shape.triangles[t]);
  }
  if (kept.empty()) return;
  shape.triangles = kept;
  auto border = border_edges(shape);
  const std::size_t most = shape.triangles.size();
  while (!border.empty() && shape.triangles.size() < 2 * most) {
    std::vector<std::uint32_t> loop;
    for (auto at = border.begin(); at != border.end(); at = border.find(loop.back())) {
      if (loop.empty()) loop.push_back(at->first);
      loop.push_back(at->second);
      border.erase(at);
    }
    Vec3d middle(0.0);
    for (const std::uint32_t v : loop) middle += shape.points[v] / static_cast<double>(loop.size());
    const bool is_around_middle = dice.chance(0.7);
    const bool is_well_wound = dice.chance(0.85);
    const std::uint32_t apex = is_around_middle ? shape.add(middle) : loop[0];
    for (std::size_t k = 0; k + 1 < loop.size(); ++k) {
      const std::uint32_t a = loop[k], b = loop[k + 1];
      if (a == apex || b == apex) continue;
      if (is_well_wound) shape.triangle(b, a, apex);
      if (!is_well_wound) shape.triangle(a, b, apex);
    }
  }
}

void turn_patch(Shape& shape, Dice& dice) {
  const auto is_marked = patch(shape, dice);
  for (std::size_t t = 0; t < is_marked.size(); ++t) {
    if (is_marked[t] != 0) std::swap(shape.triangles[t][1], shape.triangles[t][2]);
  }
}

/// A patch is cut out and lies somewhere else on the shape, of another size; in half the cases its old place keeps it.
void transplant(Shape& shape, Dice& dice) {
  const auto is_marked = patch(shape, dice);
  if (dice.chance(0.5)) {
    const std::size_t count = shape.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (is_marked[t] != 0) shape.triangles.push_back(Triangle(shape.triangles[t]));
    }
  }
  const auto copies = part_vertices(shape, is_marked);
  const Vec3d from = shape.points[copies[dice.below(copies.size())]];
  const Vec3d to = shape.points[dice.below(shape.points.size())];
  const double size = dice.octaves(-4, 1);
  const bool is_turned = dice.chance(0.5);
  for (const std::uint32_t v : copies) {
    const Vec3d d = size * (shape.points[v] - from);
    shape.points[v] = to + (is_turned ? Vec3d(d.y, d.z, d.x) : d);
  }
}

/// Points become one with a neighbour, or with any other. Triangles that lose their area stay, as a weld leaves them.
void merge_points(Shape& shape, Dice& dice) {
  const std::size_t count = 1 + dice.below(1 + shape.triangles.size() / 20);
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = shape.triangles[dice.below(shape.triangles.size())];
    const std::uint32_t gone = t[0];
    const auto any = static_cast<std::uint32_t>(dice.below(shape.points.size()));
    const std::uint32_t kept = dice.chance(0.8) ? t[1] : any;
    for (Triangle& other : shape.triangles) std::replace(other.begin(), other.end(), gone, kept);
  }
}

/// The two triangles of an edge become the other two of their quad, whatever that does to the surface.
void flip_edges(Shape& shape, Dice& dice) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::size_t>> corners;  // triangle, corner
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners[{shape.triangles[t][k], shape.triangles[t][(k + 1) % 3]}] = {t, k};
    }
  }
  const double share = dice.octaves(-6, 0);
  std::set<std::size_t> done;
  for (const auto& [edge, at] : corners) {
    const auto opposite = corners.find({edge.second, edge.first});
    if (edge.first >= edge.second || opposite == corners.end() || !dice.chance(share)) continue;
    const auto [s, i] = at;
    const auto [t, j] = opposite->second;
    if (s == t || done.contains(s) || done.contains(t)) continue;
    const std::uint32_t c = shape.triangles[s][(i + 2) % 3], d = shape.triangles[t][(j + 2) % 3];
    done.insert({s, t});
    shape.triangles[s] = {edge.first, d, c};
    shape.triangles[t] = {d, edge.second, c};
  }
}

/// The triangles around some vertices come apart there.
void tear(Shape& shape, Dice& dice) {
  const std::size_t count = 1 + dice.below(8);
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle chosen = shape.triangles[dice.below(shape.triangles.size())];
    const std::uint32_t vertex = chosen[0];
    const double distance = small_distance(dice);
    for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
      const auto corner = std::find(shape.triangles[t].begin(), shape.triangles[t].end(), vertex);
      if (corner == shape.triangles[t].end() || dice.chance(0.3)) continue;
      const Vec3d place = shape.points[vertex] + distance * dice.direction();
      *corner = shape.add(place);
    }
  }
}

/// The whole surface once more, a little away along its normals: a shell, or the same twice.
void double_shell(Shape& shape, Dice& dice) {
  std::vector<Vec3d> normals(shape.points.size(), Vec3d(0.0));
  for (const Triangle& t : shape.triangles) {
    const Vec3d n = glm::cross(shape.points[t[1]] - shape.points[t[0]], shape.points[t[2]] - shape.points[t[0]]);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  const double distance = small_distance(dice);
  const bool is_turned = dice.chance(0.5);
  const auto first = static_cast<std::uint32_t>(shape.points.size());
  for (std::uint32_t v = 0; v < first; ++v) {
    const double length = std::sqrt(glm::dot(normals[v], normals[v]));
    const Vec3d by = length > 1e-30 ? Vec3d(distance / length * normals[v]) : Vec3d(0.0);
    const Vec3d place = shape.points[v] - by;
    shape.add(place);
  }
  const std::size_t count = shape.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle c = shape.triangles[t];
    shape.triangle(first + c[0], first + c[is_turned ? 2 : 1], first + c[is_turned ? 1 : 2]);
  }
}

/// Edges get a vertex on one side alone, in their middle or beside it.
void split_one_side(Shape& shape, Dice& dice) {
  const std::size_t count = 1 + dice.below(1 + shape.triangles.size() / 10);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t = dice.below(shape.triangles.size());
    const Triangle c = shape.triangles[t];
    const double at = dice.range(0.05, 0.95);
    const double aside = dice.chance(0.5) ? 0.0 : dice.octaves(-30, -8);
    const Vec3d place = (1.0 - at) * shape.points[c[0]] + at * shape.points[c[1]] + aside * dice.direction();
    const std::uint32_t middle = shape.add(place);
    shape.triangles[t] = {c[0], middle, c[2]};
    shape.triangle(middle, c[1], c[2]);
  }
}

constexpr std::array<Operation, 11> kOperations{{
    {"glued", cut_and_glue},
    {"laid beside", cut_and_lay_beside},
    {"mirrored", mirror},
    {"capped", cap_holes},
    {"patch turned", turn_patch},
    {"transplanted", transplant},
    {"merged", merge_points},
    {"flipped", flip_edges},
    {"torn", tear},
    {"shell", double_shell},
    {"split", split_one_side},
}};

}  // namespace

std::span<const Operation> surgery_operations() {
  return kOperations;
}

void operate(Shape& shape, Dice& dice, std::size_t most, std::string& names) {
  const std::uint64_t count = shape.triangles.empty() ? 0 : 1 + dice.below(6);
  for (std::uint64_t i = 0; i < count && (i == 0 || shape.triangles.size() <= most); ++i) {
    const Operation& operation = kOperations[dice.below(kOperations.size())];
    operation.apply(shape, dice);
    names += (i == 0 ? "" : ", ") + std::string(operation.name);
  }
}

}  // namespace meshlode::test
