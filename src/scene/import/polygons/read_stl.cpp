// SPDX-License-Identifier: GPL-3.0-or-later
// STL, text and binary: facets of three positions each, welded where these are equal.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>

#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

using Facet = std::array<float, 9>;
using Point = std::array<float, 3>;

Error invalid(std::string where, std::string detail) {
  return {ErrorCode::kInvalid, std::move(where), std::move(detail)};
}

std::uint32_t load_u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

/// Many binary files begin with "solid" too: the size decides where it can, and the word facet where not.
bool is_binary(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (bytes.size() >= 84 && 84 + std::uint64_t{50} * load_u32(bytes, 80) == bytes.size()) return true;
  const std::string_view head = text.substr(0, 2048);
  return !text.starts_with("solid") ||
         (head.find("facet") == std::string_view::npos && head.find("endsolid") == std::string_view::npos &&
          head.find('\0') != std::string_view::npos);
}

class StlReader {
 public:
  explicit StlReader(const ImportOptions& options) : options_(options) {}

  Status read_binary(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < 84) return invalid("header", "cut short");
    const std::uint64_t count = load_u32(bytes, 80);
    if (count > (bytes.size() - 84) / 50) {
      return invalid("header", "it says " + std::to_string(count) + " triangles, the file has bytes for " +
                                   std::to_string((bytes.size() - 84) / 50));
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      Facet facet;
      std::memcpy(facet.data(), bytes.data() + 84 + 50 * i + 12, sizeof(facet));
      if (auto status = add(facet); !status) return status;
    }
    return Ok{};
  }

  Status read_text(std::string_view text) {
    Facet facet{};
    std::size_t corner_count = 0;
    while (true) {
      std::string word(take_word(text).substr(0, 16));
      if (word.empty()) break;
      std::transform(word.begin(), word.end(), word.begin(),
                     [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
      if (word == "solid" || word == "endsolid") {
        take_line(text);  // a name may be anything, "vertex" too
      } else if (word == "vertex") {
        if (corner_count == 3) return invalid(place(), "more than three corners");
        for (std::size_t c = 0; c < 3; ++c) {
          const auto number = parse_number(take_word(text));
          if (!number) return invalid(place(), "a coordinate is missing or not a number");
          facet[3 * corner_count + c] = static_cast<float>(*number);
        }
        ++corner_count;
      } else if (word == "endloop") {
        if (corner_count != 3) return invalid(place(), "fewer than three corners");
        if (auto status = add(facet); !status) return status;
        corner_count = 0;
      }
    }
    if (corner_count != 0) return invalid(place(), "cut short");
    return Ok{};
  }

  PolygonFile finish() {
    out_.drops.repaired = repaired_;
    if (points_ != 0) {
      out_.left_out.push_back({std::to_string(points_) + " triangles", "two of their corners are the same point"});
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string place() const { return "facet " + std::to_string(seen_); }

  Status add(const Facet& facet) {
    const bool is_finite = std::all_of(facet.begin(), facet.end(), [](float f) { return std::isfinite(f); });
    const auto same = [&](std::size_t a, std::size_t b) {
      return std::equal(facet.begin() + static_cast<std::ptrdiff_t>(3 * a),
                        facet.begin() + static_cast<std::ptrdiff_t>(3 * a + 3),
                        facet.begin() + static_cast<std::ptrdiff_t>(3 * b));
    };
    if (!is_finite && !options_.repair) return invalid(place(), "a position is not finite");
    ++seen_;
    if (!is_finite) {
      ++repaired_;
    } else if (same(0, 1) || same(1, 2) || same(0, 2)) {
      ++points_;
    } else {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        out_.soup.corners.push_back(weld({facet[3 * corner], facet[3 * corner + 1], facet[3 * corner + 2]}));
      }
      out_.soup.polygon_sizes.push_back(3);
    }
    return Ok{};
  }

  /// The vertex at a finite position; 0 and -0 are the same place.
  std::uint32_t weld(const Point& point) {
    const auto next = static_cast<std::uint32_t>(out_.soup.positions.size());
    const auto [known, is_new] = vertex_at_.try_emplace(point, next);
    if (is_new) out_.soup.positions.emplace_back(point[0], point[1], point[2]);
    return known->second;
  }

  const ImportOptions& options_;
  std::map<Point, std::uint32_t> vertex_at_;
  std::uint64_t seen_ = 0, repaired_ = 0, points_ = 0;
  PolygonFile out_;
};

}  // namespace

Result<PolygonFile> read_stl(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  StlReader reader(options);
  const Status status = is_binary(bytes)
                            ? reader.read_binary(bytes)
                            : reader.read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!status) return status.error();
  return reader.finish();
}

}  // namespace meshlode::scene
