// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "format/names.h"
#include "layers.h"
#include "shapes.h"
#include "surgery.h"

namespace meshlode::test {

namespace {

/// Where the pieces of a mesh lie and how large they are.
struct Layout {
  int smallest = -1, largest = 1;  ///< powers of two
  double spread = 1.0;
  Vec3d offset{0.0};
  double unit = 1.0;

  explicit Layout(Dice& dice) {
    if (dice.chance(0.5)) {  // 1e-3 to 30 in one mesh
      smallest = -10;
      largest = 5;
    }
    spread = dice.chance(0.3) ? 0.0 : dice.octaves(-2, 4);
    if (dice.chance(0.1)) offset = 1e5 * dice.direction();
    if (dice.chance(0.1)) unit = std::ldexp(1.0, dice.chance(0.5) ? -20 : 30);
  }
};

Vec3f to_float(const Vec3d& p) {
  Vec3f out;
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(p[k]);
  return out;
}

/// Of any kind, damaged.
Shape damaged_piece(Dice& dice, std::uint32_t triangles, std::string& contents) {
  const auto kinds = shape_kinds();
  const ShapeKind& kind = kinds[dice.below(kinds.size())];
  contents += kind.name;
  Shape shape = kind.make(dice, std::max(triangles, 1U));
  damage(shape, dice);
  return shape;
}

/// Of a kind whose surface is a good one, operated on. A third of the budget: operations double what there is.
Shape operated_piece(Dice& dice, std::uint32_t triangles, std::string& contents) {
  constexpr std::array<std::string_view, 6> kGood{"ball", "torus", "patch", "cylinder", "blocks", "plate"};
  const std::string_view name = kGood[dice.below(kGood.size())];
  const auto kinds = shape_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const ShapeKind& k) { return k.name == name; });
  Shape shape = kind->make(dice, std::max(triangles / 3, 1U));
  contents += std::string(name) + " (";
  operate(shape, dice, 2 * triangles / 3, contents);
  contents += ")";
  return shape;
}

Shape random_piece(Dice& dice, const Layout& layout, Harm harm, std::uint32_t triangles, std::string& contents) {
  if (!contents.empty() && contents.back() != '[') contents += ", ";
  Shape shape =
      harm == Harm::kSurgery ? operated_piece(dice, triangles, contents) : damaged_piece(dice, triangles, contents);
  const double size = layout.unit * dice.octaves(layout.smallest, layout.largest);
  const Vec3d place = layout.unit * dice.vector(layout.spread) + layout.offset;
  const Vec3d u = dice.direction();
  const Vec3d helper = dice.direction();
  const bool is_turned = dice.chance(0.5);
  const Vec3d across = glm::cross(u, helper);
  const double length = std::sqrt(glm::dot(across, across));
  const bool turns = is_turned && length > 1e-3;
  const Vec3d v = across / std::max(length, 1e-3), w = glm::cross(u, v);
  for (Vec3d& p : shape.points) p = place + size * (turns ? p.x * u + p.y * v + p.z * w : p);
  return shape;
}

Vec3f unit_or_up(const Vec3d& n) {
  const double square = glm::dot(n, n);
  // The sum of floats' products may be a denormal; such a normal says nothing.
  return square > 1e-60 ? to_float(n / std::sqrt(square)) : Vec3f(0.0F, 1.0F, 0.0F);
}

Vec3d face_normal(const RandomPrimitive& primitive, const std::array<std::uint32_t, 3>& t) {
  const Vec3d a(primitive.positions[t[0]]), b(primitive.positions[t[1]]), c(primitive.positions[t[2]]);
  return glm::cross(b - a, c - a);
}

/// A vertex for every corner.
void split_corners(RandomPrimitive& primitive) {
  std::vector<Vec3f> positions;
  for (auto& t : primitive.triangles) {
    for (std::uint32_t& v : t) {
      positions.push_back(primitive.positions[v]);
      v = static_cast<std::uint32_t>(positions.size() - 1);
    }
  }
  primitive.positions = std::move(positions);
}

/// Vertices get a copy where triangles of both halves of `is_far` meet: a seam runs between them.
void split_between(RandomPrimitive& primitive, const std::vector<std::uint8_t>& is_far) {
  const std::size_t count = primitive.positions.size();
  std::vector<std::uint32_t> copy(count, 0U);
  for (std::size_t t = 0; t < primitive.triangles.size(); ++t) {
    if (is_far[t] == 0) continue;
    for (std::uint32_t& v : primitive.triangles[t]) {
      if (copy[v] == 0) {
        primitive.positions.push_back(Vec3f(primitive.positions[v]));
        copy[v] = static_cast<std::uint32_t>(primitive.positions.size() - 1);
      }
      v = copy[v];
    }
  }
}

/// A triangle is far where its first corner lies behind a random plane through one of the vertices, or by chance alone.
std::vector<std::uint8_t> random_halves(const RandomPrimitive& primitive, Dice& dice) {
  std::vector<std::uint8_t> is_far(primitive.triangles.size(), 0U);
  if (primitive.triangles.empty()) return is_far;
  const Vec3d through(primitive.positions[dice.below(primitive.positions.size())]);
  const Vec3d normal = dice.direction();
  const double sprinkle = dice.chance(0.2) ? dice.octaves(-6, -1) : 0.0;
  for (std::size_t t = 0; t < is_far.size(); ++t) {
    const bool is_behind = glm::dot(Vec3d(primitive.positions[primitive.triangles[t][0]]) - through, normal) < 0.0;
    is_far[t] = is_behind != dice.chance(sprinkle) ? 1 : 0;
  }
  return is_far;
}

void add_normals(RandomPrimitive& primitive, Dice& dice) {
  const std::uint64_t kind = dice.below(10);
  if (kind < 3) return;
  if (kind < 5) split_corners(primitive);
  if (kind == 5 || kind == 6) split_between(primitive, random_halves(primitive, dice));
  std::vector<Vec3d> sums(primitive.positions.size(), Vec3d(0.0));
  for (const auto& t : primitive.triangles) {
    const Vec3d normal = face_normal(primitive, t);
    for (const std::uint32_t v : t) sums[v] += normal;
  }
  for (const Vec3d& sum : sums) {
    Vec3d normal(unit_or_up(sum));
    if (kind == 9) normal = Vec3d(unit_or_up(normal + dice.vector(0.3)));  // a scan's
    primitive.normals.push_back(to_float(normal));
  }
}

void add_uvs(RandomPrimitive& primitive, Dice& dice) {
  const std::uint64_t kind = dice.below(10);
  if (kind < 4) return;
  if (kind < 7 && primitive.normals.empty()) split_between(primitive, random_halves(primitive, dice));
  const Vec3d u = dice.direction(), v = dice.direction();
  const double tiling = dice.octaves(-3, 6);
  for (const Vec3f& p : primitive.positions) {
    Vec2f uv;
    uv.x = static_cast<float>(tiling * glm::dot(Vec3d(p), u));
    uv.y = static_cast<float>(tiling * glm::dot(Vec3d(p), v));
    if (kind == 9) {
      for (int k = 0; k < 2; ++k) uv[k] = static_cast<float>(dice.unit());
    }
    primitive.uvs.push_back(uv);
  }
}

void add_colors(RandomPrimitive& primitive, Dice& dice) {
  if (!dice.chance(0.15)) return;
  const bool is_white = dice.chance(0.2);
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
    Vec4f color(1.0F);
    for (int k = 0; k < 4 && !is_white; ++k) color[k] = static_cast<float>(dice.unit());
    primitive.colors.push_back(color);
  }
}

/// Vertices of their own for each half, so that a material border has two sides.
RandomPrimitive take_far(RandomPrimitive& primitive, const std::vector<std::uint8_t>& is_far) {
  RandomPrimitive taken;
  taken.positions = primitive.positions;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < primitive.triangles.size(); ++t) {
    if (is_far[t] != 0) {
      taken.triangles.push_back(primitive.triangles[t]);
    } else {
      primitive.triangles[kept++] = primitive.triangles[t];
    }
  }
  primitive.triangles.resize(kept);
  return taken;
}

/// What one of `parts` gets of what is left: all from an even share to most of it.
std::uint32_t part_of(std::uint32_t& left, std::uint32_t parts, Dice& dice) {
  const double even = 1.0 / parts;
  const auto part =
      static_cast<std::uint32_t>(left * (parts == 1 ? 1.0 : even + (0.9 - even) * dice.unit() * dice.unit()));
  left -= part;
  return part;
}

RandomMesh random_mesh(Dice& dice, Harm harm, std::uint32_t triangles, std::uint32_t materials, std::string& contents) {
  RandomMesh mesh;
  const Layout layout(dice);
  std::uint32_t left = triangles;
  const std::uint32_t primitives = dice.between(1, 4);
  for (std::uint32_t p = 0; p < primitives; ++p) {
    const std::uint32_t pieces = dice.between(1, 3);
    Shape shape;
    for (std::uint32_t k = 0; k < pieces; ++k) {
      const std::uint32_t share = part_of(left, (primitives - p) * pieces - k, dice);
      shape.append(random_piece(dice, layout, harm, share, contents));
    }
    RandomPrimitive primitive;
    for (const Vec3d& point : shape.points) primitive.positions.push_back(to_float(point));
    primitive.triangles = std::move(shape.triangles);
    primitive.material = static_cast<std::uint32_t>(dice.below(materials));
    std::vector<RandomPrimitive> parts;
    if (dice.chance(0.25)) {
      parts.push_back(take_far(primitive, random_halves(primitive, dice)));
      parts.back().material = static_cast<std::uint32_t>(dice.below(materials));
    }
    parts.push_back(std::move(primitive));
    for (RandomPrimitive& part : parts) {
      if (part.triangles.empty()) continue;
      add_normals(part, dice);
      add_uvs(part, dice);
      add_colors(part, dice);
      mesh.primitives.push_back(std::move(part));
    }
  }
  return mesh;
}

std::array<double, 16> random_matrix(Dice& dice) {
  std::array<double, 16> m = RandomInstance().matrix;
  switch (dice.below(6)) {
    case 0: return m;
    case 1: m[5 * dice.below(3)] = -1.0; break;                  // mirrored
    case 2: m[5 * dice.below(3)] = 0.0; break;                   // singular
    case 3: m[0] = m[5] = m[10] = dice.octaves(-10, 10); break;  // scaled
    case 4:                                                      // skewed
      for (std::size_t k = 0; k < 11; ++k) m[k] = k % 4 == 3 ? 0.0 : dice.signed_unit();
      break;
    default: m[5 * dice.below(3)] = dice.octaves(-8, 0); break;  // squashed
  }
  const double distance = dice.chance(0.2) ? 1e5 : 3.0;
  for (std::size_t k = 12; k < 15; ++k) m[k] = distance * dice.signed_unit();
  return m;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// The defaults for half of the scenes.
std::vector<std::string> random_options(Dice& dice, const RandomScene& scene) {
  std::vector<std::string> options;
  if (dice.chance(0.5)) return options;
  const auto add = [&](const char* name, const std::string& value) {
    options.emplace_back(name);
    options.push_back(value);
  };
  if (dice.chance(0.4)) {
    // Drawn from five, as when five were written: a seed keeps its scene and its other options.
    add("--codec", format::kWrittenCodecNames[dice.below(5) % format::kWrittenCodecNames.size()].name);
  }
  if (dice.chance(0.4)) add("--attributes", dice.chance(0.5) ? "none" : "all");
  const double tier = dice.unit();
  // A proof takes long where many triangles cross each other.
  if (tier < 0.3 && scene.triangle_count() < 3000) {
    add("--error-tier", "certified");
  } else if (tier < 0.4) {
    add("--error-tier", "qem");
  }
  float largest = 1e-30F;
  for (const RandomMesh& mesh : scene.meshes) {
    for (const RandomPrimitive& primitive : mesh.primitives) {
      for (const Vec3f& p : primitive.positions) {
        for (int k = 0; k < 3; ++k) largest = std::max({largest, p[k], -p[k]});
      }
    }
  }
  const double grid = dice.unit();
  const double size = double{largest} * dice.octaves(-18, -5);
  if (grid < 0.25) {
    add("--position-error", number(size));
  } else if (grid < 0.4) {
    add("--grid", number(size));
  }
  if (dice.chance(0.15)) add("--normal-error", number(dice.range(0.02, 5.0)));
  if (dice.chance(0.15)) add("--uv-error", number(dice.octaves(-14, -4)));
  const bool is_certified = options.end() != std::find(options.begin(), options.end(), "certified");
  if (!is_certified && dice.chance(0.5)) add("--promise", dice.chance(0.5) ? "texels" : "appearance");  // measured
  return options;
}

std::uint32_t random_triangles(Dice& dice) {
  // An eighth of the budget may be doubled or added; a few dozen triangles come with the smallest shapes.
  const bool is_small = dice.chance(0.9);
  const double most = is_small ? 1500.0 : 32000.0;
  const double least = is_small ? 20.0 : 2000.0;
  double count = most;
  while (count > 2.0 * least && dice.chance(0.5)) count *= 0.5;
  return static_cast<std::uint32_t>(count * dice.range(0.5, 1.0));
}

}  // namespace

std::uint64_t RandomScene::triangle_count() const {
  std::uint64_t count = 0;
  for (const RandomMesh& mesh : meshes) {
    for (const RandomPrimitive& primitive : mesh.primitives) count += primitive.triangles.size();
  }
  return count;
}

RandomScene random_scene(std::uint64_t seed) {
  return random_scene(seed, Harm::kDamage);
}

RandomScene random_scene(std::uint64_t seed, Harm harm) {
  Dice dice(Random(seed).next());  // seeds beside each other must not be the same stream, shifted
  if (harm == Harm::kLayers) return layered_scene(dice, dice.between(2000, 8000));
  RandomScene scene;
  std::uint32_t left = random_triangles(dice);
  const std::uint32_t meshes = dice.chance(0.5) ? 1 : dice.between(2, 3);
  scene.materials.resize(dice.between(1, 4));
  for (RandomMaterial& material : scene.materials) {
    material.is_textured = dice.chance(0.5);
    material.is_masked = dice.chance(0.2);
    material.is_double_sided = dice.chance(0.3);
  }
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  for (std::uint32_t m = 0; m < meshes; ++m) {
    scene.contents += m == 0 ? "[" : " [";
    const std::uint32_t triangles = part_of(left, meshes - m, dice);
    scene.meshes.push_back(random_mesh(dice, harm, triangles, materials, scene.contents));
    scene.contents += "]";
    RandomInstance instance;
    instance.mesh = m;
    scene.instances.push_back(instance);
    const std::uint32_t more = dice.chance(0.5) ? 0U : dice.between(1, 3);
    for (std::uint32_t k = 0; k < more; ++k) {
      instance.matrix = random_matrix(dice);
      scene.instances.push_back(instance);
    }
  }
  scene.build_options = random_options(dice, scene);
  return scene;
}

RandomScene scene_of_one_piece(std::size_t kind, std::uint32_t triangles, bool torn) {
  Dice dice(Random(kind).next());
  const Shape shape = shape_kinds()[kind].make(dice, triangles);
  RandomScene scene;
  scene.contents = shape_kinds()[kind].name;
  RandomPrimitive& primitive = scene.meshes.emplace_back().primitives.emplace_back();
  for (const Vec3d& point : shape.points) primitive.positions.push_back(to_float(point));
  primitive.triangles = shape.triangles;
  if (torn) {
    split_corners(primitive);
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
      Vec2f uv;
      for (int k = 0; k < 2; ++k) uv[k] = static_cast<float>(dice.unit());
      primitive.uvs.push_back(uv);
    }
  }
  scene.materials.resize(1);
  scene.materials[0].is_textured = torn;
  scene.instances.resize(1);
  return scene;
}

}  // namespace meshlode::test
