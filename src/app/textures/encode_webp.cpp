// SPDX-License-Identifier: GPL-3.0-or-later
// libwebp, seen by this file alone in this room.
#include <webp/encode.h>

#include "app/textures/encode.h"

namespace meshlode::app {

namespace {

/// Time against bytes, as `cwebp -z`: of FlightHelmet's maps 9 takes ten times as long as 3 for 2% fewer bytes.
constexpr int kLosslessLevel = 3;

void swap_red_and_blue(std::vector<std::uint32_t>& texels) {
  for (std::uint32_t& t : texels) t = (t & 0xFF00FF00U) | (t & 255U) << 16U | (t >> 16U & 255U);
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_webp_file(draw::DecodedImage& image, std::uint32_t quality) {
  const auto failed = [] { return Error{ErrorCode::kBuildFailed, "image", "libwebp cannot encode it"}; };
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0) return failed();
  if (quality == 0 && WebPConfigLosslessPreset(&config, kLosslessLevel) == 0) return failed();
  if (quality != 0) config.quality = static_cast<float>(quality);
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  // In place: libwebp's own copy would be 4 bytes a texel more. With `exact` it changes none of them.
  swap_red_and_blue(image.texels);
  picture.argb = image.texels.data();
  picture.argb_stride = picture.width;
  const bool done = WebPEncode(&config, &picture) != 0;
  swap_red_and_blue(image.texels);
  std::vector<std::uint8_t> bytes(writer.mem, writer.mem + writer.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!done) return failed();
  return bytes;
}

}  // namespace meshlode::app
