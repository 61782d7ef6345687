// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes that break builders and that samples/ does not have.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace meshlode::test {

/// One vertex in the middle of `valence` triangles.
[[nodiscard]] scene::Primitive make_fan(std::uint32_t valence);
/// The same triangle `count` times, on the same vertices.
[[nodiscard]] scene::Primitive make_identical(std::uint32_t count);
/// One triangle.
[[nodiscard]] scene::Primitive make_triangle();
/// A plane of `n` x `n` cells cut into `materials` stripes, a primitive each, in one mesh with that many materials.
[[nodiscard]] scene::Scene make_striped_plane(std::uint32_t n, std::uint32_t materials);
/// `sheets` spheres in the same place, each with vertices of its own: everything coincides, nothing is shared.
[[nodiscard]] scene::Primitive make_coincident_spheres(std::uint32_t n, std::uint32_t sheets);
/// All corners of `count` triangles are random points on one line.
[[nodiscard]] scene::Primitive make_line_of_triangles(std::uint32_t count);
/// Rings that are many steps of the grid long and less than one wide, beside a patch 600 times their size; every
/// seventh triangle once more from behind, every eleventh with a corner repeated.
[[nodiscard]] scene::Primitive make_fine_rings_beside_a_patch(std::uint64_t seed);
/// A ball, and triangles without area that stick out of it by twice its radius: with two corners at one place, with
/// three on a line, and in a chain. Its level 0 is the ball.
[[nodiscard]] scene::Primitive make_ball_with_hairs();
/// A closed cube whose top has its edges cut by vertices that the sides have not: triangles without area close it.
[[nodiscard]] scene::Primitive make_cube_with_t_junctions();
/// Loose parallelograms of all sizes and directions: some are parted by a border between clusters.
[[nodiscard]] scene::Primitive make_cards(std::uint32_t count, std::uint64_t seed);
/// `count` triangles between random points of a small lattice: non-manifold everywhere, in every way.
[[nodiscard]] scene::Primitive make_lattice_chaos(std::uint32_t count, std::uint32_t side, std::uint64_t seed);

}  // namespace meshlode::test
