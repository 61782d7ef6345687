// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/cgal_distance.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

namespace meshlode::test {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

struct CgalDistance::Tree {
  Triangles triangles;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree;
};

CgalDistance::CgalDistance(const judge::Surface& surface) : tree_(std::make_unique<Tree>()) {
  const auto point = [&](std::uint32_t i) {
    const Vec3d& p = surface.positions[i];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  for (const auto& t : surface.triangles) tree_->triangles.emplace_back(point(t[0]), point(t[1]), point(t[2]));
  tree_->tree.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->tree.build();
}

CgalDistance::~CgalDistance() = default;

double CgalDistance::distance2(const Vec3d& p) const {
  return tree_->tree.squared_distance(Kernel::Point_3(p.x, p.y, p.z));
}

}  // namespace meshlode::test
