// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/split_mesh.h"

#include <algorithm>
#include <cstddef>

#include "base/ids.h"
#include "base/release.h"
#include "builder/aggregate/pieces.h"

namespace meshlode::builder {

namespace {

/// The members of a list that are used, renumbered in their order.
class Kept {
 public:
  explicit Kept(std::size_t count) : number_(count, kNoId) {}
  void use(std::uint32_t id) { number_[id] = 0; }
  /// After the last use().
  void number_all() {
    for (std::uint32_t& number : number_) {
      if (number != kNoId) number = count_++;
    }
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t id) const { return number_[id]; }

  /// `width` values each.
  template <class T>
  [[nodiscard]] std::vector<T> of_kept(const std::vector<T>& all, std::size_t width = 1) const {
    std::vector<T> kept;
    kept.reserve(width * count_);
    for (std::size_t i = 0; i < number_.size(); ++i) {
      if (number_[i] == kNoId) continue;
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(width * i);
      kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(width));
    }
    return kept;
  }

 private:
  std::vector<std::uint32_t> number_;
  std::uint32_t count_ = 0;
};

/// The triangles that have the flag.
PreparedMesh part_of(const PreparedMesh& mesh, std::span<const std::uint8_t> flags, std::uint8_t flag,
                     std::uint64_t pieces) {
  PreparedMesh part;
  part.name = mesh.name;
  part.origin = mesh.origin;
  part.grid = mesh.grid;
  part.diagonal = mesh.diagonal;
  part.level0_deviation = mesh.level0_deviation;
  part.layout = mesh.layout;
  part.piece_count = pieces;
  Kept wedges(mesh.wedge_position.size()), positions(mesh.positions.size()), exact(mesh.exact_positions.size());
  for (std::size_t t = 0; t < flags.size(); ++t) {
    if (flags[t] != flag) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      wedges.use(mesh.triangles[t][k]);
      positions.use(mesh.wedge_position[mesh.triangles[t][k]]);
      exact.use(mesh.exact_triangles[t][k]);
    }
  }
  wedges.number_all();
  positions.number_all();
  exact.number_all();
  part.positions = positions.of_kept(mesh.positions);
  part.exact_positions = exact.of_kept(mesh.exact_positions);
  part.exact_on_grid = exact.of_kept(mesh.exact_on_grid);
  part.wedge_position = wedges.of_kept(mesh.wedge_position);
  for (std::uint32_t& position : part.wedge_position) position = positions.of(position);
  part.wedge_attributes = wedges.of_kept(mesh.wedge_attributes, mesh.layout.stride());
  for (std::size_t t = 0; t < flags.size(); ++t) {
    if (flags[t] != flag) continue;
    WedgeTriangle triangle = mesh.triangles[t];
    std::array<std::uint32_t, 3> corners = mesh.exact_triangles[t];
    for (std::uint32_t& wedge : triangle) wedge = wedges.of(wedge);
    for (std::uint32_t& corner : corners) corner = exact.of(corner);
    part.triangles.push_back(triangle);
    part.exact_triangles.push_back(corners);
    part.triangle_material.push_back(mesh.triangle_material[t]);
  }
  part.source_triangles = part.triangles.size();
  part.source_vertices = part.wedge_position.size();
  return part;
}

}  // namespace

SplitMesh split_and_free(PreparedMesh& mesh, std::span<const std::uint32_t> most_triangles) {
  const ByPiece pieces = find_pieces(mesh);
  std::vector<std::uint8_t> is_loose(mesh.triangles.size(), 0);
  std::uint64_t loose = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto triangles = pieces.of(p);
    const bool is_in = std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
      const std::uint32_t material = mesh.triangle_material[t];
      return material < most_triangles.size() && triangles.size() <= most_triangles[material];
    });
    if (!is_in) continue;
    ++loose;
    for (const std::uint32_t t : triangles) is_loose[t] = 1;
  }
  SplitMesh split{part_of(mesh, is_loose, 1, loose), part_of(mesh, is_loose, 0, pieces.size() - loose)};
  release(mesh.positions, mesh.wedge_position, mesh.wedge_attributes, mesh.triangles, mesh.triangle_material,
          mesh.exact_positions, mesh.exact_on_grid, mesh.exact_triangles);
  return split;
}

}  // namespace meshlode::builder
