// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/fits.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <meshlode/format.h>

namespace meshlode::builder {

namespace {

/// Least squares of values over up to three coordinates and a constant, by normal equations and elimination in a fixed
/// order. A coordinate that the others (nearly) determine gets no slope.
std::array<double, 3> least_squares(std::span<const std::int32_t> values, std::span<const RawPosition> positions,
                                    const std::array<bool, 3>& is_used) {
  const auto count = static_cast<double>(values.size());
  std::array<double, 3> mean{};
  double value_mean = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] += positions[i][k];
    value_mean += values[i];
  }
  for (double& m : mean) m /= count;
  value_mean /= count;
  double a[3][4] = {};
  for (std::size_t i = 0; i < values.size(); ++i) {
    double d[3];
    for (std::size_t k = 0; k < 3; ++k) d[k] = is_used[k] ? positions[i][k] - mean[k] : 0.0;
    const double dv = values[i] - value_mean;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = r; c < 3; ++c) a[r][c] += d[r] * d[c];
      a[r][3] += d[r] * dv;
    }
  }
  a[1][0] = a[0][1];
  a[2][0] = a[0][2];
  a[2][1] = a[1][2];
  const double diagonal[3] = {a[0][0], a[1][1], a[2][2]};
  bool has_pivot[3] = {};
  for (std::size_t p = 0; p < 3; ++p) {
    constexpr double kDependent = 1e-9;
    if (!(a[p][p] > kDependent * diagonal[p]) || !(diagonal[p] > 0.0)) continue;
    has_pivot[p] = true;
    for (std::size_t r = 0; r < 3; ++r) {
      if (r == p) continue;
      const double factor = a[r][p] / a[p][p];
      for (std::size_t c = 0; c < 4; ++c) a[r][c] -= factor * a[p][c];
    }
  }
  std::array<double, 3> slope{};
  for (std::size_t p = 0; p < 3; ++p) slope[p] = has_pivot[p] ? a[p][3] / a[p][p] : 0.0;
  return slope;
}

constexpr std::int32_t kMaxShear = 127;
/// With these, no product of the shear leaves 31 bits.
constexpr std::uint32_t kMaxShearBits = 22;

std::int32_t wrap(std::uint32_t value) {
  return static_cast<std::int32_t>(value);
}

/// A value less the fit of the two others.
std::int32_t sheared(std::int32_t value, std::int32_t u, std::int32_t v, const std::array<std::int32_t, 2>& slope) {
  return value - ((slope[0] * u + slope[1] * v) >> format::kShearShift);
}

/// Of a whole axis.
ValueRange sheared_range(const std::vector<std::int32_t>& values, const std::vector<std::int32_t>& u,
                         const std::vector<std::int32_t>& v, const std::array<std::int32_t, 2>& slope) {
  std::int32_t least = sheared(values[0], u[0], v[0], slope), most = least;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const std::int32_t residual = sheared(values[i], u[i], v[i], slope);
    least = std::min(least, residual);
    most = std::max(most, residual);
  }
  return range_between(least, most);
}

}  // namespace

ValueRange range_between(std::int32_t least, std::int32_t most) {
  return {least, static_cast<std::uint32_t>(
                     std::bit_width(static_cast<std::uint32_t>(most) - static_cast<std::uint32_t>(least)))};
}

ValueRange range_of(std::span<const std::int32_t> values) {
  std::int32_t least = values.front(), most = values.front();
  for (const std::int32_t value : values) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return range_between(least, most);
}

PositionFit fit_positions(std::span<const std::array<std::int32_t, 3>> positions) {
  PositionFit best;
  std::array<std::vector<std::int32_t>, 3> axis_values;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axis_values[axis].reserve(positions.size());
    for (const auto& p : positions) axis_values[axis].push_back(p[axis]);
    best.range[axis] = range_of(axis_values[axis]);
  }
  best.raw.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      best.raw[i][axis] = static_cast<std::uint32_t>(positions[i][axis] - best.range[axis].minimum);
    }
  }
  const std::vector<RawPosition> plain = best.raw;
  const std::array<ValueRange, 3> plain_range = best.range;
  const auto bits_of = [](const std::array<ValueRange, 3>& range) {
    return range[0].bits + range[1].bits + range[2].bits;
  };

  // What the trials look at, axis by axis, and without a branch: such loops become vector instructions.
  std::array<std::vector<std::int32_t>, 3> offset;  // above the axis's minimum
  for (std::size_t axis = 0; axis < 3; ++axis) {
    offset[axis].reserve(positions.size());
    for (const RawPosition& p : plain) offset[axis].push_back(static_cast<std::int32_t>(p[axis]));
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = axis == 0 ? 1 : 0;
    const std::size_t v = axis == 2 ? 1 : 2;
    if (plain_range[u].bits > kMaxShearBits || plain_range[v].bits > kMaxShearBits) continue;
    std::array<bool, 3> is_used{true, true, true};
    is_used[axis] = false;
    const std::array<double, 3> slope = least_squares(axis_values[axis], plain, is_used);
    const auto scaled = [](double s) {
      return static_cast<std::int32_t>(
          std::clamp(std::floor(s * (1 << format::kShearShift) + 0.5), -double(kMaxShear), double(kMaxShear)));
    };
    const std::int32_t su = scaled(slope[u]);
    const std::int32_t sv = scaled(slope[v]);
    for (std::int32_t tu = std::max(su - 1, -kMaxShear); tu <= std::min(su + 1, kMaxShear); ++tu) {
      for (std::int32_t tv = std::max(sv - 1, -kMaxShear); tv <= std::min(sv + 1, kMaxShear); ++tv) {
        std::array<ValueRange, 3> range = plain_range;
        range[axis] = sheared_range(axis_values[axis], offset[u], offset[v], {tu, tv});
        constexpr std::int32_t kMinimumLimit = (1 << 23) - 1;
        if (std::abs(range[axis].minimum) > kMinimumLimit || bits_of(range) >= bits_of(best.range)) continue;
        best.axis = axis;
        best.slope = {tu, tv};
        best.range = range;
      }
    }
  }
  if (best.slope[0] == 0 && best.slope[1] == 0) return best;
  const std::size_t u = best.axis == 0 ? 1 : 0;
  const std::size_t v = best.axis == 2 ? 1 : 2;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    best.raw[i][best.axis] = static_cast<std::uint32_t>(
        sheared(axis_values[best.axis][i], offset[u][i], offset[v][i], best.slope) - best.range[best.axis].minimum);
  }
  return best;
}

UvFit fit_uv(std::span<const std::int32_t> values, std::span<const RawPosition> positions, bool may_have_slope) {
  UvFit fit;
  fit.range = range_of(values);
  fit.residual.reserve(values.size());
  for (const std::int32_t v : values) fit.residual.push_back(static_cast<std::uint32_t>(v - fit.range.minimum));
  if (!may_have_slope || values.size() < 4) return fit;

  const std::array<double, 3> slope = least_squares(values, positions, {true, true, true});
  const double largest = std::max({std::abs(slope[0]), std::abs(slope[1]), std::abs(slope[2])});
  constexpr double kLimit = 511.0;
  if (!(largest > 0.0) || largest > kLimit) return fit;
  std::uint32_t shift = 0;
  double scale = 1.0;
  while (shift < 31 && largest * scale * 2.0 + 0.5 <= kLimit) {
    scale *= 2.0;
    ++shift;
  }
  std::array<std::int32_t, 3> c{};
  for (std::size_t k = 0; k < 3; ++k) {
    c[k] = static_cast<std::int32_t>(std::clamp(std::floor(slope[k] * scale + 0.5), -kLimit, kLimit));
  }
  // Modulo 2^32 everything comes back exactly; a fit that wraps is only a bad one, and is not shorter.
  std::vector<std::int32_t> residual(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += static_cast<std::uint32_t>(c[k]) * positions[i][k];
    residual[i] = wrap(static_cast<std::uint32_t>(values[i]) - static_cast<std::uint32_t>(wrap(sum) >> shift));
  }
  const ValueRange range = range_of(residual);
  if (range.bits >= fit.range.bits) return fit;
  fit.has_slope = true;
  fit.slope = c;
  fit.shift = shift;
  fit.range = range;
  for (std::size_t i = 0; i < values.size(); ++i) {
    fit.residual[i] = static_cast<std::uint32_t>(residual[i]) - static_cast<std::uint32_t>(range.minimum);
  }
  return fit;
}

}  // namespace meshlode::builder
