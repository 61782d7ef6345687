// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/samples/city.h"

#include <utility>

#include "base/random.h"
#include "lab/samples/facets.h"
#include "lab/samples/noise.h"

namespace meshlode::lab {

using namespace scene;

namespace {

enum Material : std::uint32_t { kConcrete, kGlass, kPlaster, kTiles, kSteel, kRed, kGrass };

/// A mesh of two primitives, one a material.
struct TwoMaterials {
  Primitive first, second;
  FacetBuilder a{first}, b{second};

  [[nodiscard]] GlbMesh finish(const char* name, Material first_material, Material second_material) {
    first.material = MaterialId(static_cast<std::uint32_t>(first_material));
    second.material = MaterialId(static_cast<std::uint32_t>(second_material));
    GlbMesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(std::move(first));
    mesh.primitives.push_back(std::move(second));
    return mesh;
  }
};

/// A closed block with recessed windows: walls of the first material, panes of the second.
GlbMesh make_tower() {
  constexpr std::uint32_t kColumns = 5, kRows = 12;
  constexpr double kHalf = 5.0, kHeight = 36.0, kRecess = 0.4;
  TwoMaterials parts;
  const Vec3d low[4] = {{-kHalf, 0.0, kHalf}, {kHalf, 0.0, kHalf}, {kHalf, 0.0, -kHalf}, {-kHalf, 0.0, -kHalf}};
  const Vec3d rise(0.0, kHeight, 0.0);
  for (int side = 0; side < 4; ++side) {
    const Vec3d a = low[side], b = low[(side + 1) % 4];
    const Vec3d inward = -unit(glm::cross(b - a, rise)) * kRecess;
    const auto point = [&](std::uint32_t i, std::uint32_t j) {
      return FacetBuilder::mix(FacetBuilder::mix(a, b, i, kColumns), FacetBuilder::mix(a + rise, b + rise, i, kColumns),
                               j, kRows);
    };
    for (std::uint32_t j = 0; j < kRows; ++j) {
      for (std::uint32_t i = 0; i < kColumns; ++i) {
        const Vec3d outer[4] = {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)};
        const Vec3d center = 0.25 * (outer[0] + outer[1] + outer[2] + outer[3]);
        Vec3d frame[4], pane[4];
        for (int k = 0; k < 4; ++k) {
          frame[k] = center + (outer[k] - center) * 0.7;
          pane[k] = frame[k] + inward;
        }
        for (int k = 0; k < 4; ++k) {
          const int l = (k + 1) % 4;
          parts.a.quad(outer[k], outer[l], frame[l], frame[k], 1, 1);
          parts.a.quad(frame[k], frame[l], pane[l], pane[k], 1, 1);
        }
        parts.b.quad(pane[0], pane[1], pane[2], pane[3], 1, 1);
      }
    }
  }
  parts.a.quad(low[0] + rise, low[1] + rise, low[2] + rise, low[3] + rise, kColumns, kColumns);
  parts.a.quad(low[3], low[2], low[1], low[0], kColumns, kColumns);
  return parts.finish("tower", kConcrete, kGlass);
}

/// A closed house with a gable: walls of the first material, roof of the second.
GlbMesh make_house() {
  constexpr std::uint32_t kSteps = 6;
  TwoMaterials parts;
  const Vec3d low[4] = {{-3.0, 0.0, 4.0}, {3.0, 0.0, 4.0}, {3.0, 0.0, -4.0}, {-3.0, 0.0, -4.0}};
  const Vec3d rise(0.0, 3.0, 0.0), front(0.0, 5.5, 4.0), back(0.0, 5.5, -4.0);
  for (int side = 0; side < 4; ++side) {
    const Vec3d a = low[side], b = low[(side + 1) % 4];
    parts.a.quad(a, b, b + rise, a + rise, kSteps, kSteps);
  }
  parts.a.triangle(low[0] + rise, low[1] + rise, front, kSteps);
  parts.a.triangle(low[2] + rise, low[3] + rise, back, kSteps);
  parts.a.quad(low[3], low[2], low[1], low[0], kSteps, kSteps);
  parts.b.quad(low[1] + rise, low[2] + rise, back, front, kSteps, kSteps);
  parts.b.quad(low[3] + rise, low[0] + rise, front, back, kSteps, kSteps);
  return parts.finish("house", kPlaster, kTiles);
}

/// A closed mast, 20 high: steel with a red top.
GlbMesh make_mast() {
  constexpr int kSides = 24;
  TwoMaterials parts;
  const auto ring = [](int i, double radius, double y) {
    const double turn = static_cast<double>(i % kSides) / kSides;
    return Vec3d(radius * cos_turns(turn), y, -radius * sin_turns(turn));
  };
  for (int i = 0; i < kSides; ++i) {
    parts.a.quad(ring(i, 0.6, 0.0), ring(i + 1, 0.6, 0.0), ring(i + 1, 0.35, 17.0), ring(i, 0.35, 17.0), 1, 16);
    parts.a.triangle(ring(i + 1, 0.6, 0.0), ring(i, 0.6, 0.0), {0.0, 0.0, 0.0}, 1);
    parts.b.quad(ring(i, 0.35, 17.0), ring(i + 1, 0.35, 17.0), ring(i + 1, 0.3, 20.0), ring(i, 0.3, 20.0), 1, 4);
    parts.b.triangle(ring(i, 0.3, 20.0), ring(i + 1, 0.3, 20.0), {0.0, 20.0, 0.0}, 1);
  }
  return parts.finish("mast", kSteel, kRed);
}

/// Three closed blades around the z axis: steel with red ends.
GlbMesh make_rotor() {
  TwoMaterials parts;
  for (int blade = 0; blade < 3; ++blade) {
    const double turn = blade / 3.0;
    const Vec3d along(sin_turns(turn), cos_turns(turn), 0.0), across(cos_turns(turn), -sin_turns(turn), 0.0);
    const Vec3d thick(0.0, 0.0, 0.15);
    // Sections from root to end: distance and half width.
    const double at[3] = {0.3, 6.0, 8.0}, half[3] = {0.6, 0.35, 0.1};
    Vec3d section[3][4];
    for (int s = 0; s < 3; ++s) {
      const Vec3d middle = along * at[s], side = across * half[s], front = thick * (half[s] / 0.6);
      section[s][0] = middle - side;
      section[s][1] = middle + front;
      section[s][2] = middle + side;
      section[s][3] = middle - front;
    }
    for (int s = 0; s < 2; ++s) {
      FacetBuilder& part = s == 0 ? parts.a : parts.b;
      for (int k = 0; k < 4; ++k) {
        const int l = (k + 1) % 4;
        part.quad(section[s][k], section[s][l], section[s + 1][l], section[s + 1][k], 1, s == 0 ? 12 : 4);
      }
    }
    parts.a.quad(section[0][3], section[0][2], section[0][1], section[0][0], 1, 1);
    parts.b.quad(section[2][0], section[2][1], section[2][2], section[2][3], 1, 1);
  }
  return parts.finish("rotor", kSteel, kRed);
}

GlbMesh make_ground() {
  GlbMesh mesh;
  mesh.name = "ground";
  Primitive ground;
  FacetBuilder{ground}.quad({-100.0, 0.0, 100.0}, {100.0, 0.0, 100.0}, {100.0, 0.0, -100.0}, {-100.0, 0.0, -100.0}, 16,
                            16);
  ground.material = MaterialId(static_cast<std::uint32_t>(kGrass));
  mesh.primitives.push_back(std::move(ground));
  return mesh;
}

std::array<double, 4> yaw(double turns) {
  return {0.0, sin_turns(0.5 * turns), 0.0, cos_turns(0.5 * turns)};
}

class CityBuilder {
 public:
  GlbScene scene;

  std::uint32_t add(GlbNode node) {
    scene.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(scene.nodes.size() - 1);
  }
  void attach(std::uint32_t parent, std::uint32_t child) { scene.nodes[parent].children.push_back(child); }

  GlbMaterial& material(const char* name, const Vec4f& color, double metallic, double roughness) {
    GlbMaterial out;
    out.name = name;
    out.base_color = color;
    out.metallic = metallic;
    out.roughness = roughness;
    return scene.materials.emplace_back(std::move(out));
  }
};

enum Mesh : std::uint32_t { kTower, kHouse, kMast, kRotor, kGround };

GlbNode place(std::string name, std::uint32_t mesh, double x, double z) {
  GlbNode node;
  node.name = std::move(name);
  node.mesh = mesh;
  node.translation = {x, 0.0, z};
  return node;
}

/// One block of three towers and nine houses; every third house is mirrored, towers have scales that are not uniform.
std::uint32_t add_block(CityBuilder& city, SplitMix64& random, std::uint32_t index) {
  GlbNode block;
  block.name = "block " + std::to_string(index);
  block.translation = {index % 2 == 0 ? -45.0 : 45.0, 0.0, index < 2 ? -45.0 : 45.0};
  block.rotation = yaw(0.25 * index);
  if (index == 3) block.scale = {-1.0, 1.0, 1.0};  // a whole mirrored block
  const std::uint32_t parent = city.add(block);
  for (std::uint32_t i = 0; i < 3; ++i) {
    GlbNode tower = place("tower " + std::to_string(index) + "." + std::to_string(i), kTower, -22.0 + 22.0 * i, -20.0);
    const double wide = random.between(0.7, 1.3), tall = random.between(0.5, 1.6), deep = random.between(0.7, 1.3);
    if (i == 1) {
      // The same kind of transform as a matrix: a quarter turn around y, scaled, and moved.
      tower.matrix = {0.0, 0.0, -wide, 0.0, 0.0, tall, 0.0, 0.0, deep, 0.0, 0.0, 0.0, 0.0, 0.0, -20.0, 1.0};
      tower.translation.reset();
    } else {
      tower.scale = {wide, tall, deep};
    }
    city.attach(parent, city.add(tower));
  }
  for (std::uint32_t i = 0; i < 9; ++i) {
    const double x = -24.0 + 6.0 * i, z = (i % 2 == 0 ? 6.0 : 22.0) + random.between(-1.0, 1.0);
    GlbNode house = place("house " + std::to_string(index) + "." + std::to_string(i), kHouse, x, z);
    house.rotation = yaw(random.between(-0.05, 0.05));
    const double size = random.between(0.7, 0.95);
    house.scale = {i % 3 == 2 ? -size : size, size * random.between(0.9, 1.2), size};
    city.attach(parent, city.add(house));
  }
  return parent;
}

}  // namespace

GlbScene make_city(std::uint64_t seed) {
  CityBuilder city;
  city.scene.name = "city";
  city.material("concrete", {0.62F, 0.60F, 0.57F, 1.0F}, 0.0, 0.9);
  city.material("glass", {0.10F, 0.18F, 0.25F, 1.0F}, 0.6, 0.1);
  city.material("plaster", {0.85F, 0.80F, 0.68F, 1.0F}, 0.0, 0.9);
  city.material("tiles", {0.55F, 0.16F, 0.08F, 1.0F}, 0.0, 0.8);
  city.material("steel", {0.75F, 0.76F, 0.78F, 1.0F}, 0.9, 0.4);
  city.material("red", {0.75F, 0.05F, 0.04F, 1.0F}, 0.0, 0.5);
  city.material("grass", {0.22F, 0.36F, 0.12F, 1.0F}, 0.0, 1.0).double_sided = true;
  city.scene.meshes = {make_tower(), make_house(), make_mast(), make_rotor(), make_ground()};

  SplitMix64 random(seed);
  GlbNode top;
  top.name = "city";
  const std::uint32_t root = city.add(top);
  city.scene.roots.push_back(root);
  city.attach(root, city.add(place("ground", kGround, 0.0, 0.0)));
  for (std::uint32_t block = 0; block < 4; ++block) city.attach(root, add_block(city, random, block));

  const std::uint32_t mast = city.add(place("turbine", kMast, 0.0, 0.0));
  GlbNode rotor = place("rotor", kRotor, 0.0, 0.0);
  rotor.translation = {0.0, 19.0, 0.9};
  const std::uint32_t rotor_node = city.add(rotor);
  city.attach(mast, rotor_node);
  city.attach(root, mast);

  GlbNode sun;
  sun.name = "sun";
  sun.has_light = true;
  sun.rotation = {-0.5, 0.0, 0.0, 0.5 * 1.7320508075688772};  // 60 degrees down
  city.scene.roots.push_back(city.add(sun));

  city.scene.cameras.push_back({"street", false, 0.8, 0.1, 1000.0});
  city.scene.cameras.push_back({"plan", true, 110.0, 0.1, 1000.0});
  GlbNode street;
  street.name = "street camera";
  street.camera = 0;
  street.translation = {0.0, 12.0, 120.0};
  city.scene.roots.push_back(city.add(street));
  GlbNode plan;
  plan.name = "plan camera";
  plan.camera = 1;
  plan.translation = {0.0, 200.0, 0.0};
  plan.rotation = {-0.70710678118654752, 0.0, 0.0, 0.70710678118654752};
  city.scene.roots.push_back(city.add(plan));

  GlbAnimation spin;
  spin.name = "rotor";
  spin.node = rotor_node;
  for (int key = 0; key <= 4; ++key) {
    spin.times.push_back(static_cast<float>(key));
    const double half = key * 0.125;  // half of a quarter turn a key
    spin.rotations.push_back({0.0F, 0.0F, static_cast<float>(sin_turns(half)), static_cast<float>(cos_turns(half))});
  }
  city.scene.animation = spin;
  return std::move(city.scene);
}

}  // namespace meshlode::lab
