// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/symmetric.h"

#include <algorithm>
#include <cmath>

namespace meshlode::builder {

Axes axes_of(Mat3d m) {
  constexpr int kMostSweeps = 12;  // convergence is quadratic; 3 × 3 needs four or five
  Mat3d v(1.0);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0.0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
        const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0);
        const double s = t * c;
        Mat3d turn(1.0);
        turn[p][p] = c;
        turn[q][q] = c;
        turn[q][p] = s;
        turn[p][q] = -s;
        m = glm::transpose(turn) * m * turn;
        m[p][q] = m[q][p] = 0.0;
        v = v * turn;
      }
    }
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
  Axes axes;
  for (std::size_t k = 0; k < 3; ++k) {
    axes.direction[k] = v[order[k]];
    axes.value[k] = std::max(0.0, m[order[k]][order[k]]);
  }
  if (glm::dot(glm::cross(axes.direction[0], axes.direction[1]), axes.direction[2]) < 0.0) {
    axes.direction[2] = -axes.direction[2];
  }
  return axes;
}

}  // namespace meshlode::builder
