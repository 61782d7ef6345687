// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of an aggregate's pieces and of what stands for them: which samples of a lattice they cover in a view, and
// what one changes, by pixel size.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/pieces.h"
#include "builder/aggregate/sample_mask.h"
#include "builder/aggregate/views.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// What pieces cover, triangle by triangle, and where they are.
class SourceSurface {
 public:
  /// Everything must outlive this.
  SourceSurface(const PreparedMesh& mesh, std::span<const SourceMaterial> materials,
                std::span<const std::uint8_t> is_closed)
      : mesh_(mesh), materials_(materials), is_closed_(is_closed) {}
  [[nodiscard]] Corners corners(std::uint32_t triangle) const { return corners_of(mesh_, triangle); }
  [[nodiscard]] const SourceMaterial& material(std::uint32_t triangle) const {
    return materials_[mesh_.triangle_material[triangle]];
  }
  [[nodiscard]] std::array<Vec2d, 3> uvs(std::uint32_t triangle) const {
    return corner_uvs(mesh_, triangle, material(triangle));
  }
  /// Whether its piece is closed, and not masked.
  [[nodiscard]] bool is_closed(std::uint32_t triangle) const { return is_closed_[triangle] != 0; }

 private:
  const PreparedMesh& mesh_;
  std::span<const SourceMaterial> materials_;
  std::span<const std::uint8_t> is_closed_;
};

/// A ball around the mesh, and how finely it may be looked at.
struct MeshFrame {
  Vec3d center{0.0};
  double radius = 0.0;
  double longest = 0.0;  ///< side of its box
};

// Pixels are 12 and 8 samples wide, in blocks of 2 × 2, and twice, four times … as wide in blocks that are. From one
// size to the next they fall by a third or a quarter, and a pixel has at least 64 samples.
inline constexpr std::array<std::size_t, 2> kPixelBlocks{6, 4};

/// From large to small pixels: `octaves` times two sizes.
using Squares = std::vector<std::int64_t>;
/// The pixel size of an element of these at a spacing.
[[nodiscard]] double pixel_size(double spacing, std::size_t octaves, std::size_t index);

[[nodiscard]] SampleMask source_mask(const SourceSurface& source, const Lattice& lattice, const View& view,
                                     std::span<const std::uint32_t> triangles);
[[nodiscard]] SampleMask mask_of(const Lattice& lattice, const View& view, std::span<const Corners> triangles);

/// Which samples at least one group of a level covers, and which at least two.
struct CoverCount {
  SampleMask once, twice;
};

[[nodiscard]] CoverCount cover_of(std::span<const SampleMask> groups);

/// What one proposal changes.
struct Change {
  Squares squares;                     ///< for each pixel size
  std::int64_t before = 0, after = 0;  ///< samples that nothing else covers
};

/// `before`: the group's own samples; `cover`: of all groups before. `halvings`: the smallest pixels are so many
/// octaves above kPixelBlocks.
[[nodiscard]] Change change_of(const SampleMask& before, const SampleMask& after, const CoverCount& cover,
                               std::size_t octaves, unsigned halvings = 0);
[[nodiscard]] Squares squares_of_all(const SampleMask& all, std::size_t octaves, unsigned halvings = 0);

/// What the leaves cover in one view, at one spacing after the other.
using LeafMasks = std::vector<std::vector<SampleMask>>;

/// For the spacings of `first_step` to that of `finest`, which is the last one: the source is drawn once, and what it
/// covers of the coarser lattices are samples of the finest.
[[nodiscard]] LeafMasks draw_leaves(const SourceSurface& source, const ByPiece& leaf_triangles, const Lattice& finest,
                                    const View& view, std::size_t first_step, std::size_t steps);

}  // namespace meshlode::builder
