// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/promise/product_search.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/parallel.h"
#include "builder/deviation/lanes.h"
#include "builder/deviation/open_boxes.h"
#include "builder/promise/product_point.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kLeaf = 4;
/// Of a leaf, behind its corners and edges.
enum Term : std::size_t { kEe, kEf, kFf, kDet, kPerEe, kPerFf, kPerBc, kPerDet, kTerms };

using Doubles = double __attribute__((vector_size(32)));
/// Four that lie anywhere in memory: a function that returned them would depend on the processor.
using DoublesThere = double __attribute__((vector_size(32), aligned(8), may_alias));
using DoubleMask = std::int64_t __attribute__((vector_size(32)));

/// In floats, and so that what is between is not nearer than it is.
struct FloatRange {
  float low, high;
  explicit FloatRange(double value) {
    constexpr double kMost = 3.0e38;
    const auto nearest = static_cast<float>(std::clamp(value, -kMost, kMost));
    const float grace = std::abs(nearest) * 0x1p-23F;  // two roundings of it
    low = nearest - grace;
    high = nearest + grace;
  }
};

/// How near a leaf's triangles may be, squared. Not more is lost than a millionth of the first corner's distance,
/// squared, where the triangle is no needle (a sine of 0.01 at that corner is enough); a needle may be anywhere: -1.
[[gnu::always_inline]] inline void bound_leaf(const double* leaf, std::size_t dimensions, const double* point,
                                              std::array<double, kLeaf>& bounds2) {
  const auto* const a = reinterpret_cast<const DoublesThere*>(leaf);
  const auto *const e = a + dimensions, *const f = e + dimensions, *const term = f + dimensions;
  Doubles d1{}, d2{}, pp{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    const Doubles p = point[d] - a[d];
    d1 += e[d] * p;
    d2 += f[d] * p;
    pp += p * p;
  }
  const Doubles ee = term[kEe], ef = term[kEf], ff = term[kFf], det = term[kDet], zero{}, one = zero + 1.0;
  // How much nearer than the first corner the plane is, and the best points of the three edges.
  const Doubles b = d1 * ff - d2 * ef, c = d2 * ee - d1 * ef;
  const Doubles by_plane = (d1 * b + d2 * c) * term[kPerDet];
  Doubles s = d1 * term[kPerEe], t = d2 * term[kPerFf];
  Doubles w = (d2 - ef - d1 + ee) * term[kPerBc];
  s = s > zero ? s : zero;
  s = s < one ? s : one;
  t = t > zero ? t : zero;
  t = t < one ? t : one;
  w = w > zero ? w : zero;
  w = w < one ? w : one;
  const Doubles v = one - w;
  const Doubles by_ab = s * (2.0 * d1 - s * ee), by_ac = t * (2.0 * d2 - t * ff);
  const Doubles by_bc = 2.0 * (v * d1 + w * d2) - (v * v * ee + 2.0 * v * w * ef + w * w * ff);
  Doubles by_edge = by_ab > by_ac ? by_ab : by_ac;
  by_edge = by_edge > by_bc ? by_edge : by_bc;
  const DoubleMask is_inside = (b > zero) & (c > zero) & (b + c < det);
  const Doubles nearer = is_inside ? by_plane : by_edge;
  const Doubles bounds = det > zero ? pp * (1.0 - 1e-6) - nearer : zero - 1.0;
  std::memcpy(bounds2.data(), &bounds, sizeof(bounds));
}

}  // namespace

ProductSearch::ProductSearch(const Surface& surface, std::vector<std::uint32_t> triangles)
    : surface_(surface), order_(std::move(triangles)) {
  if (order_.empty()) return;
  set_scale();
  level_start_ = box_levels(leaf_count());
  sort_triangles();
  slot_of_.resize(surface_.triangles.size());
  for (std::uint32_t slot = 0; slot < order_.size(); ++slot) slot_of_[order_[slot]] = slot;
  leaves_.resize(leaf_size() * leaf_count());
  parallel_for_each_index(leaf_count(), 1024, [&](std::size_t leaf) { fill_leaf(leaf); });
  nodes_.resize(2 * 4 * surface_.dimensions * level_start_.back());
  fill_nodes();
}

std::size_t ProductSearch::leaf_size() const {
  return kLeaf * (3 * surface_.dimensions + kTerms);
}

void ProductSearch::set_scale() {
  double largest = 0.0;
  for (const std::uint32_t t : order_) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < surface_.dimensions; ++d) largest = std::max(largest, std::abs(corner(t, k)[d]));
    }
  }
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  scale_ = largest > 0.0 ? std::ldexp(1.0, std::clamp(-exponent, -500, 500)) : 1.0;
}

/// Halves by the median along the longest side, twice a level. Counts are those of whole subtrees, so that only the
/// last one is not full.
void ProductSearch::sort_triangles() {
  const std::size_t dimensions = surface_.dimensions, depth = level_start_.size() - 1;
  std::vector<float> center(dimensions * surface_.triangles.size());
  for (const std::uint32_t t : order_) {
    for (std::size_t d = 0; d < dimensions; ++d)
      center[dimensions * t + d] = static_cast<float>((corner(t, 0)[d] + corner(t, 1)[d] + corner(t, 2)[d]) * scale_);
  }
  std::vector<std::pair<float, std::uint32_t>> keyed;
  const auto halve = [&](std::span<std::uint32_t> piece, std::size_t half) {
    std::array<float, kMostDimensions> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const std::uint32_t t : piece) {
      for (std::size_t d = 0; d < dimensions; ++d) {
        low[d] = std::min(low[d], center[dimensions * t + d]);
        high[d] = std::max(high[d], center[dimensions * t + d]);
      }
    }
    std::size_t longest = 0;
    for (std::size_t d = 1; d < dimensions; ++d) {
      if (high[d] - low[d] > high[longest] - low[longest]) longest = d;
    }
    keyed.clear();
    for (const std::uint32_t t : piece) keyed.emplace_back(center[dimensions * t + longest], t);
    std::nth_element(keyed.begin(), keyed.begin() + static_cast<std::ptrdiff_t>(half), keyed.end());
    std::transform(keyed.begin(), keyed.end(), piece.begin(), [](const auto& key) { return key.second; });
  };
  for (std::size_t halving = 2 * depth; halving-- > 0;) {
    const std::size_t half = kLeaf << halving;
    for (std::size_t first = 0; first + half < order_.size(); first += 2 * half)
      halve(std::span(order_).subspan(first, std::min(2 * half, order_.size() - first)), half);
  }
  // The order of each side is nobody's choice so far: inside a leaf it is made ours.
  for (std::size_t first = 0; first < order_.size(); first += kLeaf)
    std::sort(order_.begin() + static_cast<std::ptrdiff_t>(first),
              order_.begin() + static_cast<std::ptrdiff_t>(std::min(first + kLeaf, order_.size())));
}

void ProductSearch::fill_leaf(std::size_t leaf) {
  const std::size_t dimensions = surface_.dimensions;
  double* const out = leaves_.data() + leaf_size() * leaf;
  for (std::size_t k = 0; k < kLeaf; ++k) {
    const std::uint32_t t = order_[std::min(kLeaf * leaf + k, order_.size() - 1)];
    std::array<double, kTerms> term{};
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double a = corner(t, 0)[d], e = corner(t, 1)[d] - a, f = corner(t, 2)[d] - a;
      out[kLeaf * d + k] = a;
      out[kLeaf * (dimensions + d) + k] = e;
      out[kLeaf * (2 * dimensions + d) + k] = f;
      term[kEe] += e * e;
      term[kEf] += e * f;
      term[kFf] += f * f;
    }
    const double bc = (term[kEe] - term[kEf]) + (term[kFf] - term[kEf]);
    const double det = term[kEe] * term[kFf] - term[kEf] * term[kEf];
    if (det > 1e-4 * term[kEe] * term[kFf] && bc > 0.0) {  // else it stays 0, and all the rest
      term[kDet] = det;
      term[kPerEe] = 1.0 / term[kEe];
      term[kPerFf] = 1.0 / term[kFf];
      term[kPerBc] = 1.0 / bc;
      term[kPerDet] = 1.0 / det;
    }
    for (std::size_t i = 0; i < kTerms; ++i) out[kLeaf * (3 * dimensions + i) + k] = term[i];
  }
}

void ProductSearch::fill_nodes() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::size_t dimensions = surface_.dimensions, depth = level_start_.size() - 1;
  const auto side = [&](std::size_t node, std::size_t which) {
    return nodes_.data() + 4 * dimensions * (2 * node + which);
  };
  for (std::size_t level = depth; level-- > 0;) {
    const std::size_t below = level_start_[level + 1];
    const std::size_t child_count = level + 1 == depth ? leaf_count() : level_start_[level + 2] - below;
    parallel_for_each_index(level_start_[level + 1] - level_start_[level], 1024, [&](std::size_t i) {
      float *const lows = side(level_start_[level] + i, 0), *const highs = side(level_start_[level] + i, 1);
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t child = 4 * i + k;
        for (std::size_t d = 0; d < dimensions; ++d) {
          float low = kInfinity, high = -kInfinity;  // no child: infinitely far from every point
          for (std::size_t j = 0; j < 4 && child < child_count; ++j) {
            if (level + 1 < depth) {
              low = std::min(low, side(below + child, 0)[4 * d + j]);
              high = std::max(high, side(below + child, 1)[4 * d + j]);
            } else {
              const std::uint32_t t = order_[std::min(kLeaf * child + j, order_.size() - 1)];
              for (std::size_t c = 0; c < 3; ++c) {
                const FloatRange at(corner(t, c)[d] * scale_);
                low = std::min(low, at.low);
                high = std::max(high, at.high);
              }
            }
          }
          lows[4 * d + k] = low;
          highs[4 * d + k] = high;
        }
      }
    });
  }
}

template <std::size_t D>
[[gnu::always_inline]] inline ProductSearch::Hit ProductSearch::find_in(const double* point, std::uint32_t hint,
                                                                        double enough2) const {
  const std::size_t dimensions = D > 0 ? D : surface_.dimensions;
  Hit best;
  const auto take = [&](std::uint32_t triangle) __attribute__((always_inline)) {
    const double distance2 =
        product_distance2<D>(point, corner(triangle, 0, dimensions), corner(triangle, 1, dimensions),
                             corner(triangle, 2, dimensions), dimensions, best.distance2);
    if (distance2 < best.distance2) best = {distance2, triangle};
  };
  // What is near enough is mostly the hint.
  if (hint != kNoId && enough2 > 0.0) take(hint);
  if (best.distance2 <= enough2) return best;

  std::array<float, kMostDimensions> low, high;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const FloatRange at(point[d] * scale_);
    low[d] = at.low;
    high[d] = at.high;
  }
  const auto distances2_to = [&](std::uint32_t node) __attribute__((always_inline)) {
    const float* const lows = nodes_.data() + 2 * 4 * dimensions * node;
    const float* const highs = lows + 4 * dimensions;
    Lanes sum = lanes(0.0F);
    for (std::size_t d = 0; d < dimensions; ++d) {
      const Lanes below = load_lanes(lows + 4 * d) - lanes(high[d]), above = lanes(low[d]) - load_lanes(highs + 4 * d);
      const Lanes outside = max_lanes(max_lanes(below, above), lanes(0.0F));
      sum += outside * outside;
    }
    return sum * lanes(1.0F - 0x1p-19F);  // roundings: no box is nearer than it seems
  };
  constexpr double kMost = 3.0e38;
  auto limit = static_cast<float>(kMost);
  const double scale2 = scale_ * scale_ * (1.0 + 0x1p-20);
  const auto look_at = [&](std::uint32_t leaf) __attribute__((always_inline)) {
    std::array<double, kLeaf> bounds2;
    bound_leaf(leaves_.data() + leaf_size() * leaf, dimensions, point, bounds2);
    const std::size_t count = std::min(kLeaf, order_.size() - kLeaf * leaf);
    for (;;) {  // the most promising first: it mostly dismisses the others
      std::size_t k = 0;
      for (std::size_t i = 1; i < count; ++i) k = bounds2[i] < bounds2[k] ? i : k;
      if (!(bounds2[k] < best.distance2)) break;
      take(order_[kLeaf * leaf + k]);
      bounds2[k] = std::numeric_limits<double>::infinity();
    }
    limit = static_cast<float>(std::min(best.distance2 * scale2, kMost));
    return !(best.distance2 <= enough2);
  };
  const std::uint32_t known = hint != kNoId ? slot_of_[hint] / static_cast<std::uint32_t>(kLeaf) : kNoId;
  if (known != kNoId && !look_at(known)) return best;
  search_boxes(
      level_start_, known, distances2_to, look_at, [&]() __attribute__((always_inline)) { return limit; });
  // So far away that in floats nothing is: whichever it is, it is as near as any.
  if (best.triangle == kNoId) take(order_.front());
  return best;
}

MESHLODE_CLONED_FOR_AVX2
ProductSearch::Hit ProductSearch::find(const double* point, std::uint32_t hint, double enough2) const {
  if (order_.empty()) return {};
  double finite = 0.0;
  for (std::size_t d = 0; d < surface_.dimensions; ++d) finite += 0.0 * point[d];
  if (finite != 0.0) return {};
  // With a number that is known loops have no ends to look for.
  switch (surface_.dimensions) {
    case 5: return find_in<5>(point, hint, enough2);
    case 8: return find_in<8>(point, hint, enough2);
    default: return find_in<0>(point, hint, enough2);
  }
}

}  // namespace meshlode::builder
