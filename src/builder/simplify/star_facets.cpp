// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/star_facets.h"

#include <algorithm>
#include <array>
#include <limits>

namespace meshlode::builder {

void StarFacets::start(const Vec3d& origin) {
  origin_ = origin;
  count_ = 0;
}

void StarFacets::add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  if (count_ / 4 == blocks_.size()) blocks_.emplace_back();
  blocks_[count_ / 4].triangles.set(count_ % 4, Vec3f(a - origin_), Vec3f(b - a), Vec3f(c - a));
  ++count_;
}

void StarFacets::finish() {
  if (count_ == 0) return;
  FourTriangles& last = blocks_[(count_ - 1) / 4].triangles;
  for (std::size_t k = (count_ - 1) % 4; k < 3; ++k) {  // repeated: that changes no minimum
    for (std::size_t axis = 0; axis < 3; ++axis) {
      last.a[axis][k + 1] = last.a[axis][k];
      last.ab[axis][k + 1] = last.ab[axis][k];
      last.ac[axis][k + 1] = last.ac[axis][k];
    }
  }
  for (std::size_t i = 0; 4 * i < count_; ++i) blocks_[i].terms = terms_of(blocks_[i].triangles);
}

MESHLODE_CLONED_FOR_AVX2
float StarFacets::distance2_to(const Vec3d& point, float enough) const {
  const Vec3f at(point - origin_);
  const Vec3Lanes p{lanes(at.x), lanes(at.y), lanes(at.z)};
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; 4 * i < count_ && !(nearest <= enough); ++i) {
    const Lanes distance2 = distances2_to(blocks_[i].triangles, blocks_[i].terms, p);
    nearest = std::min(std::min(std::min(distance2[0], distance2[1]), std::min(distance2[2], distance2[3])), nearest);
  }
  return nearest;
}

MESHLODE_CLONED_FOR_AVX2
void StarFacets::distances2_one_by_one(std::span<const Vec3d> points, std::vector<float>& out) const {
  out.resize((points.size() + 3) / 4 * 4);
  for (std::size_t i = 0; 4 * i < points.size(); ++i) {
    std::array<float, 4> x, y, z;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3f at(points[std::min(4 * i + k, points.size() - 1)] - origin_);
      x[k] = at.x;
      y[k] = at.y;
      z[k] = at.z;
    }
    const Vec3Lanes p{load_lanes(x.data()), load_lanes(y.data()), load_lanes(z.data())};
    store_lanes(distances2_to(blocks_[i].triangles, blocks_[i].terms, p), &out[4 * i]);
  }
}

}  // namespace meshlode::builder
