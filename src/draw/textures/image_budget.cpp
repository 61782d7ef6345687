// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/image_budget.h"

#include "base/byte_size.h"

namespace meshlode::draw {

std::string ImageBudget::refusal(std::string_view image, const ImageHeader& header, std::uint64_t bytes) const {
  return std::string(image) + ": " + std::to_string(header.width) + " x " + std::to_string(header.height) +
         " texels take " + byte_size_text(bytes) + " decoded, " + byte_size_text(left()) + " of --max-decoded " +
         byte_size_text(limit_) + " are left";
}

std::string image_name(const run::Asset& asset, std::uint32_t blob) {
  const std::string_view name = asset.string(asset.blobs()[blob].name);
  return name.empty() ? "image " + std::to_string(blob) : "image '" + std::string(name) + "'";
}

}  // namespace meshlode::draw
