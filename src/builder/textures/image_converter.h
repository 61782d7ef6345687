// SPDX-License-Identifier: GPL-3.0-or-later
// Other bytes for the images that a scene carries, from whoever asks for a build: the build itself decodes no image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/textures/texture_choice.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Of one blob of the scene.
struct ConvertedImage {
  std::vector<std::uint8_t> bytes;  ///< empty: the source's stay
  std::string mime_type;            ///< of `bytes`
  std::string note;                 ///< what became of it, or why it stays; empty: there was nothing to do
};

class ImageConverter {
 public:
  virtual ~ImageConverter() = default;
  /// One for each of the scene's blobs. The same for any number of threads. Error: kBuildFailed
  /// for an image that cannot be encoded.
  [[nodiscard]] virtual Result<std::vector<ConvertedImage>> convert(const scene::Scene& scene,
                                                                    const TextureChoice& choice) const = 0;
};

}  // namespace meshlode::builder
