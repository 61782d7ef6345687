// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/flip/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/parallel.h"
#include "base/vec.h"
#include "lab/flip/colors.h"

namespace meshlode::lab {

namespace {

/// Of the paper, section 4.
constexpr double kColorPower = 0.7, kFeaturePower = 0.5;
constexpr double kColorKnee = 0.4, kColorAtKnee = 0.95;  // shares of the largest colour difference, and of the result
constexpr double kFeatureWidth = 0.082;                  // degrees

/// Contrast sensitivity as sums of two Gaussians a · sqrt(π / b) · exp(-π² r² / b), r in degrees: Y, Cx and Cz.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> kSensitivity{
    {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

/// One channel of a picture.
struct Plane {
  std::uint32_t width = 0, height = 0;
  std::vector<double> values;
  Plane(std::uint32_t w, std::uint32_t h) : width(w), height(h), values(std::size_t{w} * h, 0.0) {}
};

/// Weights at -r … r.
using Kernel = std::vector<double>;

template <class Weight>
Kernel make_kernel(int radius, const Weight& weight) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(weight(static_cast<double>(i)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0.0;
  for (const double w : kernel) sum += w;
  return sum;
}

/// Correlates rows with `across` and columns with `down`; what lies outside is the nearest pixel inside.
Plane filter(const Plane& in, const Kernel& across, const Kernel& down) {
  const auto width = static_cast<std::int64_t>(in.width), height = static_cast<std::int64_t>(in.height);
  const auto correlate = [](const Kernel& kernel, std::int64_t at, std::int64_t size, const auto& value) {
    const auto radius = static_cast<std::int64_t>(kernel.size() / 2);
    double sum = 0.0;
    for (std::int64_t k = -radius; k <= radius; ++k) {
      sum += kernel[static_cast<std::size_t>(k + radius)] * value(std::clamp<std::int64_t>(at + k, 0, size - 1));
    }
    return sum;
  };
  Plane rows(in.width, in.height), out(in.width, in.height);
  parallel_for_each_index(in.height, 8, [&](std::size_t y) {
    for (std::int64_t x = 0; x < width; ++x) {
      rows.values[y * in.width + static_cast<std::size_t>(x)] = correlate(
          across, x, width, [&](std::int64_t i) { return in.values[y * in.width + static_cast<std::size_t>(i)]; });
    }
  });
  parallel_for_each_index(in.height, 8, [&](std::size_t y) {
    for (std::size_t x = 0; x < in.width; ++x) {
      out.values[y * in.width + x] = correlate(down, static_cast<std::int64_t>(y), height, [&](std::int64_t i) {
        return rows.values[static_cast<std::size_t>(i) * in.width + x];
      });
    }
  });
  return out;
}

/// A sum of round Gaussians is a sum of separable ones; the whole weighs 1.
Plane blur_as_seen(const Plane& in, const Sensitivity& s, int radius, double pixels_per_degree) {
  const auto gaussian = [&](double b) {
    return make_kernel(radius, [&](double i) {
      const double degrees = i / pixels_per_degree;
      return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / b);
    });
  };
  const Kernel first = gaussian(s.b1), second = gaussian(s.b2);
  const double weight1 = s.a1 * std::sqrt(std::numbers::pi / s.b1), weight2 = s.a2 * std::sqrt(std::numbers::pi / s.b2);
  const double whole = weight1 * sum_of(first) * sum_of(first) + weight2 * sum_of(second) * sum_of(second);
  Plane out = filter(in, first, first);
  for (double& v : out.values) v *= weight1 / whole;
  if (weight2 == 0.0) return out;
  const Plane other = filter(in, second, second);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += weight2 / whole * other.values[i];
  return out;
}

using Opponents = std::array<Plane, 3>;

Opponents read_opponents(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height) {
  std::array<double, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = linear_of_srgb(static_cast<std::uint8_t>(i));
  Opponents out{Plane(width, height), Plane(width, height), Plane(width, height)};
  for (std::size_t i = 0; i < out[0].values.size(); ++i) {
    const std::uint8_t* p = &rgba[4 * i];
    const Vec3d opponent = ycxcz_of_linear({linear[p[0]], linear[p[1]], linear[p[2]]});
    for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(c)].values[i] = opponent[c];
  }
  return out;
}

/// What the eye makes of each pixel's colour.
std::vector<Vec3d> perceived_colors(const Opponents& opponents, double pixels_per_degree) {
  double widest = 0.0;
  for (const Sensitivity& s : kSensitivity) widest = std::max({widest, s.b1, s.b2});
  const double sigma = std::sqrt(widest / (2.0 * std::numbers::pi * std::numbers::pi));  // degrees
  const int radius = static_cast<int>(std::ceil(3.0 * sigma * pixels_per_degree));
  const Plane y = blur_as_seen(opponents[0], kSensitivity[0], radius, pixels_per_degree);
  const Plane cx = blur_as_seen(opponents[1], kSensitivity[1], radius, pixels_per_degree);
  const Plane cz = blur_as_seen(opponents[2], kSensitivity[2], radius, pixels_per_degree);
  std::vector<Vec3d> colors(y.values.size());
  parallel_for_each_index(colors.size(), 4096, [&](std::size_t i) {
    const Vec3d rgb = linear_of_ycxcz({y.values[i], cx.values[i], cz.values[i]});
    colors[i] = hunt_lab_of_linear(glm::clamp(rgb, Vec3d(0.0), Vec3d(1.0)));
  });
  return colors;
}

/// Compressed, so that small differences have most of 0 … 1.
double color_difference(const Vec3d& a, const Vec3d& b, double largest) {
  const double difference = std::pow(hyab(a, b), kColorPower), knee = kColorKnee * largest;
  if (difference < knee) return kColorAtKnee / knee * difference;
  return kColorAtKnee + (difference - knee) / (largest - knee) * (1.0 - kColorAtKnee);
}

/// Positive weights sum to 1 and negative ones to -1.
void balance(Kernel& kernel) {
  double positive = 0.0, negative = 0.0;
  for (const double w : kernel) (w > 0.0 ? positive : negative) += w;
  for (double& w : kernel) {
    if (w != 0.0) w /= w > 0.0 ? positive : -negative;
  }
}

struct Features {
  std::vector<double> edges, points;  ///< lengths of the first and second derivatives
};

std::vector<double> lengths(const Plane& x, const Plane& y) {
  std::vector<double> out(x.values.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(x.values[i], y.values[i]);
  return out;
}

Features find_features(const Plane& luminance, double pixels_per_degree) {
  const double sigma = 0.5 * kFeatureWidth * pixels_per_degree;  // pixels
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto gaussian = [&](double i) { return std::exp(-i * i / (2.0 * sigma * sigma)); };
  Kernel smooth = make_kernel(radius, gaussian);
  const double whole = sum_of(smooth);
  for (double& w : smooth) w /= whole;
  Kernel edge = make_kernel(radius, [&](double i) { return -i * gaussian(i); });
  Kernel point = make_kernel(radius, [&](double i) { return (i * i / (sigma * sigma) - 1.0) * gaussian(i); });
  balance(edge);
  balance(point);
  Plane normalized = luminance;
  for (double& v : normalized.values) v = (v + 16.0) / 116.0;
  return {lengths(filter(normalized, edge, smooth), filter(normalized, smooth, edge)),
          lengths(filter(normalized, point, smooth), filter(normalized, smooth, point))};
}

}  // namespace

struct FlipReference::Parts {
  std::uint32_t width, height;
  FlipOptions options;
  std::vector<Vec3d> colors;
  Features features;

  Parts(std::span<const std::uint8_t> rgba, std::uint32_t w, std::uint32_t h, const FlipOptions& o)
      : width(w), height(h), options(o) {
    const Opponents opponents = read_opponents(rgba, width, height);
    colors = perceived_colors(opponents, options.pixels_per_degree);
    features = find_features(opponents[0], options.pixels_per_degree);
  }
};

FlipReference::FlipReference(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                             const FlipOptions& options)
    : parts_(std::make_unique<Parts>(rgba, width, height, options)) {
  assert(rgba.size() == std::size_t{4} * width * height);
}

FlipReference::~FlipReference() = default;
FlipReference::FlipReference(FlipReference&&) noexcept = default;

FlipPicture FlipReference::compare(std::span<const std::uint8_t> test) const {
  assert(test.size() == 4 * parts_->colors.size());
  const Parts& a = *parts_;
  const Parts b(test, a.width, a.height, a.options);
  // The largest difference that there is: green against blue.
  const double largest =
      std::pow(hyab(hunt_lab_of_linear({0.0, 1.0, 0.0}), hunt_lab_of_linear({0.0, 0.0, 1.0})), kColorPower);
  FlipPicture out{a.width, a.height, std::vector<double>(a.colors.size())};
  parallel_for_each_index(out.difference.size(), kLoopGrain, [&](std::size_t i) {
    const double edges = std::abs(a.features.edges[i] - b.features.edges[i]);
    const double points = std::abs(a.features.points[i] - b.features.points[i]);
    const double features = std::pow(std::max(edges, points) / std::numbers::sqrt2, kFeaturePower);
    const double color = color_difference(a.colors[i], b.colors[i], largest);
    // 0 to the power of 0 would be 1: the paper's value of no difference is 0 wherever colours are equal.
    out.difference[i] = color > 0.0 ? std::pow(color, 1.0 - std::min(features, 1.0)) : 0.0;
  });
  return out;
}

FlipPicture flip(std::span<const std::uint8_t> reference, std::span<const std::uint8_t> test, std::uint32_t width,
                 std::uint32_t height, const FlipOptions& options) {
  return FlipReference(reference, width, height, options).compare(test);
}

FlipPool pool(const FlipPicture& picture) {
  FlipPool out;
  if (picture.difference.empty()) return out;
  std::vector<double> sorted = picture.difference;
  std::sort(sorted.begin(), sorted.end());
  double sum = 0.0;
  for (const double d : sorted) sum += d;
  out.mean = sum / static_cast<double>(sorted.size());
  out.max = sorted.back();
  double so_far = 0.0;
  for (const double d : sorted) {
    so_far += d;
    if (so_far >= 0.5 * sum) {
      out.weighted_median = d;
      break;
    }
  }
  return out;
}

std::vector<std::uint8_t> heat_map(const FlipPicture& picture) {
  // Lightness rises by equal steps from stop to stop.
  constexpr std::array<std::array<double, 3>, 5> kStops{
      {{0, 0, 4}, {81, 18, 124}, {183, 55, 121}, {252, 137, 97}, {252, 253, 191}}};
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * picture.difference.size());
  for (const double d : picture.difference) {
    const double at = std::clamp(d, 0.0, 1.0) * (kStops.size() - 1);
    const auto stop = std::min<std::size_t>(static_cast<std::size_t>(at), kStops.size() - 2);
    const double share = at - static_cast<double>(stop);
    for (std::size_t c = 0; c < 3; ++c) {
      rgba.push_back(
          static_cast<std::uint8_t>(std::lround(kStops[stop][c] + share * (kStops[stop + 1][c] - kStops[stop][c]))));
    }
    rgba.push_back(255);
  }
  return rgba;
}

}  // namespace meshlode::lab
