// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's AABB tree, as an oracle for nearest distances.
#pragma once

#include <memory>

#include "judge/metrics/metrics.h"

namespace meshlode::test {

class CgalDistance {
 public:
  explicit CgalDistance(const judge::Surface& surface);  ///< \pre no triangle without area
  ~CgalDistance();
  [[nodiscard]] double distance2(const Vec3d& point) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace meshlode::test
