// SPDX-License-Identifier: GPL-3.0-or-later
// STL, text and binary: facets of three positions each, welded where these are equal.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "base/try.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/stl_colors.h"
#include "scene/import/polygons/text_scan.h"
#include "scene/import/polygons/wedges.h"

namespace meshlode::scene {

namespace {

constexpr std::size_t kHead = 84, kFacet = 50;  // bytes

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

bool is_keyword(std::string_view word) {
  constexpr std::string_view kKeywords[] = {"solid",   "facet",    "normal",   "outer", "loop",  "vertex",
                                            "endloop", "endfacet", "endsolid", "end",   "color", "colour"};
  return std::any_of(std::begin(kKeywords), std::end(kKeywords),
                     [&](std::string_view known) { return is_word(word, known); });
}

/// Many binary files begin with "solid" too, so that the size decides where it can; where not, what follows the line.
bool is_binary(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= kHead && kHead + std::uint64_t{kFacet} * load_u32(bytes, 80) == bytes.size()) return true;
  std::string_view text = text_of(bytes);
  const bool has_controls = !looks_like_text(text);
  const std::string_view first = take_word(text);
  if (!is_word(first, "solid")) return has_controls || !is_keyword(first);
  take_line(text);
  const std::string_view next = take_word(text);
  return has_controls && !is_keyword(next);
}

/// The rest of a solid's line is its name, unless the facets follow on the same line.
void skip_name(std::string_view& text) {
  while (!text.empty()) {
    if (text.front() == '\n' || text.front() == '\r') return;
    if (is_blank(text.front())) {
      text.remove_prefix(1);
      continue;
    }
    std::string_view rest = text;
    const std::string_view word = take_word(rest);
    std::string_view after = rest;
    if (is_word(word, "facet") && is_word(take_word(after), "normal")) return;
    text = rest;
  }
}

class StlReader {
 public:
  explicit StlReader(const ImportOptions& options) : options_(options) {}

  Status read_binary(std::span<const std::uint8_t> bytes);
  Status read_text(std::string_view text);
  PolygonFile finish();

 private:
  [[nodiscard]] std::string place() const { return "facet " + std::to_string(seen_); }
  Status take_vertex(std::string_view& text);
  Status add(const Facet& facet, const std::optional<Vec4f>& color = std::nullopt);
  std::uint32_t weld(const Point& point);
  void leave_out(std::string what, std::string why) { out_.left_out.push_back({std::move(what), std::move(why)}); }

  const ImportOptions& options_;
  std::map<Point, std::uint32_t> vertex_at_;
  std::vector<std::optional<Vec4f>> colors_;  ///< of each facet that is kept
  Facet facet_{};                             ///< of the text, as far as it was read
  std::size_t corner_count_ = 0;
  std::uint64_t seen_ = 0, repaired_ = 0, points_ = 0, solids_ = 0;
  Tally unknown_;
  PolygonFile out_;
};

/// The size says how many facets there are; writers that stream leave the count 0, and others are wrong.
Status StlReader::read_binary(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty() && looks_like_text(text_of(bytes))) {
    return invalid("header", "neither text that begins with solid nor binary");
  }
  if (bytes.size() < kHead) return invalid("header", "cut short");
  const std::uint64_t stated = load_u32(bytes, 80), count = (bytes.size() - kHead) / kFacet;
  const std::size_t rest = (bytes.size() - kHead) % kFacet;
  if (stated != count) {
    leave_out("facet count", "the header says " + std::to_string(stated) + ", the file has " + std::to_string(count));
  }
  if (rest != 0) {
    const bool is_zero = std::all_of(bytes.end() - static_cast<std::ptrdiff_t>(rest), bytes.end(),
                                     [](std::uint8_t byte) { return byte == 0; });
    leave_out(counted(rest, is_zero ? "byte of 0" : "byte", is_zero ? "bytes of 0" : "bytes"),
              "they follow the last whole facet");
  }
  StlColors colors({reinterpret_cast<const char*>(bytes.data()), 80}, options_.linear_colors);
  const auto attribute_of = [&](std::uint64_t i) {
    std::uint16_t attribute;
    std::memcpy(&attribute, bytes.data() + kHead + kFacet * i + 48, 2);
    return attribute;
  };
  std::uint64_t zeros = 0;
  while (zeros < count && attribute_of(zeros) == 0) ++zeros;
  if (zeros == count) colors.set_all_zero();
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint8_t* const at = bytes.data() + kHead + kFacet * i;
    Facet facet;
    std::memcpy(facet.data(), at + 12, sizeof(facet));
    if (auto status = add(facet, colors.color_of(attribute_of(i))); !status) return status;
  }
  colors.report(out_.left_out);
  return Ok{};
}

Status StlReader::take_vertex(std::string_view& text) {
  if (corner_count_ == 3) return invalid(place(), "more than three corners");
  for (std::size_t c = 0; c < 3; ++c) {
    const auto number = parse_number(take_word(text));
    if (!number) return invalid(place(), "a coordinate is missing or not a number");
    facet_[3 * corner_count_ + c] = static_cast<float>(*number);
  }
  ++corner_count_;
  return Ok{};
}

Status StlReader::read_text(std::string_view text) {
  while (true) {
    std::string word = folded(take_word(text).substr(0, 16));
    if (word.empty()) break;
    if (word == "end") word += folded(take_word(text).substr(0, 16));  // "end loop"
    if (word == "solid" || word == "endsolid") {
      if (word == "solid") ++solids_;
      skip_name(text);  // it may be anything, "vertex" too
    } else if (word == "vertex") {
      if (auto status = take_vertex(text); !status) return status;
    } else if (word == "endloop") {
      if (corner_count_ != 3) return invalid(place(), "fewer than three corners");
      if (auto status = add(facet_); !status) return status;
      corner_count_ = 0;
    } else if (word == "normal") {
      for (int c = 0; c < 3; ++c) {
        std::string_view after = text;
        if (!parse_number(take_word(after))) break;
        text = after;
      }
    } else if (!is_keyword(word)) {
      if (!parse_number(word)) unknown_.add(word);
      if (unknown_.size() > 64) return invalid(place(), "not STL: too many unknown keywords");
    } else if (word == "color" || word == "colour") {
      unknown_.add(word);
    }
  }
  if (corner_count_ != 0) return invalid(place(), "cut short");
  return Ok{};
}

PolygonFile StlReader::finish() {
  out_.drops.repaired = repaired_;
  if (points_ != 0) leave_out(counted(points_, "triangle"), "two of their corners are the same point");
  if (solids_ > 1) leave_out("the names of " + counted(solids_, "solid"), "an STL becomes one mesh");
  for (const auto& [word, count] : unknown_.counts()) {
    leave_out("STL keyword " + shown(word), counted(count, "time") + ": not one that is read");
  }
  PolygonSoup& soup = out_.soup;
  const bool is_colored =
      std::any_of(colors_.begin(), colors_.end(), [](const auto& color) { return color.has_value(); });
  if (is_colored) {
    soup.colors.assign(soup.positions.size(), Vec4f(1.0F));
    WedgeBuilder wedges(soup);
    for (std::size_t i = 0; i < soup.corners.size(); ++i) {
      soup.corners[i] = wedges.take(soup.corners[i], {.uv = {}, .normal = {}, .color = colors_[i / 3]});
    }
    for (const auto& color : colors_) soup.polygon_traits.push_back(color ? kHasAll : kHasUvs | kHasNormals);
  }
  return std::move(out_);
}

Status StlReader::add(const Facet& facet, const std::optional<Vec4f>& color) {
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
    colors_.push_back(color);
  }
  return Ok{};
}

/// The vertex at a finite position; 0 and -0 are the same place.
std::uint32_t StlReader::weld(const Point& point) {
  const auto next = static_cast<std::uint32_t>(out_.soup.positions.size());
  const auto [known, is_new] = vertex_at_.try_emplace(point, next);
  if (is_new) out_.soup.positions.emplace_back(point[0], point[1], point[2]);
  return known->second;
}

}  // namespace

Result<PolygonFile> read_stl(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  StlReader reader(options);
  TRY_LET(status, is_binary(bytes) ? reader.read_binary(bytes) : reader.read_text(text_of(bytes)));
  return reader.finish();
}

}  // namespace meshlode::scene
