// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/overlay.h"

#include <algorithm>
#include <cmath>

namespace meshlode::builder {

bool Overlay::is_within(const TriangleCorners& corners, std::uint32_t start, double known, bool is_raised) {
  known_ = known;
  is_raised_ = is_raised;
  below_.clear();
  far_.clear();
  rest_.clear();
  size_ = 0;
  Piece& all = push();
  all.polygon.count = 0;
  for (const Vec3d& corner : corners) all.polygon.add(corner);
  all.polygon.fill_pair();
  all.triangle = start;
  all.entered = 3;
  for (std::size_t pieces = 0; size_ > 0 && pieces < most_pieces_; ++pieces) {
    const std::size_t top = size_ - 1;
    if (cuts_ == Cuts::kNeeded && is_surely_near(stack_[top]->polygon, below_of(stack_[top]->triangle))) {
      --size_;
      continue;
    }
    cut(*stack_[top]);
    check(*stack_[top]);
    // What was cut off lies above it.
    std::swap(stack_[top], stack_[size_ - 1]);
    --size_;
  }
  // Around a corner of the surface a piece may lie beyond the border of each triangle, and go round for ever.
  while (size_ > 0) check(*stack_[--size_]);
  return far_.empty() && rest_.empty();
}

Overlay::Piece& Overlay::push() {
  if (size_ == stack_.size()) stack_.push_back(&pieces_.emplace_back());
  return *stack_[size_++];
}

/// Many pieces lie over one triangle, and neighbours come one after the other.
const Overlay::Below& Overlay::below_of(std::uint32_t k) {
  if (held_.empty()) held_.resize(kHeld);
  Below& below = held_[k % kHeld];
  if (below.triangle == k) return below;
  below = {};
  below.triangle = k;
  below.corners = surface_.corners(k);
  const Vec3d ab = below.corners[1] - below.corners[0], ac = below.corners[2] - below.corners[0], bc = ac - ab;
  const Vec3d n = glm::cross(ab, ac);
  const double longest2 = std::max(glm::dot(ab, ab), std::max(glm::dot(ac, ac), glm::dot(bc, bc)));
  const double nn = glm::dot(n, n), inverse = 1.0 / nn;
  constexpr double kSmallestSine2 = 1e-10;  // as TriangleDistance: below, the normal is not trusted
  if (nn > kSmallestSine2 * longest2 * longest2 && std::isfinite(inverse)) {
    below.to_b = glm::cross(ac, n) * inverse;
    below.to_c = glm::cross(n, ab) * inverse;
    below.up = n * std::sqrt(inverse);
    below.longest = std::sqrt(longest2);
  }
  const Vec3d normal(surface_.normal_of(k));
  for (std::uint32_t e = 0; e < 3; ++e) {
    const std::uint32_t next = surface_.neighbor[k][e];
    if (next == kNoId) continue;
    const std::uint32_t other = next / 4;
    const Vec3d& from = below.corners[e];
    const Vec3d edge = below.corners[(e + 1) % 3] - from;
    const Vec3d& inner = below.corners[(e + 2) % 3];
    // Halfway between the two triangles: through the edge and along the mean of the normals, whichever way it winds.
    const Vec3d its_inner = surface_.positions[surface_.triangles[other][(next % 4 + 2) % 3]] - from;
    const Vec3d its_normal(surface_.normal_of(other));
    const bool is_turned = glm::dot(its_normal, glm::cross(its_inner, edge)) < 0.0;
    const Vec3d outward = glm::cross(edge, is_turned ? normal - its_normal : normal + its_normal);
    if (glm::dot(outward, inner - from) < 0.0) below.outward[e] = outward;  // else a needle, or folded back: it stays
  }
  return below;
}

/// Keeps what lies over the piece's triangle; what lies beyond its edges goes onto the stack.
MESHLODE_CLONED_FOR_AVX2
void Overlay::cut(Piece& piece) {
  const std::uint32_t k = piece.triangle, entered = piece.entered;
  const Below& below = below_of(k);
  Polygon& whole = piece.polygon;
  for (std::uint32_t e = 0; e < 3; ++e) {
    const std::uint32_t next = surface_.neighbor[k][e];
    if (next == kNoId || e == entered) continue;
    const Vec3d &from = below.corners[e], &outward = below.outward[e];
    std::array<Pair, kMostCorners / 2> heights;
    Pair most{}, least{};
    for (std::uint32_t i = 0; 2 * i < whole.count; ++i) {
      const Pair h = (outward.x * (whole.pair(0, i) - from.x) + outward.y * (whole.pair(1, i) - from.y)) +
                     outward.z * (whole.pair(2, i) - from.z);
      heights[i] = h;
      most = h > most ? h : most;
      least = h < least ? h : least;
    }
    if (!(most[0] > 0.0 || most[1] > 0.0)) continue;  // nothing lies beyond: nearly always
    std::array<double, kMostCorners> height;
    std::memcpy(height.data(), heights.data(), sizeof(height));
    const auto next_of = [&](std::uint32_t i) { return i + 1 == whole.count ? 0 : i + 1; };
    std::uint32_t crossings = 0;
    for (std::uint32_t i = 0; i < whole.count; ++i)
      crossings += (height[i] > 0.0) != (height[next_of(i)] > 0.0) ? 1 : 0;
    // Rounding can make a sliver cross more than twice: it stays whole, as does what has no room for corners.
    if (crossings > 2 || whole.count + 2 > kMostCorners) continue;
    Piece& beyond = push();
    beyond.triangle = next / 4;
    beyond.entered = next % 4;
    if (!(least[0] < 0.0 || least[1] < 0.0)) {
      beyond.polygon = whole;
      whole.count = 0;
      return;
    }
    Polygon inside;
    inside.count = beyond.polygon.count = 0;
    for (std::uint32_t i = 0; i < whole.count; ++i) {
      const std::uint32_t j = next_of(i);
      if (height[i] <= 0.0) inside.add(whole.corner(i));
      if (height[i] >= 0.0) beyond.polygon.add(whole.corner(i));
      if ((height[i] > 0.0 && height[j] < 0.0) || (height[i] < 0.0 && height[j] > 0.0)) {
        const Vec3d x = whole.corner(i) + (whole.corner(j) - whole.corner(i)) * (height[i] / (height[i] - height[j]));
        inside.add(x);
        beyond.polygon.add(x);
      }
    }
    inside.fill_pair();
    beyond.polygon.fill_pair();
    whole = inside;
  }
}

/// Whether the corners of a piece are near to the triangle below for certain: where weights of its corners are below 0,
/// the point with these at 0 is no farther than they are in all times the longest edge. No division a corner, and
/// hardly a branch: nearly all pieces end here.
MESHLODE_CLONED_FOR_AVX2
bool Overlay::is_surely_near(const Polygon& p, const Below& below) const {
  const auto dot = [](const Vec3d& n, const std::array<Pair, 3>& at) {
    return (n.x * at[0] + n.y * at[1]) + n.z * at[2];
  };
  const auto positive = [](const Pair& a) { return a > 0.0 ? a : Pair{}; };
  Pair most{};
  for (std::uint32_t i = 0; 2 * i < p.count; ++i) {
    const std::array<Pair, 3> pa{p.pair(0, i) - below.corners[0].x, p.pair(1, i) - below.corners[0].y,
                                 p.pair(2, i) - below.corners[0].z};
    const Pair b = dot(below.to_b, pa), c = dot(below.to_c, pa), up = dot(below.up, pa);
    const Pair negative = (positive(-b) + positive(-c)) + positive(b + c - 1.0);
    const Pair height = up < 0.0 ? -up : up;
    const Pair distance = height + negative * below.longest;
    most = distance > most ? distance : most;
  }
  constexpr double kRounding = 1e-6, kRoundingOfEdge = 1e-8;  // far more than doubles are off by
  return std::max(most[0], most[1]) <= (1.0 - kRounding) * known_ - kRoundingOfEdge * below.longest;
}

/// By its corners all of a piece is near to the triangle below, or to what is nearest to one of them; or it is left.
void Overlay::check(const Piece& piece) {
  const Polygon& p = piece.polygon;
  if (p.count == 0) return;
  below_.push_back(piece.triangle);
  const Below& triangle = below_of(piece.triangle);
  if (is_surely_near(p, triangle)) return;
  const auto squared_bound = [&p](const TriangleDistance& distance) {
    double most2 = 0.0;
    for (std::uint32_t i = 0; i < p.count; ++i) most2 = std::max(most2, distance.squared_to(p.corner(i)));
    return most2;
  };
  const TriangleDistance below(triangle.corners);
  double bound2 = squared_bound(below);
  if (bound2 <= known_ * known_) return;
  for (std::uint32_t i = 0; i < p.count; ++i) {
    const Vec3d x = p.corner(i);
    if (below.squared_to(x) <= known_ * known_) continue;
    const SurfaceTree& tree = surface_.tree;
    const Vec3f at = tree.to_frame(x);
    const float enough = tree.squared_in_frame(known_);
    SurfaceTree::Hit hit = tree.look_around(at, surface_.slot[piece.triangle], {});
    if (!(hit.distance2 <= enough)) hit = tree.find_nearest(at, hit, enough);
    const std::uint32_t nearest = tree.triangle_at(hit.slot);
    const double distance = std::sqrt(tree.distance2_at(x, hit.slot));
    far_.push_back({x, piece.triangle, nearest, distance > known_ ? distance : 0.0});
    if (is_raised_) known_ = std::max(known_, distance);
    bound2 = std::min(bound2, squared_bound(TriangleDistance(surface_.corners(nearest))));
  }
  if (bound2 > known_ * known_) leave(piece, std::sqrt(bound2));
}

void Overlay::leave(const Piece& piece, double bound) {
  const Polygon& p = piece.polygon;
  for (std::uint32_t i = 1; i + 1 < p.count; ++i) {
    rest_.push_back({{p.corner(0), p.corner(i), p.corner(i + 1)}, piece.triangle, bound});
  }
}

}  // namespace meshlode::builder
