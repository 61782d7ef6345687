// SPDX-License-Identifier: GPL-3.0-or-later
// Large, small, both at once, and in one direction only.
#include <cmath>

#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

Result<Sample> scaled_lump(double factor) {
  return sample_of(lab::scaled(make_lump(12), factor));
}

/// A lump `factor` times as large as the one beside it, in one mesh.
Result<Sample> two_sizes(double factor) {
  const scene::Primitive small = make_lump(10);
  const scene::Primitive large = mapped(lab::scaled(make_lump(10), factor),
                                        [&](const Vec3d& p) { return p + Vec3d(2.0 * factor + 2.0, 0.0, 0.0); });
  Sample sample = sample_of(joined(small, large));
  sample.feature = 0.1;  // of the small one's bumps
  return sample;
}

Result<Sample> stretched(double factor) {
  Sample sample = sample_of(mapped(make_lump(14), [&](const Vec3d& p) { return Vec3d(p.x * factor, p.y, p.z); }));
  sample.feature = 0.1;
  return sample;
}

}  // namespace

std::vector<HardCase> scale_cases() {
  return {
      {.room = "scale",
       .name = "large",
       .parameter = "size, units",
       .sweep = {1e0, 1e9, 1e18, 1e27, 1e34, 1e38, 1e100, 1e160, 1e300},
       .is_quick = true,
       .make = scaled_lump},
      {.room = "scale",
       .name = "small",
       .parameter = "size, units",
       .sweep = {1e0, 1e-9, 1e-18, 1e-27, 1e-34, 1e-38, 1e-45, 1e-160, 1e-300},
       .is_quick = false,
       .make = scaled_lump},
      {.room = "scale",
       .name = "two-sizes",
       .parameter = "size of one of two bodies, in the other's",
       .sweep = {1e0, 1e2, 1e4, 1e6, 1e9, 1e12},
       .is_quick = false,
       .make = two_sizes},
      {.room = "scale",
       .name = "anisotropic",
       .parameter = "length over width",
       .sweep = {1e0, 1e2, 1e4, 1e6, 1e9, 1e12},
       .is_quick = true,
       .make = stretched},
  };
}

}  // namespace meshlode::test::hard
