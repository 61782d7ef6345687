// SPDX-License-Identifier: GPL-3.0-or-later
// What all decoded images of a scene may take together. A PNG of ten kilobytes may hold 16384 × 16384 texels.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "draw/textures/image.h"
#include "run/read/asset.h"
#include "run/read/limits.h"

namespace meshlode::draw {

class ImageBudget {
 public:
  explicit ImageBudget(std::uint64_t limit_bytes = run::kDefaultMaxDecoded) : limit_(limit_bytes) {}

  [[nodiscard]] std::uint64_t limit() const { return limit_; }
  [[nodiscard]] std::uint64_t left() const { return limit_ - taken_; }
  /// False, and nothing taken, where less is left.
  [[nodiscard]] bool take(std::uint64_t bytes) {
    if (bytes > left()) return false;
    taken_ += bytes;
    return true;
  }
  /// \pre that much was taken
  void give_back(std::uint64_t bytes) { taken_ -= bytes; }

  /// Why an image is not decoded: "texture.png: 16384 x 16384 texels take 1.4GiB decoded, 512MiB of --max-decoded
  /// 512MiB are left".
  [[nodiscard]] std::string refusal(std::string_view image, const ImageHeader& header, std::uint64_t bytes) const;

 private:
  std::uint64_t limit_, taken_ = 0;
};

/// "image 'texture.png'", or "image 3" by its number among the blobs where it has no name.
[[nodiscard]] std::string image_name(const run::Asset& asset, std::uint32_t blob);

/// Opening an asset does not look at the bytes of its blobs. Error: kInvalid, where they are not those that were
/// written.
[[nodiscard]] Status check_image(const run::Asset& asset, std::uint32_t blob);

}  // namespace meshlode::draw
