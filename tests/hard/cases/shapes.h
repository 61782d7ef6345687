// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that several cases start from, and what lab/samples and tests/builder/odd_shapes.h do not have. No math
// library but sqrt, floor and ldexp: a parameter gives the same bits with every compiler.
#pragma once

#include <cstdint>
#include <functional>

#include "scene/scene.h"

namespace meshlode::test::hard {

/// `columns` x `rows` cells of the unit square, each corner placed by `place(u, v)`; where `closes_u` or `closes_v` the
/// last column or row of vertices is the first. 2 triangles a cell.
[[nodiscard]] scene::Primitive make_sheet(std::uint32_t columns, std::uint32_t rows, bool closes_u, bool closes_v,
                                          const std::function<Vec3d(double u, double v)>& place);
/// A square of side 1 in the xz plane with a bump of `height` in every other vertex. 2·n² triangles.
[[nodiscard]] scene::Primitive make_bumpy_plane(std::uint32_t n, double height);
/// A closed sphere with bumps of `height`: a shape without symmetries and without flat parts. 12·n² triangles.
[[nodiscard]] scene::Primitive make_lump(std::uint32_t n, double height = 0.1);
/// Klein's bottle as an immersion: closed, not orientable, crosses itself in a circle. 2·n² triangles.
[[nodiscard]] scene::Primitive make_klein(std::uint32_t n);

/// Every position by `map`, indices and attributes as they were.
[[nodiscard]] scene::Primitive mapped(scene::Primitive shape, const std::function<Vec3d(const Vec3d&)>& map);
/// Both shapes in one primitive; attributes are given up.
[[nodiscard]] scene::Primitive joined(const scene::Primitive& a, const scene::Primitive& b);
/// The same shape inside out.
[[nodiscard]] scene::Primitive turned(scene::Primitive shape);

}  // namespace meshlode::test::hard
