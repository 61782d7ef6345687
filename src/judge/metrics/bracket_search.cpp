// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/bracket_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace meshlode::judge {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Of regula falsi. Most places are found in two; where a surface is flat to the last digits it is all the way to them.
constexpr int kMostSteps = 40;
constexpr double kInside = 1e-6;  // the least weight of each corner at a point that counts as inside

/// The largest number whose root is not above `distance`: what is compared squared is so as distances are. A corner
/// that was met at a distance is then near enough wherever that is, and each round of a search has something to split.
double square_of(double distance) {
  double square = distance * distance;
  while (std::sqrt(square) > distance) square = std::nextafter(square, 0.0);
  for (double next = square; square < kInfinity && std::sqrt(next) <= distance;) {
    square = next;
    next = std::nextafter(square, kInfinity);
  }
  return square;
}

}  // namespace

BracketSearch::BracketSearch(const BracketTarget& b, double known)
    : b_(b.surface), tree_(b.tree), parts_(b.parts), known_(known), known2_(square_of(known)) {}

BracketPiece BracketSearch::piece_of(const std::array<Vec3d, 3>& at,
                                     const std::array<std::uint32_t, 3>& nearest) const {
  BracketPiece piece;
  piece.at = at;
  for (const std::uint32_t k : nearest) add(piece, k);
  return piece;
}

void BracketSearch::renew(BracketPiece& piece) const {
  piece.near = {};
  for (std::size_t k = 0; k < piece.count; ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (is_near(piece.at[c], piece.candidates[k])) piece.near[c] |= static_cast<std::uint8_t>(1U << k);
    }
  }
}

NearParts BracketSearch::look_at(const BracketPiece& first, std::uint64_t most, BracketFound& found) {
  NearParts near;
  stack_.assign(1, first);
  const std::uint64_t end = found.splits + most;
  while (!stack_.empty()) {
    const BracketPiece piece = stack_.back();
    stack_.pop_back();
    if (const std::uint32_t all = piece.near[0] & piece.near[1] & piece.near[2]; all != 0) {
      near.add(part_of(piece.candidates[first_of(all)]));
      continue;
    }
    // A corner that is near to nothing stays so for as long as `known` is what it is.
    const bool is_far = piece.near[0] == 0 || piece.near[1] == 0 || piece.near[2] == 0;
    if (const std::uint32_t all = is_far ? kNoId : find_one_for_all(piece); all != kNoId) {
      near.add(part_of(all));
      continue;
    }
    if (is_far || found.splits == end) {
      found.open.push_back(piece);
      found.open.back().upper = upper_of(piece);
      near.give_up();
      continue;
    }
    ++found.splits;
    split(piece, found);
  }
  return near;
}

double BracketSearch::distance2(const Vec3d& p, std::uint32_t k) const {
  const auto& t = b_.triangles[k];
  return distance2_to_triangle(p, b_.positions[t[0]], b_.positions[t[1]], b_.positions[t[2]]);
}

bool BracketSearch::is_near(const Vec3d& p, std::uint32_t k) const {
  const auto& t = b_.triangles[k];
  return is_near_triangle(p, b_.positions[t[0]], b_.positions[t[1]], b_.positions[t[2]], known2_);
}

double BracketSearch::upper_of(const BracketPiece& piece) const {
  double least = kInfinity;
  for (std::size_t k = 0; k < piece.count; ++k) {
    double most = 0.0;
    for (const Vec3d& p : piece.at) most = std::max(most, distance2(p, piece.candidates[k]));
    least = std::min(least, most);
  }
  return std::min(piece.upper, std::sqrt(least));
}

std::uint8_t BracketSearch::near_of(const BracketPiece& piece, const Vec3d& p) const {
  std::uint8_t near = 0;
  for (std::size_t k = 0; k < piece.count; ++k) {
    if (is_near(p, piece.candidates[k])) near |= static_cast<std::uint8_t>(1U << k);
  }
  return near;
}

void BracketSearch::add(BracketPiece& piece, std::uint32_t triangle) const {
  std::size_t place = 0;
  while (place < piece.count && piece.candidates[place] != triangle) ++place;
  if (place < piece.count) return;
  if (place == BracketPiece::kMostCandidates) {
    int least = 4;
    for (std::size_t k = 0; k < BracketPiece::kMostCandidates; ++k) {
      int corners = 0;
      for (const std::uint8_t near : piece.near) {
        if ((near >> k & 1U) != 0) corners += near == 1U << k ? 4 : 1;  // not a corner's only one
      }
      if (corners >= least) continue;
      least = corners;
      place = k;
    }
  } else {
    ++piece.count;
  }
  piece.candidates[place] = triangle;
  for (std::size_t c = 0; c < 3; ++c) {
    const bool is_in = is_near(piece.at[c], triangle);
    const auto bit = static_cast<std::uint8_t>(1U << place);
    piece.near[c] = static_cast<std::uint8_t>(is_in ? piece.near[c] | bit : piece.near[c] & ~bit);
  }
}

std::uint32_t BracketSearch::find_one_for_all(const BracketPiece& piece) const {
  return piece.count == BracketPiece::kMostCandidates ? tree_.find_covering(piece.at, known2_) : kNoId;
}

std::uint8_t BracketSearch::ask(BracketPiece& piece, const Vec3d& p, std::uint32_t hint, BracketFound& found) {
  NearestPoint nearest = tree_.any_within(known2_, p, hint);
  if (nearest.triangle == kNoId) {
    nearest = tree_.nearest(p, hint);
    found.meet(std::sqrt(nearest.distance2), p);
  }
  add(piece, nearest.triangle);
  return near_of(piece, p);
}

void BracketSearch::split(BracketPiece piece, BracketFound& found) {
  if (const std::optional<Vec3d> meeting = meeting_inside(piece)) return split_at(piece, *meeting, found);
  std::size_t edge = 3;
  double longest = -1.0;
  for (std::size_t e = 0; e < 3; ++e) {
    const Vec3d way = piece.at[(e + 1) % 3] - piece.at[e];
    const double length2 = glm::dot(way, way);
    if ((piece.near[e] & piece.near[(e + 1) % 3]) != 0 || !(length2 > longest)) continue;
    longest = length2;
    edge = e;
  }
  if (edge == 3) return split_at(piece, (piece.at[0] + piece.at[1] + piece.at[2]) / 3.0, found);  // seldom
  Vec3d x;
  const std::uint8_t near = cross_edge(piece, edge, x, found);
  put(piece, (edge + 1) % 3, x, near);
  put(piece, edge, x, near);
}

void BracketSearch::put(const BracketPiece& piece, std::size_t corner, const Vec3d& x, std::uint8_t near) {
  stack_.push_back(piece);
  stack_.back().at[corner] = x;
  stack_.back().near[corner] = near;
}

std::uint8_t BracketSearch::cross_edge(BracketPiece& piece, std::size_t edge, Vec3d& x, BracketFound& found) {
  const Vec3d p = piece.at[edge], q = piece.at[(edge + 1) % 3];
  const std::uint32_t of_p = piece.candidates[first_of(piece.near[edge])];
  const std::uint32_t of_q = piece.candidates[first_of(piece.near[(edge + 1) % 3])];
  const auto difference = [&](const Vec3d& at) {
    return std::sqrt(distance2(at, of_p)) - std::sqrt(distance2(at, of_q));
  };
  // Each end is next to its own triangle.
  double low = 0.0, high = 1.0, at_low = -std::sqrt(distance2(p, of_q)), at_high = std::sqrt(distance2(q, of_p));
  bool is_asked = false;
  int side = 0;
  std::uint8_t near = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    double s = at_low < 0.0 && at_high > 0.0 ? low - at_low * (high - low) / (at_high - at_low) : 0.5 * (low + high);
    s = std::clamp(s, low + 0.02 * (high - low), high - 0.02 * (high - low));
    x = p + (q - p) * s;
    near = near_of(piece, x);
    // Again, for `ask` may have put another candidate in the place of one.
    const std::uint8_t of_low = piece.near[edge], of_high = piece.near[(edge + 1) % 3];
    if ((near & of_low) != 0 && (near & of_high) != 0) return near;
    if (near == 0 && !is_asked) {
      const std::uint8_t count = piece.count;
      near = ask(piece, x, of_p, found);
      is_asked = true;
      if (near == 0) return near;
      if (piece.count != count) return near;
      if ((near & piece.near[edge]) != 0 && (near & piece.near[(edge + 1) % 3]) != 0) return near;
    }
    const double f = difference(x);
    if (std::abs(f) < 1e-4 * known_ || high - low < 1e-14) break;
    // What is near says more than which of the two is nearer.
    if ((near & of_low) != 0 || ((near & of_high) == 0 && f < 0.0)) {
      low = s;
      at_low = f;
      if (side == 1) at_high *= 0.5;
      side = 1;
    } else {
      high = s;
      at_high = f;
      if (side == 2) at_low *= 0.5;
      side = 2;
    }
  }
  if (near != 0) x = 0.5 * p + 0.5 * q;  // there is no such place
  return ask(piece, x, of_p, found);
}

void BracketSearch::split_at(BracketPiece& piece, const Vec3d& x, BracketFound& found) {
  std::uint8_t near = near_of(piece, x);
  if (near == 0) near = ask(piece, x, piece.candidates[0], found);
  for (std::size_t c = 0; c < 3; ++c) put(piece, c, x, near);
}

bool BracketSearch::has_corner(const BracketPiece& piece, std::size_t corner, const Vec3d& v) const {
  for (std::uint32_t bits = piece.near[corner]; bits != 0; bits &= bits - 1) {
    for (const std::uint32_t w : b_.triangles[piece.candidates[first_of(bits)]]) {
      if (b_.positions[w] == v) return true;
    }
  }
  return false;
}

std::optional<Vec3d> BracketSearch::meeting_inside(const BracketPiece& piece) const {
  const Vec3d &p = piece.at[0], &q = piece.at[1], &r = piece.at[2];
  const Vec3d n = glm::cross(q - p, r - p);
  const auto nearest_inside = [&](const Vec3d& v) -> std::optional<Vec3d> {
    // Of weights: whatever rounding does to the normal of a needle, the point is of the piece.
    const double of_p = glm::dot(glm::cross(r - q, v - q), n), of_q = glm::dot(glm::cross(p - r, v - r), n),
                 of_r = glm::dot(glm::cross(q - p, v - p), n), sum = of_p + of_q + of_r;
    if (!(std::min(of_p, std::min(of_q, of_r)) > kInside * sum)) return std::nullopt;
    return p * (of_p / sum) + q * (of_q / sum) + r * (of_r / sum);
  };
  for (std::uint32_t bits = piece.near[0]; bits != 0; bits &= bits - 1) {
    for (const std::uint32_t w : b_.triangles[piece.candidates[first_of(bits)]]) {
      const Vec3d& v = b_.positions[w];
      if (!has_corner(piece, 1, v) || !has_corner(piece, 2, v)) continue;
      const std::optional<Vec3d> x = nearest_inside(v);
      if (x && glm::dot(*x - v, *x - v) <= known2_) return x;
    }
  }
  return std::nullopt;
}

}  // namespace meshlode::judge
