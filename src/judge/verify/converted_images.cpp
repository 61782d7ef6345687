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
#include "scene/import/image_mime.h"

namespace meshlode::judge {

namespace {

/// A picture is looked at in so many fields a side, of at least so many texels a side where it has them: what lossy
/// compression does to single texels is no other picture. Noise in all channels as WebP of quality 1 moves the mean of
/// a field of 8x8 texels by 22 (of 4x4 by 60). Pictures up to kMostSmallSide are no such WebP.
constexpr std::uint32_t kFields = 8, kLeastFieldSide = 8, kLeastFieldSideOfSmall = 4, kMostSmallSide = 32;
/// Of 255, of a field's mean. Means move by rounding and by lossy compression. Another picture is further away
/// somewhere.
constexpr double kMostMoved = 24.0;

/// How texels become fewer. Which of them is right depends on what samples the image: one must fit the whole picture.
enum class Reading : std::uint8_t { kLevels, kLight, kLightByAlpha, kDirections };
constexpr std::array kReadings{Reading::kLevels, Reading::kLight, Reading::kLightByAlpha, Reading::kDirections};

/// IEC 61966-2-1.
double light_of_level(double level) {
  const double c = level / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double level_of_light(double light) {
  return 255.0 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055);
}

using Levels = std::array<double, 4>;  ///< red, green, blue, alpha, of 255

struct Sum {
  std::array<double, 3> colors{};  ///< times weight
  double weight = 0.0, alpha = 0.0;
};

Levels levels_of(const Sum& sum, double area, Reading reading) {
  Levels out{sum.colors[0] / sum.weight, sum.colors[1] / sum.weight, sum.colors[2] / sum.weight, sum.alpha / area};
  if (reading == Reading::kLight || reading == Reading::kLightByAlpha) {
    for (std::size_t k = 0; k < 3; ++k) out[k] = level_of_light(out[k]);
  } else if (reading == Reading::kDirections) {
    const double half = 127.5, length = std::hypot(out[0] - half, out[1] - half, out[2] - half);
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = length > 1.0 ? (out[k] - half) / length : k == 2 ? 1.0 : 0.0;  // none: the surface's own
      out[k] = half + half * along;
    }
  }
  return out;
}

/// Pictures as means of the areas that their texels cover in another.
class Averages {
 public:
  explicit Averages(const draw::DecodedImage& image, Reading reading) : image_(image), reading_(reading) {
    const bool is_light = reading == Reading::kLight || reading == Reading::kLightByAlpha;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const auto level = static_cast<double>(i);
      values_[i] = is_light ? light_of_level(level) : level;
    }
  }

  /// Row y of `width` x `height` texels.
  [[nodiscard]] std::vector<Levels> row(std::uint64_t y, std::uint64_t width, std::uint64_t height) const {
    std::vector<Sum> sums(width);
    const std::uint64_t begin = y * image_.height, end = begin + image_.height;  // in parts of a row: 1 / height
    for (std::uint64_t from = begin / height; from * height < end; ++from) {
      add_row(from, std::min((from + 1) * height, end) - std::max(from * height, begin), sums);
    }
    std::vector<Levels> out;
    const double area = static_cast<double>(image_.width) * image_.height;
    for (const Sum& sum : sums) out.push_back(levels_of(sum, area, reading_));
    return out;
  }

 private:
  void add_row(std::uint64_t y, std::uint64_t share, std::vector<Sum>& sums) const {
    const std::uint64_t width = sums.size();
    for (std::uint64_t x = 0; x < image_.width; ++x) {
      const std::uint32_t texel = image_.texels[y * image_.width + x];
      const double alpha = texel >> 24U;
      const double own_weight = reading_ == Reading::kLightByAlpha ? alpha + 1e-3 : 1.0;  // of nothing opaque the mean
      const std::uint64_t begin = x * width, end = begin + width;
      for (std::uint64_t to = begin / image_.width; to * image_.width < end; ++to) {
        const std::uint64_t part = std::min((to + 1) * image_.width, end) - std::max(to * image_.width, begin);
        const double area = static_cast<double>(share * part), weight = area * own_weight;
        for (std::size_t k = 0; k < 3; ++k) sums[to].colors[k] += weight * values_[texel >> 8U * k & 255U];
        sums[to].weight += weight;
        sums[to].alpha += area * alpha;
      }
    }
  }

  const draw::DecodedImage& image_;
  Reading reading_;
  std::array<double, 256> values_{};
};

/// Whether no field's mean is elsewhere than that of the source with as many texels.
bool shows_the_same(const draw::DecodedImage& stored, const draw::DecodedImage& source, Reading reading) {
  const bool is_small = std::min(stored.width, stored.height) <= kMostSmallSide;
  const std::uint32_t least = is_small ? kLeastFieldSideOfSmall : kLeastFieldSide;
  const auto fields_of = [&](std::uint32_t side) { return std::clamp(side / least, 1U, kFields); };
  const std::size_t columns = fields_of(stored.width), rows = fields_of(stored.height);
  std::vector<Levels> moved(columns * rows);
  std::vector<double> counts(moved.size(), 0.0);
  const Averages averages(source, reading);
  for (std::size_t y = 0; y < stored.height; ++y) {
    const std::vector<Levels> expected = averages.row(y, stored.width, stored.height);
    for (std::size_t x = 0; x < stored.width; ++x) {
      const std::size_t at = y * rows / stored.height * columns + x * columns / stored.width;
      const std::uint32_t texel = stored.texels[y * stored.width + x];
      for (std::size_t k = 0; k < 4; ++k) moved[at][k] += (texel >> 8U * k & 255U) - expected[x][k];
      counts[at] += 1.0;
    }
  }
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (const double sum : moved[i]) {
      if (!(std::abs(sum) <= kMostMoved * counts[i])) return false;
    }
  }
  return true;
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
  if (std::ranges::equal(stored, source.bytes)) {
    return mime_type == source.mime_type ? "" : "has another MIME type than the source's";
  }
  // A source may call its bytes what they are not: what is stored instead is named after what it is.
  const std::string_view type = scene::sniff_image_mime(source.bytes);
  if (mime_type != scene::sniff_image_mime(stored)) return "has bytes of another format than its MIME type";
  const auto ours = decode_within_limits(stored), theirs = decode_within_limits(source.bytes);
  if (!ours) return "is not the source's, and cannot be decoded: " + ours.error().detail;
  if (!theirs) return "is not the source's, which cannot be decoded: " + theirs.error().detail;
  const bool is_webp = mime_type == "image/webp";
  if (!is_webp && mime_type != type) return "has another format than the source and the settings";
  if (is_webp && !stated.has_webp && type != "image/webp") return "is a WebP, which the settings do not say";
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
  const bool has_fewer = ours->width != theirs->width || ours->height != theirs->height;
  for (const Reading reading : std::span(kReadings).first(has_fewer ? kReadings.size() : 1)) {
    if (shows_the_same(*ours, *theirs, reading)) return {};
  }
  return "does not show what the source's image shows";
}

}  // namespace meshlode::judge
