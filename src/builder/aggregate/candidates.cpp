// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/candidates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "builder/aggregate/views.h"
#include "builder/symmetric.h"

namespace meshlode::builder {

namespace {

/// What a block shows to each view: the sum of its cards' areas as seen from there.
using Shown = std::array<double, kViews>;

Shown shown_by(const Vec3d& normal, double area) {
  Shown shown{};
  for (std::size_t v = 0; v < kViews; ++v) {
    shown[v] = area * std::fabs(glm::dot(normal, views()[v].toward));
  }
  return shown;
}

/// Mixes bits: which member stays must not follow the order of cards.
std::uint32_t scrambled(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  return x ^ x >> 16U;
}

constexpr double kSlender = 1.8;  // from then on a card is a blade
// Of a needle, by its block's: its ends lie in the neighbours' blocks, as theirs lie in it. Between 2 and 3 there is
// little to choose; longer ones stick out of a crown.
constexpr double kNeedleLength = 2.5;

Splat splat_of(const Card& card) {
  Splat splat;
  splat.center = card.center;
  splat.axis_u = card.axis_u;
  splat.axis_v = card.axis_v;
  splat.half_u = card.half_u;
  splat.half_v = card.half_v;
  splat.area = card.area;
  splat.is_blade = card.half_u >= kSlender * card.half_v;
  splat.material = card.material;
  return splat;
}

/// A block's cards together.
struct Block {
  std::vector<std::uint32_t> members;  ///< of Cards
  double area = 0.0;
  Vec3d center{0.0};
  Mat3d covariance{0.0};
  std::uint32_t material = 0;  ///< the one of most area

  Block(const Cards& cards, std::span<const std::uint32_t> chosen, std::span<const std::uint32_t> places) {
    std::map<std::uint32_t, double> of_material;
    for (const std::uint32_t place : places) {
      const Card& card = cards.cards[chosen[place]];
      members.push_back(chosen[place]);
      area += card.area;
      center += card.center * card.area;
      of_material[card.material] += card.area;
    }
    center /= area;
    for (const std::uint32_t member : members) {
      const Card& card = cards.cards[member];
      const Vec3d off = card.center - center;
      const Mat3d own = outer(card.axis_u, card.axis_u) * (0.25 * card.half_u * card.half_u) +
                        outer(card.axis_v, card.axis_v) * (0.25 * card.half_v * card.half_v);
      covariance += (outer(off, off) + own) * (card.area / area);
    }
    material = std::max_element(of_material.begin(), of_material.end(), [](const auto& a, const auto& b) {
                 return a.second < b.second;
               })->first;
  }
};

/// The member whose plane, with all of the block's area, is nearest to what is owed; `owed` keeps what is left.
std::uint32_t choose_member(const Cards& cards, const Block& block, Shown& owed) {
  constexpr std::size_t kTried = 24;
  for (const std::uint32_t member : block.members) {
    const Shown shown = shown_by(cards.cards[member].normal(), cards.cards[member].area);
    for (std::size_t v = 0; v < kViews; ++v) owed[v] += shown[v];
  }
  std::uint32_t best = block.members.front();
  double least = 1e300;
  Shown of_best{};
  const std::size_t tried = std::min(kTried, block.members.size());
  for (std::size_t i = 0; i < tried; ++i) {
    const std::uint32_t member = block.members[i * block.members.size() / tried];
    const Shown shown = shown_by(cards.cards[member].normal(), block.area);
    double squares = 0.0;
    for (std::size_t v = 0; v < kViews; ++v) squares += (owed[v] - shown[v]) * (owed[v] - shown[v]);
    if (squares < least) {
      least = squares;
      best = member;
      of_best = shown;
    }
  }
  for (std::size_t v = 0; v < kViews; ++v) owed[v] -= of_best[v];
  return best;
}

/// In the plane of the member: the slice of the block's ellipsoid.
void shape_as_slice(const Block& block, Splat& splat) {
  // A flat block has no inverse: a hundredth of its extent is added all around.
  const double extent = block.covariance[0][0] + block.covariance[1][1] + block.covariance[2][2];
  const Mat3d inverse = glm::inverse(block.covariance + Mat3d(1e-4 * extent));
  const Vec3d u = splat.axis_u, v = splat.axis_v;
  Mat3d across(0.0);
  const double uu = glm::dot(u, inverse * u), uv = glm::dot(u, inverse * v), vv = glm::dot(v, inverse * v);
  across = outer(u, u) * uu + outer(v, v) * vv + (outer(u, v) + outer(v, u)) * uv;
  const Axes axes = axes_of(across);
  // The longest way is the one along which the inverse is least; the third axis is the normal.
  const Vec3d normal = glm::cross(u, v);
  Vec3d longest = axes.direction[1] - normal * glm::dot(normal, axes.direction[1]);
  const double length = glm::length(longest);
  if (!(length > 0.5)) longest = u;
  splat.axis_u = longest / glm::length(longest);
  splat.axis_v = glm::cross(normal, splat.axis_u);
  splat.half_u = 2.0 / std::sqrt(std::max(axes.value[1], 1e-300));
  splat.half_v = 2.0 / std::sqrt(std::max(axes.value[0], 1e-300));
  // A flat block may have more area than its slice: that goes across first, or a card would be longer than the mesh.
  constexpr double kPi = 3.14159265358979;
  const double roomy = block.area / (2.0 * kPi * splat.half_u);
  splat.half_v = std::max(splat.half_v, std::min(splat.half_u, roomy));
}

/// Those of the member whose plane it is: means of texture coordinates would belong to no leaf.
void copy_attributes(const Cards& cards, std::uint32_t member, std::size_t stride, std::vector<float>& out) {
  const auto first = cards.attributes.begin() + static_cast<std::ptrdiff_t>(member * stride);
  out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(stride));
}

}  // namespace

Splats splats_of(const Cards& cards, std::span<const std::uint32_t> chosen, std::size_t stride) {
  Splats out;
  out.splats.reserve(chosen.size());
  out.attributes.reserve(stride * chosen.size());
  for (const std::uint32_t c : chosen) {
    Splat splat = splat_of(cards.cards[c]);
    splat.turn = scrambled(c) & 3U;
    out.splats.push_back(splat);
    copy_attributes(cards, c, stride, out.attributes);
  }
  return out;
}

Splats thin_out(const Cards& cards, std::span<const std::uint32_t> chosen, const Blocks& blocks, Thinning thinning,
                std::size_t stride) {
  Splats out;
  out.splats.reserve(blocks.size());
  out.attributes.reserve(stride * blocks.size());
  Shown owed{};
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block block(cards, chosen, blocks.of(b));
    const std::uint32_t member = thinning == Thinning::kInPlace
                                     ? block.members[scrambled(block.members.front()) % block.members.size()]
                                     : choose_member(cards, block, owed);
    Splat splat = splat_of(cards.cards[member]);
    splat.area = block.area;
    splat.material = block.material;
    splat.turn = scrambled(member) & 3U;
    if (thinning != Thinning::kInPlace) splat.center = block.center;
    if (thinning == Thinning::kMerged || thinning == Thinning::kNeedle) {
      splat.is_blade = false;
      shape_as_slice(block, splat);
    }
    if (thinning == Thinning::kNeedle) splat.stretch_to_blade(kNeedleLength);
    out.splats.push_back(splat);
    copy_attributes(cards, member, stride, out.attributes);
  }
  return out;
}

}  // namespace meshlode::builder
