// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/textures/convert_images.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "app/textures/encode.h"
#include "app/textures/shrink.h"
#include "base/append_format.h"
#include "base/byte_size.h"
#include "base/gltf_textures.h"
#include "base/parallel.h"
#include "base/try.h"
#include "draw/textures/image.h"
#include "run/read/json_text.h"

namespace meshlode::app {

namespace {

/// Of a JPEG that stays one, as other programs save them when they are asked for high quality.
constexpr int kJpegQuality = 90;

/// Colours with so few texels a side are swatches, whose neighbours have nothing in common: WebP has half as many
/// samples of chroma as texels, and 8x8 swatches were off by 205 of 255.
constexpr std::uint32_t kMostSwatchSide = 32;

enum class FileKind : std::uint8_t { kPng, kJpeg, kWebp };
constexpr std::array<const char*, 3> kMimeTypes{"image/png", "image/jpeg", "image/webp"};
constexpr std::array<const char*, 3> kNames{"PNG", "JPEG", "WebP"};

/// Of bytes that are decoded: \pre read_image_header() takes them
FileKind kind_of(std::span<const std::uint8_t> bytes) {
  return bytes[0] == 0xFF ? FileKind::kJpeg : bytes[0] == 'R' ? FileKind::kWebp : FileKind::kPng;
}

/// What samples an image: bits.
constexpr unsigned kColorUse = 1, kAlphaUse = 2, kNormalUse = 4, kDataUse = 8;

/// Alpha is read from a base colour, where the material is not opaque (glTF 2.0, 3.9.4).
unsigned use_of(scene::TextureRole role, scene::AlphaMode mode) {
  switch (role) {
    case scene::TextureRole::kBaseColor: return mode == scene::AlphaMode::kOpaque ? kColorUse : kColorUse | kAlphaUse;
    case scene::TextureRole::kEmissive: return kColorUse;
    case scene::TextureRole::kNormal: return kNormalUse;
    default: return kDataUse;
  }
}

/// An image that is both a colour and something else is a colour.
TexelKind kind_of_uses(unsigned uses) {
  if ((uses & kColorUse) != 0) return (uses & kAlphaUse) != 0 ? TexelKind::kColor : TexelKind::kOpaqueColor;
  return uses == kNormalUse ? TexelKind::kNormal : TexelKind::kData;
}

/// By what samples each blob, through whichever image of a texture: a WebP has the role of the PNG that stands in its
/// place for those who do not read it.
std::vector<TexelKind> texel_kinds(const scene::Scene& scene) {
  std::vector<unsigned> blobs(scene.blobs.size(), 0);
  std::map<std::uint64_t, unsigned> textures, images;
  for (const scene::SceneMaterial& material : scene.materials) {
    for (const scene::TextureUse& use : material.textures) {
      const unsigned bits = use_of(use.role, material.alpha_mode);
      if (use.blob < blobs.size()) blobs[use.blob] |= bits;
      textures[use.texture] |= bits;
    }
  }
  const run::JsonText document(scene.document);
  std::uint64_t index = 0;
  document.find("textures").for_each([&](std::string_view, const run::JsonText& texture) {
    const auto uses = textures.find(index++);
    if (uses == textures.end()) return;
    for_each_image_of_texture(texture, [&](std::uint64_t image) { images[image] |= uses->second; });
  });
  index = 0;
  document.find("images").for_each([&](std::string_view, const run::JsonText& image) {
    const auto uses = images.find(index++);
    const auto blob = image.find("blob").index();
    if (uses != images.end() && blob && *blob < blobs.size()) blobs[*blob] |= uses->second;
  });
  std::vector<TexelKind> kinds;
  kinds.reserve(blobs.size());
  for (const unsigned uses : blobs) kinds.push_back(kind_of_uses(uses));
  return kinds;
}

/// What is to be done with one image, from its head alone.
struct ImageTask {
  std::size_t blob = 0;
  FileKind kind{};
  std::uint32_t width = 0, height = 0;  ///< afterwards
  TexelKind texels{};
  bool is_smaller = false;
  bool may_be_webp = false;
  std::uint64_t bytes = 0;  ///< that the work takes

  [[nodiscard]] bool is_swatch() const { return std::min(width, height) <= kMostSwatchSide; }
  [[nodiscard]] bool may_be_lossy() const { return is_color(texels) && !is_swatch(); }
};

struct EncodedImage {
  std::vector<std::uint8_t> bytes;
  FileKind kind{};
};

/// The smallest of what the choice allows. `source_bytes`: of the image before.
Result<EncodedImage> encode_smallest(draw::DecodedImage& image, const ImageTask& task,
                                     const builder::TextureChoice& choice, std::size_t source_bytes) {
  EncodedImage best;
  const auto take = [&](std::vector<std::uint8_t> bytes, FileKind kind) {
    if (best.bytes.empty() || bytes.size() < best.bytes.size()) best = {std::move(bytes), kind};
  };
  // Flat colours and drawings take fewer bytes without loss. What was lossy before does not.
  if (task.may_be_webp && (!task.may_be_lossy() || task.kind == FileKind::kPng)) {
    TRY_LET(webp, encode_webp_file(image, 0));
    take(std::move(*webp), FileKind::kWebp);
  }
  if (task.may_be_webp && task.may_be_lossy()) {
    const std::uint32_t quality = choice.webp_quality != 0 ? choice.webp_quality : builder::kUsualWebpQuality;
    TRY_LET(webp, encode_webp_file(image, quality));
    take(std::move(*webp), FileKind::kWebp);
  }
  // Of what was lossy before, lossless data is no smaller: it may stay what it was.
  if (task.is_smaller && task.kind == FileKind::kJpeg && (!task.may_be_webp || !task.may_be_lossy())) {
    TRY_LET(jpeg, encode_jpeg_file(image, kJpegQuality));
    take(std::move(*jpeg), FileKind::kJpeg);
  }
  if (task.kind == FileKind::kPng && !task.may_be_webp) {
    TRY_LET(png, encode_png_file(image));
    take(std::move(*png), FileKind::kPng);
  }
  // A source of low quality: about there fewer texels take fewer bytes, and what is lost was lost before. A swatch has
  // colours to keep, and what takes more bytes at any quality loses nothing for it.
  const EncodedImage usual = best;
  for (int quality = kJpegQuality - 10; task.is_smaller && quality > 0 && best.bytes.size() >= source_bytes;
       quality -= 10) {
    if (task.kind == FileKind::kJpeg && !task.is_swatch()) {
      TRY_LET(jpeg, encode_jpeg_file(image, quality));
      take(std::move(*jpeg), FileKind::kJpeg);
    } else if (task.kind == FileKind::kWebp && task.may_be_lossy() && choice.webp_quality == 0) {
      TRY_LET(webp, encode_webp_file(image, static_cast<std::uint32_t>(quality)));
      take(std::move(*webp), FileKind::kWebp);
    } else {
      break;
    }
  }
  if (best.bytes.size() >= source_bytes) best = usual;
  return best;
}

std::string describe_image(FileKind kind, std::uint32_t width, std::uint32_t height, std::uint64_t bytes) {
  std::string text;
  append_format(text, "%s of %ux%u, %s", kNames[static_cast<std::size_t>(kind)], width, height,
                byte_size_text(bytes).c_str());
  return text;
}

Result<builder::ConvertedImage> convert_one(const scene::SceneBlob& blob, const ImageTask& task,
                                            const builder::TextureChoice& choice) {
  builder::ConvertedImage out;
  Result<draw::DecodedImage> decoded = draw::decode_image(blob.bytes);
  if (!decoded) {
    out.note = "stays as it is: " + decoded.error().detail;
    return out;
  }
  const std::string before = describe_image(task.kind, decoded->width, decoded->height, blob.bytes.size());
  if (task.is_smaller) *decoded = shrink(*decoded, task.width, task.height, task.texels);
  TRY_LET(best, encode_smallest(*decoded, task, choice, blob.bytes.size()));
  if (!task.is_smaller && best->bytes.size() >= blob.bytes.size()) {
    out.note = "stays as it is: " + before + ", and WebP would not be smaller";
    return out;
  }
  out.note = before + ", is stored as " + describe_image(best->kind, task.width, task.height, best->bytes.size());
  constexpr std::size_t kBitDepth = 24;  // of a PNG's IHDR, which comes first
  if (task.kind == FileKind::kPng && blob.bytes[kBitDepth] == 16) out.note += ", with 8 bits a channel instead of 16";
  if (best->bytes.size() > blob.bytes.size()) out.note += ", which is more bytes for fewer texels";
  out.bytes = std::move(best->bytes);
  out.mime_type = kMimeTypes[static_cast<std::size_t>(best->kind)];
  return out;
}

}  // namespace

Result<std::vector<builder::ConvertedImage>> ImageConverter::convert(const scene::Scene& scene,
                                                                     const builder::TextureChoice& choice) const {
  const std::vector<TexelKind> kinds = texel_kinds(scene);
  std::vector<builder::ConvertedImage> out(scene.blobs.size());
  std::vector<ImageTask> tasks;
  std::uint64_t largest = 1;
  for (std::size_t i = 0; i < scene.blobs.size(); ++i) {
    const scene::SceneBlob& blob = scene.blobs[i];
    if (blob.kind != scene::SceneBlob::Kind::kImage) continue;
    const auto header = draw::read_image_header(blob.bytes);
    if (!header) {
      out[i].note = "stays as it is: " + header.error().detail;
      continue;
    }
    ImageTask task{i, kind_of(blob.bytes), 0, 0, kinds[i], false, choice.webp_quality != 0, 0};
    std::tie(task.width, task.height) = fit_size(header->width, header->height, choice.longest_side);
    task.is_smaller = task.width != header->width || task.height != header->height;
    if (!task.is_smaller && (!task.may_be_webp || task.kind == FileKind::kWebp)) continue;
    task.may_be_webp = task.may_be_webp || task.kind == FileKind::kWebp;
    if (choice.webp_quality != 0 && std::max(task.width, task.height) > kMostWebpSide) {
      out[i].note = "stays as it is: WebP has at most 16383 texels a side";
      continue;
    }
    // The texels, what decodes them, and what encodes them: libwebp's planes and hashes. Its lossless encoder, which
    // alpha goes through too, took 28 bytes a texel beside the texels (4096x4096 of noise).
    const bool is_lossless = task.may_be_webp && (task.kind != FileKind::kJpeg || !task.may_be_lossy());
    const std::uint64_t texels = std::uint64_t{4} * header->width * header->height;
    const std::uint64_t encoder_bytes = std::uint64_t{is_lossless ? 28U : 16U} * task.width * task.height;
    task.bytes = texels + std::max(header->decoder_bytes, encoder_bytes);
    if (task.bytes > max_decoded_) {
      out[i].note = "stays as it is: to convert it takes " + byte_size_text(task.bytes) +
                    ", and --max-decoded allows " + byte_size_text(max_decoded_);
      continue;
    }
    largest = std::max(largest, task.bytes);
    tasks.push_back(task);
  }
  std::vector<std::optional<Error>> errors(tasks.size());
  const std::size_t at_once = std::max<std::size_t>(1, std::min<std::uint64_t>(thread_limit(), max_decoded_ / largest));
  parallel_for_each_in_order(tasks.size(), at_once, [&](std::size_t i) {
    const std::size_t blob = tasks[i].blob;
    auto converted = convert_one(scene.blobs[blob], tasks[i], choice);
    if (converted) {
      out[blob] = std::move(*converted);
    } else {
      errors[i] = converted.error();
      errors[i]->where = "image " + std::to_string(scene.blobs[blob].source_index);
    }
  });
  for (std::optional<Error>& error : errors) {
    if (error) return std::move(*error);
  }
  return out;
}

}  // namespace meshlode::app
