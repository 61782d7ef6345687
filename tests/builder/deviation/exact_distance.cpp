// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/exact_distance.h"

#include <CGAL/MP_Float.h>
#include <CGAL/Quotient.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>

namespace meshlode::test {

using Number = CGAL::Quotient<CGAL::MP_Float>;
using Kernel = CGAL::Simple_cartesian<Number>;

bool is_within_exactly(const Vec3d& point, const builder::TriangleCorners& triangle, double distance) {
  const auto exact = [](const Vec3d& p) { return Kernel::Point_3(Number(p.x), Number(p.y), Number(p.z)); };
  const Kernel::Triangle_3 corners(exact(triangle[0]), exact(triangle[1]), exact(triangle[2]));
  return CGAL::squared_distance(exact(point), corners) <= Number(distance) * Number(distance);
}

}  // namespace meshlode::test
