// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/converted_images.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/append_format.h"
#include "base/try.h"
#include "draw/textures/image.h"
#include "run/read/limits.h"

namespace meshlode::judge {

namespace {

/// A picture is looked at in so many fields a side, fewer where it has fewer texels: each channel's mean.
constexpr std::size_t kFields = 8;
/// Of 255. Means move by rounding and compression (below 2 for WebP at quality 50) and by turning normals to length 1
/// again. Another picture is further away somewhere.
constexpr double kMostMoved = 24.0;

struct Field {
  std::array<double, 4> levels{}, light{};  ///< means, of 255; of colours by alpha
};

/// Nearly sRGB, of which both pictures are means.
double light_of_level(double level) {
  return std::pow(level / 255.0, 2.2);
}

std::vector<Field> field_means(const draw::DecodedImage& image, std::size_t fields_a_side) {
  std::array<double, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = light_of_level(static_cast<double>(i));
  std::vector<Field> fields(fields_a_side * fields_a_side);
  std::vector<double> counts(fields.size(), 0.0), weights(fields.size(), 0.0);
  for (std::size_t y = 0; y < image.height; ++y) {
    for (std::size_t x = 0; x < image.width; ++x) {
      const std::size_t at = y * fields_a_side / image.height * fields_a_side + x * fields_a_side / image.width;
      const std::uint32_t texel = image.texels[y * image.width + x];
      const double alpha = texel >> 24U, weight = alpha + 1e-3;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t level = texel >> 8U * k & 255U;
        fields[at].levels[k] += weight * level;
        fields[at].light[k] += weight * light[level];
      }
      fields[at].levels[3] += alpha;
      counts[at] += 1.0;
      weights[at] += weight;
    }
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      fields[i].levels[k] /= weights[i];
      fields[i].light[k] = 255.0 * std::pow(fields[i].light[k] / weights[i], 1.0 / 2.2);
    }
    fields[i].light[3] = fields[i].levels[3] /= counts[i];
  }
  return fields;
}

Result<draw::DecodedImage> decode_within_limits(std::span<const std::uint8_t> bytes) {
  TRY_LET(header, draw::read_image_header(bytes));
  const std::uint64_t needed = std::uint64_t{4} * header->width * header->height + header->decoder_bytes;
  if (needed > run::kDefaultMaxDecoded) return Error{ErrorCode::kUnsupported, "image", "too large to be decoded"};
  return draw::decode_image(bytes);
}

}  // namespace

StatedTextures read_stated_textures(std::string_view words) {
  StatedTextures stated;
  constexpr std::string_view kResize = "resize:";
  if (const std::size_t at = words.find(kResize); at != std::string_view::npos) {
    const char* const begin = words.data() + at + kResize.size();
    std::from_chars(begin, words.data() + words.size(), stated.longest_side);
  }
  stated.has_webp = words.find("webp") != std::string_view::npos;
  return stated;
}

std::string find_image_fault(std::span<const std::uint8_t> stored, std::string_view mime_type,
                             const scene::SceneBlob& source, const StatedTextures& stated) {
  const bool is_equal = std::ranges::equal(stored, source.bytes);
  if (is_equal && mime_type == source.mime_type) return {};
  const auto ours = decode_within_limits(stored), theirs = decode_within_limits(source.bytes);
  if (!ours) return "is not the source's, and cannot be decoded: " + ours.error().detail;
  if (!theirs) return "is not the source's, which cannot be decoded: " + theirs.error().detail;
  const bool is_webp = mime_type == "image/webp";
  if (!is_webp && mime_type != source.mime_type) return "has another format than the source and the settings";
  if (is_webp && !stated.has_webp && source.mime_type != "image/webp")
    return "is a WebP, which the settings do not say";
  const std::uint32_t longest = std::max(theirs->width, theirs->height);
  const std::uint32_t wanted = stated.longest_side == 0 ? longest : std::min(longest, stated.longest_side);
  const double ratio = static_cast<double>(wanted) / longest;
  const auto is_near = [&](std::uint32_t side, std::uint32_t of) { return std::abs(side - of * ratio) <= 1.0; };
  if (std::max(ours->width, ours->height) != wanted || !is_near(ours->width, theirs->width) ||
      !is_near(ours->height, theirs->height)) {
    std::string text;
    append_format(text, "has %ux%u texels, and the source's %ux%u become others", ours->width, ours->height,
                  theirs->width, theirs->height);
    return text;
  }
  const std::size_t fields =
      std::min<std::size_t>(kFields, std::min({ours->width, ours->height, theirs->width, theirs->height}));
  const std::vector<Field> a = field_means(*ours, fields), b = field_means(*theirs, fields);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double moved = std::min(std::abs(a[i].levels[k] - b[i].levels[k]), std::abs(a[i].light[k] - b[i].light[k]));
      if (moved > kMostMoved) return "does not show what the source's image shows";
    }
  }
  return {};
}

}  // namespace meshlode::judge
