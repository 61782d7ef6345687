// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "lab/samples/cube_grid.h"
#include "lab/samples/noise.h"

namespace meshlode::test {

namespace {

/// Cells of a grid; wrapped sides have as many points as cells.
struct Cells {
  std::uint32_t columns = 1, rows = 1;
  bool wrap_columns = false, wrap_rows = false;
};

std::uint32_t side_of(std::uint32_t triangles) {
  return std::max(1U, static_cast<std::uint32_t>(std::sqrt(triangles / 2.0)));
}

/// Points place(column, row) joined to quads where keep(column, row); returns the index of the first point.
std::uint32_t add_grid(Shape& shape, const Cells& cells, auto place, auto keep) {
  const std::uint32_t across = cells.columns + (cells.wrap_columns ? 0U : 1U);
  const std::uint32_t along = cells.rows + (cells.wrap_rows ? 0U : 1U);
  const auto first = static_cast<std::uint32_t>(shape.points.size());
  for (std::uint32_t j = 0; j < along; ++j) {
    for (std::uint32_t i = 0; i < across; ++i) shape.add(place(i, j));
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + j % along * across + i % across; };
  for (std::uint32_t j = 0; j < cells.rows; ++j) {
    for (std::uint32_t i = 0; i < cells.columns; ++i) {
      if (keep(i, j)) shape.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return first;
}

std::uint32_t add_grid(Shape& shape, const Cells& cells, auto place) {
  return add_grid(shape, cells, place, [](std::uint32_t, std::uint32_t) { return true; });
}

double share(std::uint32_t i, std::uint32_t n) {
  return static_cast<double>(i) / n;
}

/// Two unit vectors across `axis`.
std::array<Vec3d, 2> frame_of(const Vec3d& axis) {
  const Vec3d helper = axis.x * axis.x < 0.5 ? Vec3d(1.0, 0.0, 0.0) : Vec3d(0.0, 1.0, 0.0);
  const Vec3d u = glm::cross(axis, helper);
  const Vec3d unit = u / std::sqrt(glm::dot(u, u));
  return {unit, glm::cross(axis, unit)};
}

/// A height field over the unit square: smooth hills and white noise.
struct Relief {
  std::uint64_t seed;
  double hills, waves, noise;
  explicit Relief(Dice& dice)
      : seed(dice.next()), hills(dice.range(0.0, 0.5)), waves(dice.range(0.5, 6.0)), noise(0.0) {
    if (dice.chance(0.5)) noise = dice.octaves(-14, -4);
  }
  [[nodiscard]] double at(double x, double y, Dice& dice) const {
    return hills * lab::value_noise({waves * x, waves * y, 0.5}, seed) + noise * dice.signed_unit();
  }
};

// ------------------------------------------------------------------------------------------------------ closed
// surfaces

Shape make_ball(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t rows = std::max(2U, side_of(triangles) * 2 / 3);
  const std::uint32_t columns = std::max(3U, triangles / (2 * rows));
  const Relief relief(dice);
  Vec3d squash(1.0);
  if (dice.chance(0.3)) squash[static_cast<int>(dice.below(3))] = dice.octaves(-10, 0);
  const auto place = [&](double column, double row) {
    const double around = column, down = 0.5 * row;
    const Vec3d p(lab::sin_turns(down) * lab::cos_turns(around), lab::cos_turns(down),
                  lab::sin_turns(down) * lab::sin_turns(around));
    return squash * p * (1.0 + 0.4 * relief.at(p.x, p.y, dice));
  };
  const std::uint32_t top = shape.add(place(0.0, 0.0)), bottom = shape.add(place(0.0, 1.0));
  const std::uint32_t first = add_grid(shape, {columns, rows - 2, true, false}, [&](std::uint32_t i, std::uint32_t j) {
    return place(share(i, columns), share(j + 1, rows));
  });
  const std::uint32_t last = first + (rows - 2) * columns;
  for (std::uint32_t i = 0; i < columns; ++i) {
    shape.triangle(top, first + (i + 1) % columns, first + i);
    shape.triangle(bottom, last + i, last + (i + 1) % columns);
  }
  for (auto& t : shape.triangles) std::swap(t[1], t[2]);
  return shape;
}

Shape make_torus(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t minor = std::max(3U, side_of(triangles) / dice.between(1, 4));
  const std::uint32_t major = std::max(3U, triangles / (2 * minor));
  const double tube = dice.octaves(-8, 0) * 0.5;
  const double noise = dice.chance(0.4) ? tube * dice.octaves(-6, 0) : 0.0;
  add_grid(shape, {major, minor, true, true}, [&](std::uint32_t i, std::uint32_t j) {
    const double a = share(i, major), b = share(j, minor);
    const double radius = 1.0 + tube * lab::cos_turns(b);
    return Vec3d(radius * lab::cos_turns(a), tube * lab::sin_turns(b), radius * lab::sin_turns(a)) + dice.vector(noise);
  });
  return shape;
}

/// Two sheets back to back: as thin as one likes, noise from far below to far above the thickness, closed at the rim or
/// not.
Shape make_double_sheet(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(triangles / 2);
  const Relief relief(dice);
  const double thickness = dice.octaves(-16, -3);
  const double noise = thickness * dice.octaves(-5, 4);
  const bool is_closed = dice.chance(0.5);
  std::uint32_t sides[2];
  for (std::uint32_t side = 0; side < 2; ++side) {
    Dice hills(relief.seed);  // the same hills on both sides
    sides[side] = add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) {
      const double x = share(i, n), y = share(j, n);
      return Vec3d(x, relief.at(x, y, hills) + thickness * side + noise * dice.signed_unit(), y);
    });
  }
  const std::size_t half = shape.triangles.size() / 2;
  for (std::size_t t = half; t < shape.triangles.size(); ++t) std::swap(shape.triangles[t][1], shape.triangles[t][2]);
  if (!is_closed) return shape;
  lab::for_each_rim_edge(
      n, [&](std::uint32_t a, std::uint32_t b) { shape.quad(sides[0] + b, sides[0] + a, sides[1] + a, sides[1] + b); });
  return shape;
}

Shape make_tubes(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t around = dice.between(3, 9), along = dice.between(1, 16);
  const std::uint32_t each = 2 * around * along + 2 * (around - 2);
  const double radius = dice.octaves(-11, -3);
  const bool is_closed = dice.chance(0.6);
  for (std::uint32_t k = 0; k < std::max(1U, triangles / each); ++k) {
    const Vec3d start = dice.vector(0.7), axis = dice.direction();
    const auto [u, w] = frame_of(axis);
    const double length = dice.range(0.1, 1.0), bend = dice.range(0.0, 0.1);
    const std::uint32_t first =
        add_grid(shape, {around, along, true, false}, [&, u = u, w = w](std::uint32_t i, std::uint32_t j) {
          const double t = share(j, along), a = share(i, around);
          return start + axis * (length * t) + u * (bend * lab::sin_turns(t) + radius * lab::cos_turns(a)) +
                 w * (radius * lab::sin_turns(a));
        });
    if (!is_closed) continue;
    const std::uint32_t last = first + along * around;
    for (std::uint32_t s = 1; s + 1 < around; ++s) {
      shape.triangle(first, first + s + 1, first + s);
      shape.triangle(last, last + s, last + s + 1);
    }
  }
  return shape;
}

/// What a modeller exports: sides of one tall quad each, caps cut as a fan, a strip, or round a middle point.
Shape make_cylinder(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = std::max(3U, triangles / 4);
  const double height = dice.octaves(-8, 5);
  std::uint32_t rings[2];
  for (std::uint32_t side = 0; side < 2; ++side) {
    rings[side] = static_cast<std::uint32_t>(shape.points.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      shape.add({lab::cos_turns(share(i, n)), height * side, lab::sin_turns(share(i, n))});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    shape.quad(rings[0] + i, rings[1] + i, rings[1] + next, rings[0] + next);
  }
  const std::uint64_t caps = dice.below(4);
  for (std::uint32_t side = 0; side < 2 && caps < 3; ++side) {
    const std::size_t first = shape.triangles.size();
    const std::uint32_t ring = rings[side];
    if (caps == 0) {
      for (std::uint32_t i = 1; i + 1 < n; ++i) shape.triangle(ring, ring + i, ring + i + 1);
    } else if (caps == 1) {
      for (std::uint32_t low = 0, high = n - 1; low + 1 < high;) {
        shape.triangle(ring + low, ring + low + 1, ring + high);
        if (++low + 1 >= high) break;
        shape.triangle(ring + low, ring + high - 1, ring + high);
        --high;
      }
    } else {
      const std::uint32_t middle = shape.add({0.0, height * side, 0.0});
      for (std::uint32_t i = 0; i < n; ++i) shape.triangle(middle, ring + i, ring + (i + 1) % n);
    }
    if (side == 1) {
      for (std::size_t t = first; t < shape.triangles.size(); ++t)
        std::swap(shape.triangles[t][1], shape.triangles[t][2]);
    }
  }
  return shape;
}

/// The surface of random blocks: edges of four triangles and pinched vertices where blocks touch askew.
Shape make_blocks(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  std::uint32_t side = 1;
  while (6 * (side + 1) * (side + 1) * (side + 1) < triangles * 2 && side < 20) ++side;
  const double fill = dice.range(0.15, 0.85);
  std::vector<std::uint8_t> solid(std::size_t{side} * side * side);
  for (auto& cell : solid) cell = dice.chance(fill) ? 1 : 0;
  const auto is_solid = [&](int x, int y, int z) {
    const int n = static_cast<int>(side);
    const int index = (z * n + y) * n + x;
    return x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n && solid[static_cast<std::size_t>(index)] != 0;
  };
  std::map<std::array<int, 3>, std::uint32_t> corners;
  const double scale = 1.0 / side;
  const auto corner = [&](int x, int y, int z) {
    const auto [it, is_new] = corners.try_emplace({x, y, z}, 0U);
    if (is_new) it->second = shape.add(Vec3d(x, y, z) * scale);
    return it->second;
  };
  const int n = static_cast<int>(side);
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        if (!is_solid(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (int up = 0; up < 2; ++up) {
            std::array<int, 3> beside{x, y, z};
            beside[static_cast<std::size_t>(axis)] += up == 1 ? 1 : -1;
            if (is_solid(beside[0], beside[1], beside[2])) continue;
            std::uint32_t c[4];
            for (int k = 0; k < 4; ++k) {
              std::array<int, 3> p{x, y, z};
              p[static_cast<std::size_t>(axis)] += up;
              p[static_cast<std::size_t>((axis + 1) % 3)] += k == 1 || k == 2 ? 1 : 0;
              p[static_cast<std::size_t>((axis + 2) % 3)] += k >= 2 ? 1 : 0;
              c[k] = corner(p[0], p[1], p[2]);
            }
            if (up == 1) {
              shape.quad(c[0], c[1], c[2], c[3]);
            } else {
              shape.quad(c[0], c[3], c[2], c[1]);
            }
          }
        }
      }
    }
  }
  if (shape.triangles.empty()) {
    for (const Vec3d& p : {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}) shape.add(p);
    shape.triangle(0, 1, 2);
  }
  return shape;
}

// -------------------------------------------------------------------------------------------------------- open
// surfaces

/// Hills with holes; where two holes touch, the border is pinched.
Shape make_patch(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(triangles);
  const Relief relief(dice);
  const double holes = dice.chance(0.6) ? dice.range(0.0, 0.4) : 0.0;
  add_grid(
      shape, {n, n},
      [&](std::uint32_t i, std::uint32_t j) {
        const double x = share(i, n), y = share(j, n);
        return Vec3d(x, relief.at(x, y, dice), y);
      },
      [&](std::uint32_t, std::uint32_t) { return !dice.chance(holes); });
  return shape;
}

/// Cells like a chess board, in blocks of random size: every inner vertex a pinch.
Shape make_chess_board(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(2 * triangles), block = dice.between(1, 3);
  const Relief relief(dice);
  const double wrong = dice.chance(0.5) ? 0.05 : 0.0;
  add_grid(
      shape, {n, n},
      [&](std::uint32_t i, std::uint32_t j) {
        const double x = share(i, n), y = share(j, n);
        return Vec3d(x, 0.1 * relief.at(x, y, dice), y);
      },
      [&](std::uint32_t i, std::uint32_t j) { return ((i / block + j / block) % 2 == 0) != dice.chance(wrong); });
  return shape;
}

/// A plate with walled holes: many handles.
Shape make_plate(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = std::max(3U, side_of(triangles / 3)), pitch = dice.between(2, 6);
  const double thickness = dice.octaves(-12, -2);
  const bool is_open = dice.chance(0.2);
  const auto is_hole = [&](int i, int j) {
    const int size = static_cast<int>(n), p = static_cast<int>(pitch);
    return i < 0 || j < 0 || i >= size || j >= size || (i % p == 1 && j % p == 1);
  };
  std::map<std::array<int, 3>, std::uint32_t> corners;
  const auto corner = [&](int i, int j, int side) {
    const auto [it, is_new] = corners.try_emplace({i, j, side}, 0U);
    if (is_new) it->second = shape.add({i / static_cast<double>(n), thickness * side, j / static_cast<double>(n)});
    return it->second;
  };
  const auto wall = [&](int i, int j, int k, int l) {
    if (!is_open) shape.quad({corner(i, j, 0), corner(i, j, 1), corner(k, l, 1), corner(k, l, 0)});
  };
  for (int j = 0; j < static_cast<int>(n); ++j) {
    for (int i = 0; i < static_cast<int>(n); ++i) {
      if (is_hole(i, j)) continue;
      shape.quad({corner(i, j, 1), corner(i, j + 1, 1), corner(i + 1, j + 1, 1), corner(i + 1, j, 1)});
      shape.quad({corner(i, j, 0), corner(i + 1, j, 0), corner(i + 1, j + 1, 0), corner(i, j + 1, 0)});
      if (is_hole(i, j - 1)) wall(i, j, i + 1, j);
      if (is_hole(i, j + 1)) wall(i + 1, j + 1, i, j + 1);
      if (is_hole(i - 1, j)) wall(i, j + 1, i, j);
      if (is_hole(i + 1, j)) wall(i + 1, j, i + 1, j + 1);
    }
  }
  return shape;
}

Shape make_moebius(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t m = std::max(1U, side_of(triangles) / dice.between(2, 8)), n = std::max(3U, triangles / (2 * m));
  const std::uint32_t twists = dice.between(1, 3);
  const double width = dice.octaves(-6, 0) * 0.5;
  const auto place = [&](std::uint32_t i, std::uint32_t j) {
    const double a = share(i, n), across = width * (2.0 * share(j, m) - 1.0);
    const double radius = 1.0 + across * lab::cos_turns(0.5 * twists * a);
    return Vec3d(radius * lab::cos_turns(a), across * lab::sin_turns(0.5 * twists * a), radius * lab::sin_turns(a));
  };
  const std::uint32_t first = add_grid(shape, {n - 1, m}, place);
  const bool is_turned = twists % 2 == 1;
  for (std::uint32_t j = 0; j < m; ++j) {
    const auto start = [&](std::uint32_t row) { return first + (is_turned ? m - row : row) * n; };
    const std::uint32_t end = first + j * n + n - 1;
    shape.quad(end, start(j), start(j + 1), end + n);
  }
  return shape;
}

/// Terraces: heights in steps, so that walls are steep or, where the steps fold over, without area.
Shape make_terraces(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(triangles), steps = dice.between(2, 12);
  const std::uint64_t seed = dice.next();
  const double waves = dice.range(1.0, 5.0), noise = dice.chance(0.3) ? dice.octaves(-20, -6) : 0.0;
  add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) {
    const double x = share(i, n), y = share(j, n);
    const double height = lab::fractal_noise({waves * x, waves * y, 0.5}, 3, seed);
    return Vec3d(x, std::floor(height * steps) / steps + noise * dice.signed_unit(), y);
  });
  return shape;
}

/// A small dense patch beside huge loose quads.
Shape make_patch_and_quads(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t quads = std::min(triangles / 4 + 1, dice.between(1, 60));
  const std::uint32_t n = side_of(triangles - std::min(triangles, 2 * quads) + 2);
  const double size = dice.octaves(-10, -4), bumps = size * dice.octaves(-6, 0);
  const std::uint64_t seed = dice.next();
  add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) {
    const double x = share(i, n), y = share(j, n);
    return Vec3d(size * x, bumps * lab::value_noise({7.0 * x, 7.0 * y, 0.5}, seed), size * y);
  });
  for (std::uint32_t k = 0; k < quads; ++k) {
    const Vec3d place = dice.vector(1.0), u = dice.vector(0.5), v = dice.vector(0.5);
    const Vec3d corners[] = {place, place + u + dice.vector(0.1), place + u + v, place + v + dice.vector(0.1)};
    std::uint32_t c[4];
    for (int i = 0; i < 4; ++i) c[i] = shape.add(corners[i]);
    shape.quad(c[0], c[1], c[2], c[3]);
  }
  return shape;
}

/// Strips of different density side by side: they meet in some vertices and in T-junctions.
Shape make_t_junctions(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t strips = dice.between(2, 6);
  const double gap = dice.chance(0.3) ? dice.octaves(-24, -10) : 0.0;
  const Relief relief(dice);
  for (std::uint32_t s = 0; s < strips; ++s) {
    const std::uint32_t budget = std::max(2U, triangles / strips / (1U << dice.below(4)));
    const std::uint32_t columns = std::max(1U, side_of(budget) / strips), rows = std::max(1U, budget / (2 * columns));
    add_grid(shape, {columns, rows}, [&](std::uint32_t i, std::uint32_t j) {
      const double x = (s + (1.0 - gap) * share(i, columns)) / strips, y = share(j, rows);
      return Vec3d(x, relief.hills * lab::value_noise({3.0 * x, 3.0 * y, 0.5}, relief.seed), y);
    });
  }
  return shape;
}

/// Rows ever closer to each other, down to a millionth: a triangle's neighbour is as unlike it as one can be.
Shape make_graded(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(triangles), rows = std::max(1U, triangles / (2 * n));
  const double shrink = dice.range(0.5, 0.95);
  std::vector<double> heights{1.0};
  for (std::uint32_t j = 0; j < rows; ++j) heights.push_back(std::max(heights.back() * shrink, 1e-9));
  const double bumps = dice.octaves(-12, -2);
  add_grid(shape, {n, rows}, [&](std::uint32_t i, std::uint32_t j) {
    return Vec3d(share(i, n), bumps * dice.signed_unit() * heights[j], heights[j]);
  });
  return shape;
}

Shape make_nails(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t n = side_of(triangles * 3 / 4);
  const double rate = dice.range(0.02, 0.5), height = dice.octaves(-4, 2);
  const std::uint32_t first = add_grid(
      shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) { return Vec3d(share(i, n), 0.0, share(j, n)); },
      [](std::uint32_t, std::uint32_t) { return false; });
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = first + j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      if (dice.chance(rate)) {
        const double x = (i + dice.unit()) / n, z = (j + dice.unit()) / n;
        const std::uint32_t tip = shape.add({x, height * dice.unit(), z});
        for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)}) {
          shape.triangle(p, q, tip);
        }
      } else {
        shape.quad(a, b, c, d);
      }
    }
  }
  return shape;
}

// --------------------------------------------------------------------------------------------------------- loose
// pieces

Shape make_cards(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const double spread = dice.octaves(-2, 4), size = dice.octaves(-5, 0);
  const bool one_size = dice.chance(0.5);
  for (std::uint32_t k = 0; k < std::max(1U, triangles / 2); ++k) {
    const double own = one_size ? size : size * dice.octaves(-6, 0);
    const Vec3d middle = dice.vector(spread), u = dice.vector(own), v = dice.vector(own);
    std::uint32_t c[4];
    int i = 0;
    for (const Vec3d& corner : {middle - u - v, middle + u - v, middle + u + v, middle - u + v})
      c[i++] = shape.add(corner);
    shape.quad(c[0], c[1], c[2], c[3]);
  }
  return shape;
}

Shape make_soup(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const bool one_size = dice.chance(0.5);
  for (std::uint32_t k = 0; k < triangles; ++k) {
    const double size = one_size ? 0.2 : dice.octaves(-12, 1);
    const Vec3d middle = dice.vector(1.0);
    std::uint32_t c[3];
    for (std::uint32_t& corner : c) corner = shape.add(middle + dice.vector(size));
    shape.triangle(c[0], c[1], c[2]);
  }
  return shape;
}

/// Triangles far longer than wide: loose, or along the edges of a ball.
Shape make_needles(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const int thinnest = -static_cast<int>(dice.between(6, 24));
  const bool on_ball = dice.chance(0.5);
  if (on_ball) shape = make_ball(dice, triangles / 2 + 4);
  const std::size_t edges = shape.triangles.size();
  for (std::uint32_t k = 0; k < (on_ball ? triangles / 2 : triangles) + 1; ++k) {
    std::uint32_t a, b;
    if (on_ball) {
      const auto& t = shape.triangles[dice.below(edges)];
      a = t[0];
      b = t[1];
    } else {
      a = shape.add(dice.vector(1.0));
      b = shape.add(shape.points[a] + dice.vector(0.5));
    }
    const double width = dice.octaves(thinnest, thinnest + 6);
    const double along = dice.chance(0.5) ? 0.0 : dice.range(-0.2, 1.2);
    const Vec3d foot = shape.points[a] + along * (shape.points[b] - shape.points[a]);
    const std::uint32_t c = shape.add(foot + dice.vector(width));
    shape.triangle(a, b, c);
  }
  return shape;
}

/// Zero-area triangles that stick out of a ball: they draw nothing and must not count as surface.
Shape make_hair(Dice& dice, std::uint32_t triangles) {
  Shape shape = make_ball(dice, triangles);
  const std::size_t on_ball = shape.points.size();
  const std::uint32_t hairs = dice.between(1, 1 + triangles / 8);
  for (std::uint32_t k = 0; k < hairs; ++k) {
    const auto root = static_cast<std::uint32_t>(dice.below(on_ball));
    const std::uint32_t tip = shape.add(shape.points[root] * dice.octaves(0, 4));
    if (dice.chance(0.5)) {
      shape.triangle(root, tip, tip);
    } else {  // halfway is exact: the sum is halved
      const std::uint32_t middle = shape.add(0.5 * (shape.points[root] + shape.points[tip]));
      shape.triangle(root, middle, tip);
    }
  }
  return shape;
}

/// Points on one line, exactly: no area anywhere.
Shape make_line(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  for (std::uint32_t k = 0; k < triangles; ++k) {
    std::uint32_t c[3];
    for (std::uint32_t& corner : c) {
      const double t = static_cast<double>(dice.between(0, 1U << 20)) / (1U << 20);
      corner = shape.add({t, 2.0 * t, -t});
    }
    shape.triangle(c[0], c[1], c[2]);
  }
  return shape;
}

// ---------------------------------------------------------------------------------------------------------- joints

/// Pages that share their spine, an edge or a line of edges.
Shape make_book(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t pages = std::min(dice.between(3, 40), std::max(3U, triangles));
  const std::uint32_t n = side_of(std::max(2U, triangles / pages));
  const bool shares_points = dice.chance(0.7);
  std::vector<std::uint32_t> spine;
  for (std::uint32_t j = 0; j <= n; ++j) spine.push_back(shape.add({0.0, share(j, n), 0.0}));
  const double noise = dice.chance(0.5) ? dice.octaves(-12, -4) : 0.0;
  for (std::uint32_t p = 0; p < pages; ++p) {
    const double a = dice.unit();
    const bool is_turned = dice.chance(0.5);
    const std::size_t before = shape.triangles.size();
    const std::uint32_t first = add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) {
      if (i == 0) return shape.points[spine[j]];
      return Vec3d(share(i, n) * lab::cos_turns(a), share(j, n), share(i, n) * lab::sin_turns(a)) + dice.vector(noise);
    });
    for (std::size_t t = before; t < shape.triangles.size(); ++t) {
      for (std::uint32_t& v : shape.triangles[t]) {
        if (shares_points && v >= first && (v - first) % (n + 1) == 0) v = spine[(v - first) / (n + 1)];
      }
      if (is_turned) std::swap(shape.triangles[t][1], shape.triangles[t][2]);
    }
  }
  return shape;
}

/// Patches that share one corner.
Shape make_bouquet(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t patches = std::min(dice.between(2, 60), std::max(2U, triangles / 2));
  const std::uint32_t n = side_of(std::max(2U, triangles / patches));
  const std::uint32_t middle = shape.add({0.0, 0.0, 0.0});
  for (std::uint32_t p = 0; p < patches; ++p) {
    const Vec3d u = dice.direction(), v = dice.direction();
    const std::size_t before = shape.triangles.size();
    const std::uint32_t first =
        add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) { return share(i, n) * u + share(j, n) * v; });
    for (std::size_t t = before; t < shape.triangles.size(); ++t) {
      for (std::uint32_t& corner : shape.triangles[t]) corner = corner == first ? middle : corner;
    }
  }
  return shape;
}

/// One vertex in the middle of as many triangles as there are; one cone, two at their tips, or a flat wheel.
Shape make_wheel(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t cones = dice.between(1, 2), n = std::max(3U, triangles / cones);
  const double height = dice.chance(0.3) ? 0.0 : dice.octaves(-8, 2);
  const std::uint32_t tip = shape.add({0.0, 0.0, 0.0});
  for (std::uint32_t c = 0; c < cones; ++c) {
    const auto first = static_cast<std::uint32_t>(shape.points.size());
    const double noise = dice.chance(0.3) ? dice.octaves(-8, -2) : 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double side = c == 0 ? height : -height;
      shape.add(Vec3d(lab::cos_turns(share(i, n)), side, lab::sin_turns(share(i, n))) + dice.vector(noise));
    }
    for (std::uint32_t i = 0; i < n; ++i) shape.triangle(tip, first + i, first + (i + 1) % n);
  }
  return shape;
}

/// Triangles between random points of a small lattice: non-manifold everywhere, duplicates and degenerates of chance.
Shape make_lattice(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t side = dice.between(2, 9);
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) shape.add(Vec3d(x, y, z) / static_cast<double>(side));
    }
  }
  for (std::uint32_t k = 0; k < triangles; ++k) {
    std::uint32_t c[3];
    for (std::uint32_t& corner : c) corner = static_cast<std::uint32_t>(dice.below(shape.points.size()));
    shape.triangle(c[0], c[1], c[2]);
  }
  return shape;
}

/// A sheet of which some triangles are there from both sides.
Shape make_two_faced(Dice& dice, std::uint32_t triangles) {
  Shape shape = make_patch(dice, triangles * 2 / 3);
  const double rate = dice.chance(0.4) ? 1.0 : dice.unit();
  const std::size_t count = shape.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const auto [a, b, c] = shape.triangles[t];
    if (dice.chance(rate)) shape.triangle(a, c, b);
  }
  return shape;
}

/// Layers so close to each other that the grid cannot tell them apart.
Shape make_layers(Dice& dice, std::uint32_t triangles) {
  Shape shape;
  const std::uint32_t layers = dice.between(2, 8), n = side_of(triangles / layers);
  const double gap = dice.octaves(-26, -12);
  const Relief relief(dice);
  for (std::uint32_t k = 0; k < layers; ++k) {
    const bool slips = dice.chance(0.3);
    add_grid(shape, {n, n}, [&](std::uint32_t i, std::uint32_t j) {
      const double x = share(i, n), y = share(j, n);
      const double hill = relief.hills * lab::value_noise({3.0 * x, 3.0 * y, 0.5}, relief.seed);
      return Vec3d(x + (slips ? gap * dice.signed_unit() : 0.0), hill + gap * k, y);
    });
  }
  return shape;
}

/// Coordinates at the bottom of what floats hold: denormals, zeros of both signs, beside ordinary ones.
Shape make_tiny_numbers(Dice& dice, std::uint32_t triangles) {
  Shape shape = make_patch(dice, triangles);
  const double tiny = dice.chance(0.5) ? 1e-40 : 1e-44;
  for (Vec3d& p : shape.points) {
    for (int k = 0; k < 3; ++k) {
      if (dice.chance(0.1)) p[k] = tiny * dice.signed_unit();
      if (dice.chance(0.1)) p[k] = dice.chance(0.5) ? -0.0 : 0.0;
    }
  }
  return shape;
}

/// The same surface twice or more, with points of its own each, in the same place or a hair beside it.
Shape make_echoes(Dice& dice, std::uint32_t triangles) {
  const std::uint32_t copies = dice.between(2, 5);
  const Shape one =
      dice.chance(0.5) ? make_patch(dice, triangles / copies + 2) : make_ball(dice, triangles / copies + 2);
  const double beside = dice.chance(0.5) ? 0.0 : dice.octaves(-26, -8);
  Shape shape = one;
  for (std::uint32_t k = 1; k < copies; ++k) {
    Shape other = one;
    const Vec3d move = dice.vector(beside);
    for (Vec3d& p : other.points) p += move;
    shape.append(other);
  }
  return shape;
}

constexpr ShapeKind kKinds[] = {
    {"ball", make_ball},
    {"torus", make_torus},
    {"patch", make_patch},
    {"double sheet", make_double_sheet},
    {"cards", make_cards},
    {"needles", make_needles},
    {"book", make_book},
    {"bouquet", make_bouquet},
    {"soup", make_soup},
    {"tubes", make_tubes},
    {"cylinder", make_cylinder},
    {"blocks", make_blocks},
    {"chess board", make_chess_board},
    {"plate", make_plate},
    {"moebius", make_moebius},
    {"terraces", make_terraces},
    {"patch and quads", make_patch_and_quads},
    {"t-junctions", make_t_junctions},
    {"graded", make_graded},
    {"nails", make_nails},
    {"hair", make_hair},
    {"line", make_line},
    {"wheel", make_wheel},
    {"lattice", make_lattice},
    {"two-faced", make_two_faced},
    {"layers", make_layers},
    {"tiny numbers", make_tiny_numbers},
    {"echoes", make_echoes},
};

void double_triangles(Shape& shape, Dice& dice) {
  const double rate = dice.octaves(-8, -1);
  const bool may_face_away = dice.chance(0.3);
  const std::size_t count = shape.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    if (!dice.chance(rate)) continue;
    auto copy = shape.triangles[t];
    std::rotate(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(dice.below(3)), copy.end());
    if (may_face_away && dice.chance(0.5)) std::swap(copy[1], copy[2]);
    if (dice.chance(0.3)) {  // on points of its own
      for (std::uint32_t& v : copy) v = shape.add(Vec3d(shape.points[v]));
    }
    shape.triangles.push_back(copy);
  }
}

void add_degenerates(Shape& shape, Dice& dice) {
  const double rate = dice.octaves(-8, -1);
  const std::size_t count = shape.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    if (!dice.chance(rate)) continue;
    const auto [a, b, c] = shape.triangles[t];
    switch (dice.below(4)) {
      case 0: shape.triangle(a, a, b); break;
      case 1: shape.triangle(a, shape.add(Vec3d(shape.points[a])), c); break;
      case 2: shape.triangle(a, shape.add(0.5 * (shape.points[a] + shape.points[b])), b); break;
      default: shape.triangle(a, b, static_cast<std::uint32_t>(dice.below(shape.points.size()))); break;
    }
  }
}

}  // namespace

void Shape::append(const Shape& other) {
  const auto first = static_cast<std::uint32_t>(points.size());
  points.insert(points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) triangle(first + a, first + b, first + c);
}

std::span<const ShapeKind> shape_kinds() {
  return kKinds;
}

void damage(Shape& shape, Dice& dice) {
  if (dice.chance(0.5)) return;
  if (dice.chance(0.3)) {
    const double size = dice.octaves(-24, -4);
    for (Vec3d& p : shape.points) p += dice.vector(size);
  }
  if (dice.chance(0.15)) {
    const double lattice = dice.octaves(3, 9);
    for (Vec3d& p : shape.points) {
      for (int k = 0; k < 3; ++k) p[k] = std::floor(p[k] * lattice + 0.5) / lattice;
    }
  }
  if (dice.chance(0.4)) double_triangles(shape, dice);
  if (dice.chance(0.4)) add_degenerates(shape, dice);
  if (dice.chance(0.15)) {  // holes of one triangle
    const double rate = dice.octaves(-6, -1);
    std::erase_if(shape.triangles, [&](const auto&) { return dice.chance(rate); });
  }
  if (dice.chance(0.1)) {  // no order that a neighbour could be guessed from
    for (std::size_t i = shape.triangles.size(); i > 1; --i)
      std::swap(shape.triangles[i - 1], shape.triangles[dice.below(i)]);
  }
}

}  // namespace meshlode::test
