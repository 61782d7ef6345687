// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/image_mime.h"

#include <algorithm>
#include <initializer_list>

namespace meshlode::scene {

std::string_view sniff_image_mime(std::span<const std::uint8_t> bytes) {
  const auto starts = [&](std::initializer_list<int> magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(), [](int a, std::uint8_t b) { return a == b; });
  };
  if (starts({0x89, 'P', 'N', 'G'})) return "image/png";
  if (starts({0xFF, 0xD8, 0xFF})) return "image/jpeg";
  if (starts({0xAB, 'K', 'T', 'X'})) return "image/ktx2";
  if (starts({'R', 'I', 'F', 'F'})) return "image/webp";
  if (starts({'D', 'D', 'S', ' '})) return "image/vnd-ms.dds";
  return "";
}

}  // namespace meshlode::scene
