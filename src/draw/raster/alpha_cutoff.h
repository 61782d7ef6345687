// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a masked triangle is there at a pixel: its texel, found so that another machine finds the same (I9). Doubles
// with
// + - * in a fixed order; every quotient is an integer that is defined by multiplications.
//
// The weights of a triangle's corners at a picture point p are those of sum(b · (x, y, w)) ∝ (p, 1),
// perspective-correct and right across the near plane too. Corners are moved so that p is the origin: then b0 ∝ x1 y2 -
// x2 y1, and so on. UVs are weighed as grid integers, and texel i is the one with i · S <= U < (i + 1) · S in rounded
// products, S the sum of the weights: rounding is monotone, so there is exactly one.
#pragma once

#include <cstdint>
#include <optional>

#include "draw/raster/masked_triangle.h"
#include "draw/raster/projection.h"
#include "draw/textures/alpha_mask.h"
#include "run/decode/decode.h"

namespace meshlode::draw {

/// Nothing where the triangle's material is not masked. `masks` has to outlive what is returned.
[[nodiscard]] std::optional<MaskedTriangle> find_mask(const AlphaMasks& masks, const format::MeshRecord& mesh,
                                                      const run::DecodedCluster& cluster, std::uint32_t triangle,
                                                      const GridToClip& to_clip);

/// `px`, `py`: from the picture's middle, a pixel's centre.
[[nodiscard]] bool passes_alpha(const MaskedTriangle& triangle, double px, double py);

/// The i with i · divisor <= value < (i + 1) · divisor in rounded products, 0 where |i| would pass 2^46.
/// \pre divisor > 0 and finite
[[nodiscard]] std::int64_t floor_quotient(double value, double divisor);

}  // namespace meshlode::draw
