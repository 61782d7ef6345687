// SPDX-License-Identifier: GPL-3.0-or-later
// Singular values by Jacobi rotations on the matrix of column products (Jacobi 1846; Golub and Van Loan, 8.5): only
// + - * / and sqrt, so that the stored bits do not depend on a C library (I10).
#include "builder/write/instance_scale.h"

#include <algorithm>
#include <cmath>

#include <meshlode/format.h>

namespace meshlode::builder {

namespace {

constexpr double kSingularDeterminant = 0x1p-48;  ///< of the matrix scaled to a largest entry of 1: rounding noise
constexpr double kInflation = 1.0 + 1e-12;        ///< covers the rounding of a few dozen operations, with room

/// Largest eigenvalue of a symmetric, non-negative 3×3 matrix.
double largest_eigenvalue(double a[3][3]) {
  for (int sweep = 0; sweep < 32; ++sweep) {
    if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) == 0.0) break;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        double t = 0.0;  // tangent of the rotation; for a huge theta its limit 0
        if (std::isfinite(theta * theta)) {
          t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        }
        const double c = 1.0 / std::sqrt(t * t + 1.0);
        const double s = t * c;
        const double apq = a[p][q];
        a[p][p] -= t * apq;
        a[q][q] += t * apq;
        a[p][q] = a[q][p] = 0.0;
        const int r = 3 - p - q;
        const double arp = a[r][p];
        const double arq = a[r][q];
        a[r][p] = a[p][r] = c * arp - s * arq;
        a[r][q] = a[q][r] = s * arp + c * arq;
      }
    }
  }
  return std::max({a[0][0], a[1][1], a[2][2]});
}

bool has_one_entry_per_row_and_column(const double m[3][3]) {
  for (int i = 0; i < 3; ++i) {
    int in_row = 0;
    int in_column = 0;
    for (int j = 0; j < 3; ++j) {
      in_row += m[i][j] != 0.0 ? 1 : 0;
      in_column += m[j][i] != 0.0 ? 1 : 0;
    }
    if (in_row > 1 || in_column > 1) return false;
  }
  return true;
}

}  // namespace

InstanceScale measure_instance(const Mat4d& transform) {
  InstanceScale out;
  double m[3][3];
  double largest_entry = 0.0;
  bool is_finite = true;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double value = transform[column][row];
      is_finite = is_finite && std::isfinite(value);
      if (column < 3) {
        m[row][column] = value;
        largest_entry = std::max(largest_entry, std::abs(value));
      }
    }
  }
  if (!is_finite || largest_entry == 0.0) {
    out.flags = format::kInstanceSingular;
    return out;
  }
  if (has_one_entry_per_row_and_column(m)) {
    out.largest = largest_entry;
  }
  for (auto& row : m) {
    for (double& value : row) value /= largest_entry;
  }
  if (out.largest == 0.0) {
    double products[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) products[i][j] = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
    }
    out.largest = std::sqrt(largest_eigenvalue(products)) * kInflation * largest_entry;
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  if (determinant < 0.0) out.flags |= format::kInstanceMirrored;
  if (std::abs(determinant) < kSingularDeterminant || !std::isfinite(out.largest)) {
    out.flags = format::kInstanceSingular;
  }
  if (!std::isfinite(out.largest)) out.largest = 0.0;
  return out;
}

}  // namespace meshlode::builder
