// SPDX-License-Identifier: GPL-3.0-or-later
// FLIP: how different two pictures look to somebody who flips between them. LDR-FLIP as published: Andersson, Nilsson,
// Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020.
//
//   colours → opponent space → blurred as the eye does at this distance → L*a*b* with the Hunt effect
//           → HyAB distance, compressed to 0 … 1
//   luminance → edges and points at the scale that the eye sees → how much they differ, 0 … 1
//   both → colour difference to the power of (1 - feature difference)
//
// In doubles throughout; constants are the paper's, matrices come from the primaries of sRGB.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshlode::lab {

/// The paper's observer: a screen 0.7 m wide with 3,840 pixels, seen from 0.7 m.
constexpr double kPublishedPixelsPerDegree = 67.0206432;  // 0.7 · (3840 / 0.7) · π / 180

struct FlipOptions {
  double pixels_per_degree = kPublishedPixelsPerDegree;
};

struct FlipPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<double> difference;  ///< 0 (the same) to 1, top row first
};

/// A picture that others are held against, one after another: what is made of it is made once. 4 bytes a pixel, sRGB,
/// the fourth of which is not looked at. Pixels beyond the edge are those of the edge.
class FlipReference {
 public:
  /// \pre `rgba` has width · height pixels; pixels_per_degree is above 0
  FlipReference(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                const FlipOptions& options = {});
  ~FlipReference();
  FlipReference(FlipReference&&) noexcept;

  /// \pre `test` has as many pixels
  [[nodiscard]] FlipPicture compare(std::span<const std::uint8_t> test) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The same for one pair. \pre both have width · height pixels
[[nodiscard]] FlipPicture flip(std::span<const std::uint8_t> reference, std::span<const std::uint8_t> test,
                               std::uint32_t width, std::uint32_t height, const FlipOptions& options = {});

/// What the paper pools a picture into.
struct FlipPool {
  double mean = 0.0;
  /// Half of the whole difference lies in pixels that differ by no more than this; 0 where there is none.
  double weighted_median = 0.0;
  double max = 0.0;
};
[[nodiscard]] FlipPool pool(const FlipPicture& picture);

/// Dark where the pictures agree, light where they differ: 4 bytes a pixel. Lightness rises all the way, so that it can
/// be read without telling colours apart.
[[nodiscard]] std::vector<std::uint8_t> heat_map(const FlipPicture& picture);

}  // namespace meshlode::lab
