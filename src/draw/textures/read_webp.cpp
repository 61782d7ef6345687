// SPDX-License-Identifier: GPL-3.0-or-later
// libwebp, seen by this file alone.
#include <webp/decode.h>

#include <string>

#include "base/try.h"
#include "draw/textures/image_readers.h"

namespace meshlode::draw {

namespace {

Error error_of(VP8StatusCode status) {
  switch (status) {
    case VP8_STATUS_OUT_OF_MEMORY: return {ErrorCode::kUnsupported, "image", "WebP: libwebp is out of memory"};
    case VP8_STATUS_UNSUPPORTED_FEATURE: return {ErrorCode::kUnsupported, "image", "WebP: a feature that is not read"};
    case VP8_STATUS_SUSPENDED:
    case VP8_STATUS_NOT_ENOUGH_DATA: return {ErrorCode::kInvalid, "image", "WebP: the file ends early"};
    default: return {ErrorCode::kInvalid, "image", "WebP: damaged"};
  }
}

/// An upper bound of what libwebp keeps beside the texels: of a lossless image all pixels once more with its tables and
/// the transforms' data, of a lossy one rows, and its plane of alpha twice.
std::uint64_t decoder_bytes(const WebPBitstreamFeatures& features) {
  constexpr std::uint64_t kTables = std::uint64_t{4} << 20U;
  constexpr int kLossless = 2;
  const std::uint64_t texels = static_cast<std::uint64_t>(features.width) * static_cast<std::uint64_t>(features.height);
  return kTables + (features.format == kLossless ? 6 * texels : features.has_alpha != 0 ? 3 * texels : texels / 8);
}

}  // namespace

Result<ImageHeader> read_webp(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels) {
  WebPDecoderConfig config;
  if (WebPInitDecoderConfig(&config) == 0) return Error{ErrorCode::kUnsupported, "image", "libwebp gives no reader"};
  const VP8StatusCode found = WebPGetFeatures(bytes.data(), bytes.size(), &config.input);
  if (found != VP8_STATUS_OK) return error_of(found);
  if (config.input.has_animation != 0) return Error{ErrorCode::kUnsupported, "image", "WebP: an animation"};
  ImageHeader header;
  header.width = static_cast<std::uint32_t>(config.input.width);
  header.height = static_cast<std::uint32_t>(config.input.height);
  header.decoder_bytes = decoder_bytes(config.input);
  TRY(check_image_size(header.width, header.height));
  // One colour everywhere takes no bits a texel, so that no ratio follows from the format; this one is generous.
  constexpr std::uint64_t kSmallImage = std::uint64_t{1} << 24U, kMostTexelsOfAByte = 4096;
  const std::size_t count = std::size_t{header.width} * header.height;
  if (count > kSmallImage + kMostTexelsOfAByte * bytes.size()) {
    return Error{ErrorCode::kInvalid, "image", "WebP: too short for its size"};
  }
  if (texels == nullptr) return header;
  texels->resize(count);
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA.rgba = reinterpret_cast<std::uint8_t*>(texels->data());
  config.output.u.RGBA.stride = static_cast<int>(4 * header.width);
  config.output.u.RGBA.size = 4 * count;
  const VP8StatusCode decoded = WebPDecode(bytes.data(), bytes.size(), &config);
  WebPFreeDecBuffer(&config.output);
  if (decoded != VP8_STATUS_OK) return error_of(decoded);
  return header;
}

}  // namespace meshlode::draw
