// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/pieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "builder/symmetric.h"

namespace meshlode::builder {

namespace {

/// Area, first and second moments of what a piece draws.
struct Moments {
  double area = 0.0;
  Vec3d first{0.0};
  Mat3d second{0.0};

  void add_point(const Vec3d& p, double mass) {
    area += mass;
    first += p * mass;
    second += outer(p, p) * mass;
  }
  [[nodiscard]] Vec3d center() const { return first / area; }
  [[nodiscard]] Mat3d covariance() const {
    const Vec3d c = center();
    return second * (1.0 / area) - outer(c, c);
  }
};

/// A triangle's moments are those of its middles of edges, a third of the area each.
void add_triangle(const Corners& c, double area, Moments& moments) {
  for (int k = 0; k < 3; ++k) moments.add_point(0.5 * (c[k] + c[(k + 1) % 3]), area / 3.0);
}

/// The same of the part that is drawn, from the middles of 12 × 12 equal triangles. \returns the share
double add_drawn_part(const Corners& c, const std::array<Vec2d, 3>& uv, double area, const AlphaTest& covers,
                      Moments& moments) {
  constexpr int kSide = 12;
  const double mass = area / (kSide * kSide);
  int drawn = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < 2 * (kSide - i) - 1; ++j) {
      const double a = (i + (j % 2 == 0 ? 1.0 : 2.0) / 3.0) / kSide;
      const int pair = j / 2;
      const double b = (pair + (j % 2 == 0 ? 1.0 : 2.0) / 3.0) / kSide;
      const double rest = 1.0 - a - b;
      const Vec2d at = rest * uv[0] + a * uv[1] + b * uv[2];
      if (!covers(at.x, at.y)) continue;
      ++drawn;
      moments.add_point(rest * c[0] + a * c[1] + b * c[2], mass);
    }
  }
  return static_cast<double>(drawn) / (kSide * kSide);
}

/// Does every edge have as many uses one way as the other? By welded positions.
bool is_closed(const PreparedMesh& mesh, std::span<const std::uint32_t> triangles) {
  struct Use {
    std::uint32_t low, high;
    int way;
  };
  std::vector<Use> uses;
  uses.reserve(3 * triangles.size());
  for (const std::uint32_t t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.wedge_position[mesh.triangles[t][k]];
      const std::uint32_t b = mesh.wedge_position[mesh.triangles[t][(k + 1) % 3]];
      uses.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  for (std::size_t i = 0; i < uses.size();) {
    int sum = 0;
    const Use edge = uses[i];
    for (; i < uses.size() && uses[i].low == edge.low && uses[i].high == edge.high; ++i) sum += uses[i].way;
    if (sum != 0) return false;
  }
  return true;
}

/// What one piece adds.
struct CardsOfPiece {
  std::vector<Card> cards;
  std::vector<float> attributes;  ///< of each
  bool is_closed = false;
};

/// Normals and colours as the surface has them on average, and the texture coordinates of its middle.
std::vector<float> mean_attributes(const PreparedMesh& mesh, std::span<const std::uint32_t> triangles,
                                   std::span<const double> areas, const Vec3d& fallback_normal) {
  const std::size_t stride = mesh.layout.stride();
  std::vector<double> sum(stride, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t wedge : mesh.triangles[triangles[i]]) {
      for (std::size_t k = 0; k < stride; ++k) sum[k] += areas[i] * double{mesh.wedge_attributes[wedge * stride + k]};
    }
    total += 3.0 * areas[i];
  }
  std::vector<float> mean(stride);
  for (std::size_t k = 0; k < stride; ++k) mean[k] = static_cast<float>(sum[k] / total);
  if (mesh.layout.has_normal) {
    Vec3d normal(sum[0], sum[1], sum[2]);
    const double length = glm::length(normal);
    normal = length > 0.05 * total ? normal / length : fallback_normal;
    for (int k = 0; k < 3; ++k) mean[static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
  }
  return mean;
}

/// In the plane across `normal`: axes and half axes of the moments there.
Card card_in_plane(const Moments& moments, const Mat3d& covariance, const Vec3d& normal, double area) {
  const Mat3d across = Mat3d(1.0) - outer(normal, normal);
  const Axes axes = axes_of(across * covariance * across);
  Card card;
  card.center = moments.center();
  // Where the moments leave an axis open, rounding may tilt it out of the plane.
  Vec3d u = across * axes.direction[0];
  card.axis_u = u / glm::length(u);
  card.axis_v = glm::cross(normal, card.axis_u);
  constexpr double kFlattest = 1e-4;  // of a needle
  card.half_u = 2.0 * std::sqrt(axes.value[0]);
  card.half_v = std::max(2.0 * std::sqrt(axes.value[1]), kFlattest * card.half_u);
  card.area = area;
  return card;
}

CardsOfPiece cards_of(const PreparedMesh& mesh, std::span<const std::uint32_t> triangles,
                      std::span<const SourceMaterial> materials) {
  CardsOfPiece out;
  Moments moments;
  Mat3d normals(0.0);  // the sum of area · n · nᵀ
  Vec3d facing(0.0);
  std::vector<double> areas(triangles.size(), 0.0);
  std::map<std::uint32_t, double> area_of_material;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Corners corners = corners_of(mesh, triangles[i]);
    const Vec3d twice = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(twice);
    if (!(length > 0.0)) continue;
    areas[i] = 0.5 * length;
    const SourceMaterial& material = materials[mesh.triangle_material[triangles[i]]];
    if (material.covers) {
      areas[i] *= add_drawn_part(corners, corner_uvs(mesh, triangles[i], material), areas[i], material.covers, moments);
    } else {
      add_triangle(corners, areas[i], moments);
    }
    const Vec3d normal = twice / length;
    normals += outer(normal, normal) * areas[i];
    facing += normal * areas[i];
    area_of_material[mesh.triangle_material[triangles[i]]] += areas[i];
  }
  if (!(moments.area > 0.0)) return out;
  const std::uint32_t material =
      std::max_element(area_of_material.begin(), area_of_material.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->first;
  const Mat3d covariance = moments.covariance();
  const Axes sides = axes_of(normals);
  constexpr double kFlat = 0.9;  // of the area looks one way, or the other
  const bool is_flat = sides.value[0] >= kFlat * moments.area;
  const bool is_shut = is_closed(mesh, triangles);
  out.is_closed = is_shut && std::none_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
                    return static_cast<bool>(materials[mesh.triangle_material[t]].covers);
                  });
  const double share = is_shut ? 0.5 : 1.0;  // of a closed piece one side is seen
  for (std::size_t k = 0; k < (is_flat ? 1U : 3U); ++k) {
    Vec3d normal = sides.direction[k];
    if (glm::dot(normal, facing) < 0.0) normal = -normal;
    double seen = 0.0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (areas[i] == 0.0) continue;
      const Corners c = corners_of(mesh, triangles[i]);
      const Vec3d twice = glm::cross(c[1] - c[0], c[2] - c[0]);
      seen += areas[i] * std::fabs(glm::dot(twice, normal)) / glm::length(twice);
    }
    const double area = share * (is_flat ? moments.area : seen);
    if (!(area > 0.0)) continue;
    Card card = card_in_plane(moments, covariance, normal, area);
    if (!(card.half_u > 0.0)) continue;
    card.material = material;
    out.cards.push_back(card);
    const std::vector<float> mean = mean_attributes(mesh, triangles, areas, normal);
    out.attributes.insert(out.attributes.end(), mean.begin(), mean.end());
  }
  return out;
}

}  // namespace

Corners corners_of(const PreparedMesh& mesh, std::size_t triangle) {
  const WedgeTriangle& t = mesh.triangles[triangle];
  const auto corner = [&](std::size_t k) { return mesh.grid.decode(mesh.positions[mesh.wedge_position[t[k]]]); };
  return {corner(0), corner(1), corner(2)};
}

ByPiece find_pieces(const PreparedMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  DisjointSets sets(mesh.positions.size());
  for (const WedgeTriangle& t : mesh.triangles) {
    sets.join(mesh.wedge_position[t[0]], mesh.wedge_position[t[1]]);
    sets.join(mesh.wedge_position[t[1]], mesh.wedge_position[t[2]]);
  }
  std::vector<std::uint32_t> piece_of_root(mesh.positions.size(), kNoId), piece_of(count);
  ByPiece pieces;
  pieces.first.push_back(0);
  for (std::size_t t = 0; t < count; ++t) {
    std::uint32_t& piece = piece_of_root[sets.find(mesh.wedge_position[mesh.triangles[t][0]])];
    if (piece == kNoId) {
      piece = static_cast<std::uint32_t>(pieces.first.size() - 1);
      pieces.first.push_back(0);
    }
    piece_of[t] = piece;
    ++pieces.first[piece + 1];
  }
  for (std::size_t p = 1; p < pieces.first.size(); ++p) pieces.first[p] += pieces.first[p - 1];
  std::vector<std::uint32_t> next(pieces.first.begin(), pieces.first.end() - 1);
  pieces.items.resize(count);
  for (std::size_t t = 0; t < count; ++t) pieces.items[next[piece_of[t]]++] = static_cast<std::uint32_t>(t);
  return pieces;
}

std::array<Vec2d, 3> corner_uvs(const PreparedMesh& mesh, std::size_t triangle, const SourceMaterial& material) {
  std::array<Vec2d, 3> uv{};
  const auto* begin = mesh.layout.uv_set_source.begin();
  const auto* end = begin + mesh.layout.uv_set_count;
  const auto* set = std::find(begin, end, material.uv_set);
  if (set == end) return uv;
  const std::size_t at = mesh.layout.uv_offset() + 2 * static_cast<std::size_t>(set - begin);
  for (std::size_t k = 0; k < 3; ++k) {
    const float* values = &mesh.wedge_attributes[mesh.triangles[triangle][k] * mesh.layout.stride() + at];
    uv[k] = {double{values[0]}, double{values[1]}};
  }
  return uv;
}

PieceCards make_cards(const PreparedMesh& mesh, const ByPiece& pieces, std::span<const SourceMaterial> materials) {
  constexpr std::size_t kAtOnce = 16384;  // pieces; of millions the small arrays would take more than all cards do
  PieceCards out;
  out.first.push_back(0);
  out.is_closed.resize(mesh.triangles.size());
  for (std::size_t begin = 0; begin < pieces.size(); begin += kAtOnce) {
    std::vector<CardsOfPiece> of_piece(std::min(kAtOnce, pieces.size() - begin));
    parallel_for_each_index(of_piece.size(), 64,
                            [&](std::size_t i) { of_piece[i] = cards_of(mesh, pieces.of(begin + i), materials); });
    for (std::size_t i = 0; i < of_piece.size(); ++i) {
      const CardsOfPiece& piece = of_piece[i];
      for (const std::uint32_t t : pieces.of(begin + i)) out.is_closed[t] = piece.is_closed ? 1 : 0;
      out.cards.cards.insert(out.cards.cards.end(), piece.cards.begin(), piece.cards.end());
      out.cards.attributes.insert(out.cards.attributes.end(), piece.attributes.begin(), piece.attributes.end());
      out.first.push_back(static_cast<std::uint32_t>(out.cards.size()));
    }
  }
  return out;
}

}  // namespace meshlode::builder
