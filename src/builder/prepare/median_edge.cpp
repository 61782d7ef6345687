// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/prepare/median_edge.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

using Histogram = std::vector<std::uint64_t>;
constexpr unsigned kDigitBits = 16;
constexpr unsigned kFirstDigit = 47;  ///< below the sign: all of the exponent and 5 bits of the mantissa
constexpr unsigned kSecondDigit = kFirstDigit - kDigitBits;

/// Calls visit(bits) for the squared length of each edge that has one: doubles that are not negative are in the order
/// of their bits.
template <class Visit>
void for_each_length2(const Corners& corners, std::size_t begin, std::size_t end, const Visit& visit) {
  for (std::size_t t = begin; t < end; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge =
          corners.positions[corners.triangles[3 * t + k]] - corners.positions[corners.triangles[3 * t + (k + 1) % 3]];
      const double length2 = glm::dot(edge, edge);
      if (length2 > 0.0) visit(std::bit_cast<std::uint64_t>(length2));
    }
  }
}

/// How many edges have which digit, of those whose bits begin with `prefix`. Counts are sums, so that neither the order
/// of triangles nor that of threads is in them.
Histogram count_digits(const Corners& corners, unsigned digit, std::uint64_t prefix) {
  constexpr std::size_t kMostChunks = 16;  // each has a histogram of its own
  const std::size_t triangles = corners.materials.size();
  const std::size_t length = std::max(4 * kLoopGrain, triangles / kMostChunks + 1);
  std::vector<Histogram> counts(chunk_count(triangles, length));
  parallel_for_each_chunk(triangles, length, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Histogram& own = counts[chunk];
    own.assign(std::size_t{1} << kDigitBits, 0);
    for_each_length2(corners, begin, end, [&](std::uint64_t bits) {
      if (bits >> (digit + kDigitBits) == prefix) ++own[(bits >> digit) % own.size()];
    });
  });
  Histogram sum(std::size_t{1} << kDigitBits, 0);
  for (const Histogram& own : counts) {
    for (std::size_t i = 0; i < own.size(); ++i) sum[i] += own[i];
  }
  return sum;
}

/// The digit of the edge that has `rank` shorter ones among those counted; `rank` becomes that among those of its
/// digit.
std::uint64_t digit_at(const Histogram& counts, std::uint64_t& rank) {
  std::uint64_t digit = 0;
  while (rank >= counts[digit]) rank -= counts[digit++];
  return digit;
}

/// Of a mesh for which a histogram of 65,536 counts would be longer than the list of its edges.
double median_of_list(const Corners& corners) {
  std::vector<std::uint64_t> lengths2;
  lengths2.reserve(corners.triangles.size());
  for_each_length2(corners, 0, corners.materials.size(), [&](std::uint64_t bits) { lengths2.push_back(bits); });
  if (lengths2.empty()) return 0.0;
  const auto middle = lengths2.begin() + static_cast<std::ptrdiff_t>(lengths2.size() / 2);
  std::nth_element(lengths2.begin(), middle, lengths2.end());
  return std::sqrt(std::bit_cast<double>(*middle));
}

}  // namespace

double median_edge_length(const Corners& corners) {
  if (corners.triangles.size() < std::size_t{1} << kDigitBits) return median_of_list(corners);
  const Histogram first = count_digits(corners, kFirstDigit, 0);
  const std::uint64_t edges = std::accumulate(first.begin(), first.end(), std::uint64_t{0});
  if (edges == 0) return 0.0;
  std::uint64_t rank = edges / 2;
  const std::uint64_t high = digit_at(first, rank);
  const std::uint64_t low = digit_at(count_digits(corners, kSecondDigit, high), rank);
  return std::sqrt(std::bit_cast<double>(high << kFirstDigit | low << kSecondDigit));
}

}  // namespace meshlode::builder
