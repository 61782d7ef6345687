// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/read_mtl.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace meshlode::scene {

namespace {

/// How many numbers may follow each option of a map before the file's name.
constexpr std::pair<std::string_view, int> kMapOptions[] = {
    {"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-mm", 2}, {"-o", 3},       {"-s", 3},   {"-cc", 1},
    {"-t", 3},      {"-texres", 1}, {"-clamp", 1}, {"-bm", 1}, {"-imfchan", 1}, {"-type", 1}};

constexpr std::pair<std::string_view, MtlMap MtlMaterial::*> kMaps[] = {
    {"map_kd", &MtlMaterial::base_color}, {"map_d", &MtlMaterial::alpha},  {"map_ke", &MtlMaterial::emissive},
    {"norm", &MtlMaterial::normal},       {"map_pr", &MtlMaterial::rough}, {"map_pm", &MtlMaterial::metal}};

constexpr std::pair<std::string_view, std::optional<double> MtlMaterial::*> kNumbers[] = {
    {"d", &MtlMaterial::dissolve},
    {"tr", &MtlMaterial::transparency},
    {"pr", &MtlMaterial::roughness},
    {"pm", &MtlMaterial::metalness}};

/// The name behind the options; names may have blanks. -o, -s and -t take one to three numbers.
std::string_view texture_name(std::string_view line, std::string_view keyword, Tally& skipped) {
  for (;;) {
    line = trimmed(line);
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    const auto* option = std::find_if(std::begin(kMapOptions), std::end(kMapOptions),
                                      [&](const auto& known) { return is_word(word, known.first); });
    if (option == std::end(kMapOptions)) return unquoted(line);
    skipped.add("option " + std::string(option->first) + " of " + shown(keyword));
    line = rest;
    for (int i = 0; i < option->second; ++i) {
      rest = line;
      const std::string_view value = take_word(rest);
      if (i > 0 && !parse_number(value)) break;  // the first belongs to the option, whatever it is
      line = rest;
    }
  }
}

/// One number stands for all three.
std::optional<std::array<double, 3>> read_color(std::string_view line) {
  std::array<double, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string_view word = take_word(line);
    if (word.empty() && c == 1) return std::array{out[0], out[0], out[0]};
    const auto number = parse_number(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;  // "spectral" and "xyz" too
    out[c] = *number;
  }
  return out;
}

class MtlReader {
 public:
  void read_line(std::string_view keyword, std::string_view line) {
    const std::string name = folded(keyword);
    if (name == "newmtl") {
      out.materials.emplace_back().name = std::string(trimmed(line));
    } else if (out.materials.empty()) {
      out.skipped.add(shown(keyword) + " before any newmtl");
    } else if (!read_color_of(name, keyword, line) && !read_number(name, keyword, line) &&
               !read_map(name, keyword, line)) {
      out.skipped.add(shown(keyword.substr(0, 16)));
    }
  }
  MtlFile out;

 private:
  bool read_color_of(const std::string& name, std::string_view keyword, std::string_view line) {
    if (name != "kd" && name != "ke") return false;
    auto color = read_color(line);
    if (!color) return make_no_sense(keyword);
    const double most = name == "kd" ? 1.0 : 1e6;
    const auto given = *color;
    for (double& c : *color) c = std::clamp(c, 0.0, most);
    if (*color != given) out.clamped.add(shown(keyword));
    if (name == "kd") {
      out.materials.back().diffuse = *color;
    } else {
      out.materials.back().emission = color;
    }
    return true;
  }

  bool read_number(const std::string& name, std::string_view keyword, std::string_view line) {
    for (const auto& [known, member] : kNumbers) {
      if (known != name) continue;
      const auto number = parse_number(take_word(line));
      if (!number || !std::isfinite(*number)) return make_no_sense(keyword);  // "d -halo" too
      const double inside = std::clamp(*number, 0.0, 1.0);
      if (inside != *number) out.clamped.add(shown(keyword));
      out.materials.back().*member = inside;
      return true;
    }
    return false;
  }

  bool read_map(const std::string& name, std::string_view keyword, std::string_view line) {
    for (const auto& [known, member] : kMaps) {
      if (known != name) continue;
      const std::string_view file = texture_name(line, keyword, out.skipped);
      if (file.empty()) return make_no_sense(keyword);
      out.materials.back().*member = {std::string(file), std::string(keyword)};
      return true;
    }
    return false;
  }

  /// \returns true: the line is done with
  bool make_no_sense(std::string_view keyword) {
    out.skipped.add(shown(keyword) + " without a value that makes sense");
    return true;
  }
};

}  // namespace

MtlFile read_mtl(std::span<const std::uint8_t> bytes) {
  std::string_view text = text_of(bytes);
  MtlReader reader;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    const std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword.front() == '#') continue;
    reader.read_line(keyword, line);
    if (reader.out.skipped.size() > 256) break;  // it is no MTL: what follows says nothing
  }
  return std::move(reader.out);
}

}  // namespace meshlode::scene
