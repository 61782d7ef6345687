// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/aggregate_choice.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "base/disjoint_sets.h"

namespace meshlode::build {

namespace {

constexpr std::uint64_t kFewestPieces = 256;
constexpr std::uint64_t kSmallPiece = 32, kLargestPiece = 512;  // triangles
constexpr double kSmallShare = 0.98;                            // of the triangles are in small pieces
constexpr double kWidestPiece = 0.2;                            // of the mesh's diagonal: the middle one of all pieces

struct Piece {
  std::uint64_t triangles = 0;
  Vec3d low{0.0}, high{0.0};
};

bool is_before(const Vec3d& a, const Vec3d& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// Parts of the mesh that share no exact position.
std::vector<Piece> pieces_of(const scene::SourceMesh& mesh) {
  std::vector<Vec3d> positions;
  std::vector<std::size_t> base;
  for (const scene::Primitive& primitive : mesh.primitives) {
    base.push_back(positions.size());
    positions.insert(positions.end(), primitive.positions.begin(), primitive.positions.end());
  }
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (is_before(positions[a], positions[b])) return true;
    return !is_before(positions[b], positions[a]) && a < b;
  });
  DisjointSets sets(positions.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (positions[order[i - 1]] == positions[order[i]]) sets.join(order[i - 1], order[i]);
  }
  const auto for_each_triangle = [&](const auto& visit) {
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const std::vector<std::uint32_t>& indices = mesh.primitives[p].indices;
      for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        visit(static_cast<std::uint32_t>(base[p] + indices[i]), static_cast<std::uint32_t>(base[p] + indices[i + 1]),
              static_cast<std::uint32_t>(base[p] + indices[i + 2]));
      }
    }
  };
  for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    sets.join(a, b);
    sets.join(b, c);
  });
  std::vector<std::uint32_t> piece_of(positions.size(), kNoId);
  std::vector<Piece> pieces;
  for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    std::uint32_t& number = piece_of[sets.find(a)];
    if (number == kNoId) {
      number = static_cast<std::uint32_t>(pieces.size());
      pieces.push_back({0, positions[a], positions[a]});
    }
    Piece& piece = pieces[number];
    ++piece.triangles;
    for (const std::uint32_t v : {a, b, c}) {
      piece.low = glm::min(piece.low, positions[v]);
      piece.high = glm::max(piece.high, positions[v]);
    }
  });
  return pieces;
}

}  // namespace

AggregateDecision decide_aggregate(const scene::SourceMesh& mesh, AggregateChoice choice, bool keep_topology) {
  if (choice == AggregateChoice::kNever) return {};
  if (keep_topology) return {false, "its topology is kept, and so is each piece"};
  const std::vector<Piece> pieces = pieces_of(mesh);
  if (pieces.empty()) return {false, "it has no triangles"};
  std::uint64_t triangles = 0, in_small = 0, largest = 0;
  Vec3d low = pieces.front().low, high = pieces.front().high;
  std::vector<double> widths;
  for (const Piece& piece : pieces) {
    triangles += piece.triangles;
    if (piece.triangles <= kSmallPiece) in_small += piece.triangles;
    largest = std::max(largest, piece.triangles);
    low = glm::min(low, piece.low);
    high = glm::max(high, piece.high);
    widths.push_back(glm::length(piece.high - piece.low));
  }
  std::string what =
      std::to_string(pieces.size()) + " pieces, the largest of " + std::to_string(largest) + " triangles";
  if (largest > kLargestPiece) return {false, what + ": too many for one of many cards"};
  if (choice == AggregateChoice::kAlways) return {true, what};
  std::nth_element(widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2), widths.end());
  const double width = widths[widths.size() / 2];
  if (pieces.size() < kFewestPieces) return {false, what + ": too few to be seen together"};
  if (static_cast<double>(in_small) < kSmallShare * static_cast<double>(triangles))
    return {false, what + ": not all are small"};
  if (width > kWidestPiece * glm::length(high - low)) return {false, what + ": as wide as much of the mesh"};
  return {true, what};
}

}  // namespace meshlode::build
