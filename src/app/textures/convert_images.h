// SPDX-License-Identifier: GPL-3.0-or-later
// `build --textures`: images with fewer texels, and in fewer bytes.
//
//   decode (draw/textures) → shrink, by what the texels mean (shrink.h) → encode, and the smallest stays
//
// Colours are what a base colour or emission is read from: lossy as WebP and JPEG, unless they are small or flat. All
// else keeps each channel of each texel: as WebP without loss, for its chroma has half the samples.
#pragma once

#include <cstdint>

#include "builder/textures/image_converter.h"

namespace meshlode::app {

class ImageConverter : public builder::ImageConverter {
 public:
  /// `max_decoded`: bytes that images may take decoded, those that are converted side by side together.
  explicit ImageConverter(std::uint64_t max_decoded) : max_decoded_(max_decoded) {}
  /// An image that cannot be decoded, or takes more memory, stays, and its note says why. Threads: those of the
  /// caller's arena.
  [[nodiscard]] Result<std::vector<builder::ConvertedImage>> convert(
      const scene::Scene& scene, const builder::TextureChoice& choice) const override;

 private:
  std::uint64_t max_decoded_;
};

}  // namespace meshlode::app
