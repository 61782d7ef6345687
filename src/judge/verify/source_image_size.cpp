// SPDX-License-Identifier: GPL-3.0-or-later
// stb_image, seen by this file alone in this room: its readers of headers, not of pixels.
#include <limits>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#include <stb_image.h>

#include "judge/verify/texel_budget.h"

namespace meshlode::judge {

std::optional<std::pair<std::uint32_t, std::uint32_t>> stated_image_size(std::span<const std::uint8_t> bytes) {
  int width = 0;
  int height = 0;
  int channels = 0;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels) == 0 ||
      width <= 0 || height <= 0) {
    return stated_container_size(bytes);
  }
  return std::pair{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

}  // namespace meshlode::judge
