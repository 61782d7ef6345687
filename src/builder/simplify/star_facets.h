// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a star, made ready for many points that ask how far they are. In floats, four triangles at once,
// about a point of the star: what is asked are distances of a share of its edges, which floats know to seven digits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/deviation/four_triangles.h"

namespace meshlode::builder {

class StarFacets {
 public:
  /// Forgets all triangles. `origin` is near those that come.
  void start(const Vec3d& origin);
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  /// Before the first question.
  void finish();

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The squared distance to the nearest triangle; infinite where there is none. One of at most `enough` is as good as
  /// a lower one.
  [[nodiscard]] float distance2_to(const Vec3d& point, float enough = 0.0F) const;
  /// The squared distances of the i-th point to the i-th triangle. \pre no more points than triangles
  void distances2_one_by_one(std::span<const Vec3d> points, std::vector<float>& out) const;

 private:
  struct Block {
    FourTriangles triangles;
    FourTriangleTerms terms;
  };
  Vec3d origin_{0.0};
  std::size_t count_ = 0;
  std::vector<Block> blocks_;  ///< those behind the last triangle keep their memory
};

}  // namespace meshlode::builder
