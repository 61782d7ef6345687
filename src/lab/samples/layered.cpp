// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of layers: things that lie so closely above one another that a cut which keeps every distance may still show
// the wrong one. Units are metres, and each scene is about one of them large. Each layer has a mesh and a material of
// its own, and a colour that tells it from the others.
#include <cassert>
#include <functional>
#include <utility>

#include "base/random.h"
#include "lab/samples/cube_grid.h"
#include "lab/samples/facets.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"
#include "lab/samples/write_glb.h"

namespace meshlode::lab {

using namespace scene;

namespace {

/// A point for each (u, v) of the unit square; seen from outside, v lies to the left of u.
using Surface = std::function<Vec3d(double u, double v)>;

/// An open sheet of `columns` x `rows` cells.
void add_sheet(Primitive& out, std::uint32_t columns, std::uint32_t rows, const Surface& at) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      out.positions.push_back(at(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = first + j * (columns + 1) + i;
      add_quad(out.indices, a, a + 1, a + columns + 2, a + columns + 1);
    }
  }
}

/// A closed slab: the sheet, the same again `down` below it, and a rim.
void add_slab(Primitive& out, std::uint32_t columns, std::uint32_t rows, const Surface& at, const Vec3d& down) {
  const auto top = static_cast<std::uint32_t>(out.positions.size());
  add_sheet(out, columns, rows, at);
  const auto bottom = static_cast<std::uint32_t>(out.positions.size());
  for (std::uint32_t v = top; v < bottom; ++v) out.positions.push_back(Vec3d(out.positions[v]) + down);
  const auto id = [&](std::uint32_t first, std::uint32_t i, std::uint32_t j) { return first + j * (columns + 1) + i; };
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      add_quad(out.indices, id(bottom, i, j), id(bottom, i, j + 1), id(bottom, i + 1, j + 1), id(bottom, i + 1, j));
    }
  }
  const auto rim = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
    add_quad(out.indices, id(top, i, j), id(bottom, i, j), id(bottom, k, l), id(top, k, l));
  };
  for (std::uint32_t i = 0; i < columns; ++i) {
    rim(i, 0, i + 1, 0);
    rim(i + 1, rows, i, rows);
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    rim(columns, j, columns, j + 1);
    rim(0, j + 1, 0, j);
  }
}

/// A closed sphere of 12·n² triangles, each point moved along its direction to `radius(direction)`.
void add_ball(Primitive& out, std::uint32_t n, const std::function<Vec3d(const Vec3d& direction)>& at) {
  const Primitive ball = make_sphere(n);
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  for (const Vec3d& p : ball.positions) out.positions.push_back(at(unit(p)));
  for (const std::uint32_t i : ball.indices) out.indices.push_back(first + i);
}

/// A few millimetres of unevenness, so that there is something to simplify.
double bumps(double x, double y, std::uint64_t seed, double height) {
  return height * fractal_noise(Vec3d(6.0 * x, 6.0 * y, 0.5), 4, seed);
}

using Layers = std::vector<Primitive>;

/// A plate of a millimetre or more in a recess twice as deep: what FlightHelmet's plaque is.
Layers make_plate(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  const double depth = random.between(0.002, 0.006), plate = depth * random.between(0.4, 0.7);
  const double half_x = random.between(0.12, 0.25), half_y = random.between(0.05, 0.12);
  Layers layers(2);
  const auto ground = [&](double x, double y) { return 0.15 * (1.0 - x * x - y * y) + bumps(x, y, seed, 0.004); };
  const auto lowered = [&](double x, double y) {
    const double outside_x = (x < 0.0 ? -x : x) - half_x, outside_y = (y < 0.0 ? -y : y) - half_y;
    const double outside = outside_x > outside_y ? outside_x : outside_y;
    return outside < 0.0 ? depth : outside < 0.01 ? depth * (1.0 - outside / 0.01) : 0.0;
  };
  add_slab(
      layers[0], n, n,
      [&](double u, double v) {
        const double x = u - 0.5, y = v - 0.5;
        return Vec3d(x, y, ground(x, y) - lowered(x, y));
      },
      Vec3d(0.0, 0.0, -0.05));
  add_slab(
      layers[1], n / 3, n / 6,
      [&](double u, double v) {
        const double x = 1.9 * half_x * (u - 0.5), y = 1.9 * half_y * (v - 0.5);
        return Vec3d(x, y, ground(x, y) - depth + plate + 0.1 * depth);
      },
      Vec3d(0.0, 0.0, -plate));
  return layers;
}

/// Stickers a tenth of a millimetre above a case.
Layers make_decal(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(2);
  const auto ground = [&](double x, double y) { return 0.2 * (1.0 - x * x - 0.5 * y * y) + bumps(x, y, seed, 0.003); };
  const auto at = [&](double x, double y, double above) { return Vec3d(x, y, ground(x, y) + above); };
  add_slab(
      layers[0], n, n, [&](double u, double v) { return at(u - 0.5, v - 0.5, 0.0); }, Vec3d(0.0, 0.0, -0.05));
  for (int i = 0; i < 5; ++i) {
    const double x = random.between(-0.38, 0.2), y = random.between(-0.38, 0.2);
    const double width = random.between(0.1, 0.25), height = random.between(0.08, 0.2);
    // As fine as the case below it, and one above the other.
    add_sheet(layers[1], n / 4, n / 4,
              [&](double u, double v) { return at(x + width * u, y + height * v, 1e-4 * (i + 1)); });
  }
  return layers;
}

/// Three hulls, one in the other, the outer two with holes.
Layers make_shells(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(3);
  const double gap = random.between(0.002, 0.006);
  for (std::size_t k = 0; k < 3; ++k) {
    add_ball(layers[k], n / 2, [&](const Vec3d& d) {
      const double radius = 0.5 + 0.02 * fractal_noise(d * 3.0, 3, seed) - gap * static_cast<double>(2 - k);
      return d * radius;
    });
    if (k == 0) continue;
    std::vector<std::uint32_t> kept;
    const std::vector<std::uint32_t>& all = layers[k].indices;
    for (std::size_t i = 0; i < all.size(); i += 3) {
      const Vec3d middle =
          (layers[k].positions[all[i]] + layers[k].positions[all[i + 1]] + layers[k].positions[all[i + 2]]) / 3.0;
      if (value_noise(unit(middle) * 3.0, seed + k) > 0.35) continue;
      kept.insert(kept.end(), {all[i], all[i + 1], all[i + 2]});
    }
    layers[k].indices = std::move(kept);
  }
  return layers;
}

/// A shirt, which can be seen from inside, over a body.
Layers make_cloth(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(2);
  const double gap = random.between(0.002, 0.005);
  const auto body = [&](const Vec3d& d, double above) {
    const double radius = 0.35 + above + 0.04 * fractal_noise(d * 2.0, 3, seed);
    return Vec3d(d.x * radius, 1.4 * d.y * radius, d.z * radius);
  };
  add_ball(layers[0], n / 2, [&](const Vec3d& d) { return body(d, 0.0); });
  add_sheet(layers[1], 2 * n, n, [&](double u, double v) {
    const double height = -0.5 + 1.1 * v, around = 1.0 - height * height;
    const double r = std::sqrt(around < 0.0 ? 0.0 : around);
    const Vec3d d(r * sin_turns(u), height, r * cos_turns(u));
    return body(d, gap * (1.5 + 0.5 * sin_turns(12.0 * u)));
  });
  return layers;
}

/// Coins of two millimetres in a tray, some on top of others.
Layers make_coins(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(3);
  add_slab(
      layers[0], n, n,
      [&](double u, double v) {
        const double x = u - 0.5, y = v - 0.5;
        const double side = (x * x > y * y ? x * x : y * y) * 4.0;
        return Vec3d(x, y, side > 0.8 ? 0.3 * (side - 0.8) : bumps(x, y, seed, 0.0005));
      },
      Vec3d(0.0, 0.0, -0.02));
  const std::uint32_t around = 24;
  const auto add_coin = [&](Primitive& out, double x, double y, double z) {
    const double radius = 0.02, thickness = 0.002;
    // A polar sheet over the top, the rim and the bottom: 0, 1, 1, 0 of the radius.
    add_sheet(out, around, 6, [&](double u, double v) {
      const auto ring = static_cast<int>(6.0 * v + 0.5);
      const double r = radius * (ring < 3 ? ring / 3.0 : (6 - ring) / 3.0) * (ring == 3 ? 1.0 : 0.999);
      const double height = ring < 3 ? thickness + (ring == 1 ? 0.0002 : 0.0) : ring == 3 ? 0.5 * thickness : 0.0;
      return Vec3d(x + r * cos_turns(u), y + r * sin_turns(u), z + height);
    });
  };
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 8; ++i) {
      const double x = 0.1 * (i - 3.5) + random.between(-0.02, 0.02), y = 0.1 * (j - 3.5) + random.between(-0.02, 0.02);
      add_coin(layers[1], x, y, 0.0008);
      if (random.chance(0.5)) add_coin(layers[2], x + random.between(0.0, 0.01), y, 0.0031);
    }
  }
  return layers;
}

/// A brick wall whose windows are panes in recesses.
Layers make_facade(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(3);
  const double depth = random.between(0.006, 0.012);
  const auto window = [&](double x, double y) {
    const double u = 3.0 * x - std::floor(3.0 * x), v = 3.0 * y - std::floor(3.0 * y);
    return u > 0.25 && u < 0.75 && v > 0.2 && v < 0.8;
  };
  const auto wall = [&](double u, double v) {
    const double row = 24.0 * v, column = 8.0 * u + (static_cast<int>(std::floor(row)) % 2 == 0 ? 0.0 : 0.5);
    const bool is_mortar = row - std::floor(row) < 0.15 || column - std::floor(column) < 0.06;
    return Vec3d(u - 0.5, v - 0.5, window(u, v) ? -depth : (is_mortar ? -0.002 : 0.0) + bumps(u, v, seed, 0.001));
  };
  add_slab(layers[0], 2 * n, 2 * n, wall, Vec3d(0.0, 0.0, -0.1));
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const double x = (i + 0.25) / 3.0 - 0.5, y = (j + 0.2) / 3.0 - 0.5, width = 0.5 / 3.0, height = 0.6 / 3.0;
      // The frame's cross lies on the pane, and both lie in the recess.
      const double pane = -depth + random.between(0.25, 0.5) * depth;
      add_sheet(layers[1], n / 8, n / 8,
                [&](double u, double v) { return Vec3d(x + width * u, y + height * v, pane); });
      const double bar = 0.012, front = pane + 0.2 * depth;
      add_slab(
          layers[2], 2, n / 8,
          [&](double u, double v) { return Vec3d(x + 0.5 * width + bar * (u - 0.5), y + height * v, front); },
          Vec3d(0.0, 0.0, -0.1 * depth));
      add_slab(
          layers[2], n / 8, 2,
          [&](double u, double v) { return Vec3d(x + width * u, y + 0.5 * height + bar * (v - 0.5), front); },
          Vec3d(0.0, 0.0, -0.1 * depth));
    }
  }
  return layers;
}

/// Leaves that can be seen from below, close over a branch and over each other.
Layers make_leaves(std::uint32_t n, std::uint64_t seed) {
  SplitMix64 random(seed);
  Layers layers(3);
  const auto branch = [&](double along, double turn, double above) {
    const double radius =
        0.06 + above + 0.004 * fractal_noise(Vec3d(8.0 * along, cos_turns(turn), sin_turns(turn)), 3, seed);
    return Vec3d(along - 0.5, radius * cos_turns(turn), radius * sin_turns(turn));
  };
  add_sheet(layers[0], n, 2 * n, [&](double u, double v) { return branch(v, -u, 0.0); });
  for (int i = 0; i < 60; ++i) {
    const double at = random.between(0.02, 0.86), turn = random.unit(), above = random.between(0.001, 0.003);
    const double size = random.between(0.06, 0.12);
    add_sheet(layers[1 + static_cast<std::size_t>(i % 2)], n / 8, n / 8, [&](double u, double v) {
      const double narrow = 4.0 * v * (1.0 - v) * 0.5 + 0.1;  // pointed at both ends
      return branch(at + size * v, turn - 0.25 * narrow * (u - 0.5), above + 0.0005 * i / 60.0);
    });
  }
  return layers;
}

struct Kind {
  const char* name;
  Layers (*make)(std::uint32_t n, std::uint64_t seed);
  bool is_upper_double_sided;
};
constexpr Kind kKinds[] = {{"plate", make_plate, false}, {"decal", make_decal, false}, {"shells", make_shells, false},
                           {"cloth", make_cloth, true},  {"coins", make_coins, false}, {"facade", make_facade, false},
                           {"leaves", make_leaves, true}};

}  // namespace

std::vector<std::string> layered_kinds() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

SampleFile make_layered_file(const std::string& kind, std::uint64_t seed, std::uint32_t cells) {
  const Kind* found = nullptr;
  for (const Kind& known : kKinds) found = known.name == kind ? &known : found;
  assert(found != nullptr && cells >= 16);
  Layers layers = found->make(cells, seed);
  GlbScene scene;
  scene.name = kind;
  const Vec4f colors[] = {{0.45F, 0.25F, 0.12F, 1.0F}, {0.9F, 0.75F, 0.2F, 1.0F}, {0.2F, 0.35F, 0.8F, 1.0F}};
  for (std::size_t k = 0; k < layers.size(); ++k) {
    GlbMaterial material;
    material.base_color = colors[k];
    material.double_sided = k > 0 && found->is_upper_double_sided;
    add_object(scene, kind + " " + std::to_string(k), with_smooth_normals(std::move(layers[k])), material);
  }
  return {"layers-" + kind + "-" + std::to_string(seed) + ".glb", write_glb(scene)};
}

}  // namespace meshlode::lab
