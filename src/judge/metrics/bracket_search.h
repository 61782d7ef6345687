// SPDX-License-Identifier: GPL-3.0-or-later
// The search of a bracket: pieces of one surface, split until another surface is near to all of each.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "judge/metrics/surface_bracket.h"

namespace meshlode::judge {

/// A part of a triangle, and what it may be near to.
struct BracketPiece {
  static constexpr std::size_t kMostCandidates = 8;
  std::array<Vec3d, 3> at;
  std::array<std::uint32_t, kMostCandidates> candidates;  ///< triangles of the other surface
  /// Of each corner: a bit for each candidate that is near enough to it.
  std::array<std::uint8_t, 3> near{};
  std::uint8_t count = 0;
  double upper = std::numeric_limits<double>::infinity();  ///< of an open piece
};

/// What a search has come to.
struct BracketFound {
  double lower = -1.0;
  Vec3d worst{0.0};
  std::uint64_t splits = 0;
  std::vector<BracketPiece> open;

  void meet(double distance, const Vec3d& at) {
    if (distance > lower) {
      lower = distance;
      worst = at;
    }
  }
  void add(const BracketFound& part) {
    meet(part.lower, part.worst);
    splits += part.splits;
    open.insert(open.end(), part.open.begin(), part.open.end());
  }
};

/// Looks at pieces of one surface, to find whether another is nearer than `known` everywhere.
class BracketSearch {
 public:
  BracketSearch(const BracketTarget& b, double known);

  /// A triangle with the nearest triangles of its corners.
  BracketPiece piece_of(const std::array<Vec3d, 3>& at, const std::array<std::uint32_t, 3>& nearest) const;

  /// What is near was asked with another limit.
  void renew(BracketPiece& piece) const;

  /// Splits a piece until all of it is near enough, or `most` splits are done; what is open then is left in `found`.
  NearParts look_at(const BracketPiece& first, std::uint64_t most, BracketFound& found);

 private:
  [[nodiscard]] static std::size_t first_of(std::uint32_t bits) {
    return static_cast<std::size_t>(std::countr_zero(bits));
  }
  [[nodiscard]] std::uint32_t part_of(std::uint32_t triangle) const { return parts_.empty() ? 0 : parts_[triangle]; }

  [[nodiscard]] double distance2(const Vec3d& p, std::uint32_t k) const;

  [[nodiscard]] bool is_near(const Vec3d& p, std::uint32_t k) const;

  [[nodiscard]] double upper_of(const BracketPiece& piece) const;

  /// The candidates that are near enough to a point.
  [[nodiscard]] std::uint8_t near_of(const BracketPiece& piece, const Vec3d& p) const;

  /// Adds a candidate, where there is no room in place of one that says least.
  void add(BracketPiece& piece, std::uint32_t triangle) const;

  /// A triangle that all of a piece with as many candidates as it holds is near to, or kNoId. Among triangles that
  /// cross, many are near to each corner, and seldom the one that is near to all. The tree is not asked for other
  /// pieces: that takes a third more time for the bunny.
  [[nodiscard]] std::uint32_t find_one_for_all(const BracketPiece& piece) const;

  /// A triangle that is near enough to a point becomes a candidate, or where there is none the nearest.
  std::uint8_t ask(BracketPiece& piece, const Vec3d& p, std::uint32_t hint, BracketFound& found);

  void split(BracketPiece piece, BracketFound& found);

  /// The part in which x is in place of a corner.
  void put(const BracketPiece& piece, std::size_t corner, const Vec3d& x, std::uint8_t near);

  /// A point of an edge on which one candidate is near to the one half, and one to the other, if there is one. By
  /// regula falsi (Illinois) on the difference of the distances.
  std::uint8_t cross_edge(BracketPiece& piece, std::size_t edge, Vec3d& x, BracketFound& found);

  /// Into three, at a point inside.
  void split_at(BracketPiece& piece, const Vec3d& x, BracketFound& found);

  /// Whether a triangle that a corner is near to has a vertex there.
  [[nodiscard]] bool has_corner(const BracketPiece& piece, std::size_t corner, const Vec3d& v) const;

  /// The point inside that is nearest to a vertex which triangles near to each of the corners share, if it is near
  /// enough to it. Splits of edges come ever closer to such a vertex, and never there: by them alone, 20 flat sheets of
  /// 2,500 triangles leave 8 of their 10 cuts undecided.
  [[nodiscard]] std::optional<Vec3d> meeting_inside(const BracketPiece& piece) const;

  const Surface& b_;
  const TriangleTree& tree_;
  std::span<const std::uint32_t> parts_;
  double known_, known2_;
  std::vector<BracketPiece> stack_;
};

}  // namespace meshlode::judge
