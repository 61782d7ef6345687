// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/read_mtl.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// Of a map_Kd: how many numbers may follow each option before the file's name.
constexpr std::pair<std::string_view, int> kMapOptions[] = {
    {"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-mm", 2}, {"-o", 3},       {"-s", 3},
    {"-t", 3},      {"-texres", 1}, {"-clamp", 1}, {"-bm", 1}, {"-imfchan", 1}, {"-type", 1}};

/// The name behind the options; names may have blanks. -o, -s and -t take one to three numbers.
std::string_view texture_name(std::string_view line) {
  for (;;) {
    line = trimmed(line);
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    const auto* option = std::find_if(std::begin(kMapOptions), std::end(kMapOptions),
                                      [&](const auto& known) { return known.first == word; });
    if (option == std::end(kMapOptions)) return line;
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
    out[c] = std::clamp(*number, 0.0, 1.0);
  }
  return out;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<MtlMaterial> out;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    const std::string_view keyword = take_word(line);
    if (keyword == "newmtl") {
      out.emplace_back().name = std::string(trimmed(line));
      continue;
    }
    if (out.empty()) continue;
    MtlMaterial& material = out.back();
    if (keyword == "Kd") {
      if (const auto color = read_color(line)) material.diffuse = *color;
    } else if (keyword == "d" || keyword == "Tr") {
      const auto number = parse_number(take_word(line));
      if (!number || !std::isfinite(*number)) continue;  // "d -halo" too
      const double value = std::clamp(*number, 0.0, 1.0);
      material.opacity = keyword == "d" ? value : 1.0 - value;
    } else if (keyword == "map_Kd") {
      material.texture = std::string(texture_name(line));
    }
  }
  return out;
}

}  // namespace meshlode::scene
