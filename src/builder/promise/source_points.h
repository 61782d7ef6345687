// SPDX-License-Identifier: GPL-3.0-or-later
// The points of the source that are held against the DAG: which there are, and which of them are carried on from a
// group to the clusters made of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "builder/promise/far_points.h"
#include "builder/promise/product_surfaces.h"

namespace meshlode::builder {

struct SourcePoint {
  std::uint32_t triangle;  ///< of the source
  float b, c;              ///< weights of its second and third corner
  float distance = 0.0F;   ///< from the clusters that it was last found on
  std::uint32_t place = 0;
  [[nodiscard]] bool is_vertex() const { return (b == 0.0F || b == 1.0F) && (c == 0.0F || c == 1.0F); }
};

template <std::size_t D>
class SourcePoints {
 public:
  using Point = ProductPoint<D>;
  using Sample = SourcePoint;

  /// What is given must outlive this.
  SourcePoints(const ProductSurfaces<D>& surfaces, const ProductSurface<D>& source)
      : surfaces_(surfaces), source_(source) {}

  [[nodiscard]] std::vector<Sample> choose() const {
    const auto count = static_cast<std::uint32_t>(source_.triangles.size());
    std::vector<double> length(count);
    double sum = 0.0;
    for (std::uint32_t t = 0; t < count; ++t) {
      length[t] = std::sqrt(longest2_of(t));
      sum += length[t];
    }
    const double per_length = sum > 0.0 && std::isfinite(sum) ? static_cast<double>(kSourcePoints) / sum : 0.0;
    std::vector<Sample> samples;
    std::vector<std::uint8_t> is_taken(source_.points.size(), 0);
    SplitMix64 random(0x7061696E74ULL);
    double owed = 0.0;
    for (std::uint32_t t = 0; t < count; ++t) {
      if (!surfaces_.has_points(source_, t)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        std::uint8_t& taken = is_taken[source_.triangles[t][k]];
        if (taken == 0) samples.push_back({t, k == 1 ? 1.0F : 0.0F, k == 2 ? 1.0F : 0.0F});
        taken = 1;
      }
      samples.push_back({t, 1.0F / 3.0F, 1.0F / 3.0F});
      for (owed += per_length * length[t]; owed >= 1.0; owed -= 1.0) {
        const auto [b, c] = random_weights(random);
        samples.push_back({t, static_cast<float>(b), static_cast<float>(c)});
      }
    }
    return samples;
  }

  [[nodiscard]] double longest2_of(std::uint32_t triangle) const {
    double longest2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& a = source_.points[source_.triangles[triangle][k]];
      const Point& b = source_.points[source_.triangles[triangle][(k + 1) % 3]];
      double side2 = 0.0;
      for (std::size_t d = 0; d < D; ++d) side2 += (a[d] - b[d]) * (a[d] - b[d]);
      longest2 = std::max(longest2, side2);
    }
    return longest2;
  }

  /// The farthest samples of each triangle, of the others some from all over the source and the farthest vertices, and
  /// those that lie outermost in some coordinate: what is near now and far when the triangle has become another.
  [[nodiscard]] std::vector<Sample> thin(std::vector<Sample>& samples, std::size_t triangle_count) const {
    const std::size_t each = std::max(kCarried / std::max<std::size_t>(1, triangle_count), kFewestCarried);
    const std::size_t vertices = std::max(kCarriedVertices / std::max<std::size_t>(1, triangle_count), kFewestVertices);
    std::sort(samples.begin(), samples.end(), [](const Sample& x, const Sample& y) {
      if (x.place != y.place) return x.place < y.place;
      if (x.distance != y.distance) return x.distance > y.distance;
      if (x.triangle != y.triangle) return x.triangle < y.triangle;
      return x.b != y.b ? x.b < y.b : x.c < y.c;
    });
    std::vector<Sample> kept;
    for (std::size_t begin = 0; begin < samples.size();) {
      std::size_t end = begin;
      while (end < samples.size() && samples[end].place == samples[begin].place) ++end;
      const std::size_t count = end - begin, far = std::min(count, each);
      const std::size_t rest = std::min(count - far, each / 2);
      const Outermost outermost = find_outermost({samples.data() + begin, count});
      std::size_t taken = 0, vertices_taken = 0;  // of the rest; of all
      for (std::size_t i = 0; i < count; ++i) {
        const Sample& sample = samples[begin + i];
        const bool is_of_rest = i >= far && taken < rest && i == far + (count - far) * taken / rest;
        const bool is_wanted_vertex = sample.is_vertex() && vertices_taken < vertices;
        const bool is_outermost = std::find(outermost.begin(), outermost.end(), i) != outermost.end();
        if (i < far || is_of_rest || is_wanted_vertex || is_outermost) kept.push_back(sample);
        taken += is_of_rest ? 1 : 0;
        vertices_taken += is_wanted_vertex ? 1 : 0;
      }
      begin = end;
    }
    return kept;
  }

 private:
  /// Points of the source beside the corners and the middle of each triangle: so many in all, by the triangles' longest
  /// sides, as what a cut is off by changes along them.
  static constexpr std::size_t kSourcePoints = 100000;
  /// Carried on by a group, about; so many a triangle of it at least. With half as many, and at most 64 a triangle,
  /// random scenes 1030227, 1030293, 1081043 and 1081056 had a cut at up to 1.12 times what it promises; rock, bunny
  /// and FlightHelmet take the same time.
  static constexpr std::size_t kCarried = 32768, kFewestCarried = 2;
  /// The same of vertices of the source, of which corners of charts and peaks of normals are: all of them, but where a
  /// triangle has very many, so that those of small meshes are there to the end.
  static constexpr std::size_t kCarriedVertices = 32768, kFewestVertices = 64;

  /// Of each coordinate the first sample with the least and the first with the most.
  using Outermost = std::array<std::size_t, 2 * D>;
  [[nodiscard]] Outermost find_outermost(std::span<const Sample> samples) const {
    Outermost at{};
    Point low{}, high{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Point point = source_.at(samples[i].triangle, samples[i].b, samples[i].c);
      for (std::size_t d = 0; d < D; ++d) {
        if (i == 0 || point[d] < low[d]) {
          low[d] = point[d];
          at[2 * d] = i;
        }
        if (i == 0 || point[d] > high[d]) {
          high[d] = point[d];
          at[2 * d + 1] = i;
        }
      }
    }
    return at;
  }

  const ProductSurfaces<D>& surfaces_;
  const ProductSurface<D>& source_;
};

}  // namespace meshlode::builder
