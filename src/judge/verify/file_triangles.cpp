// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/file_triangles.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace meshlode::judge {

namespace {

constexpr std::size_t kStlHead = 84, kStlFacet = 50;
constexpr std::size_t kTextProbe = 1024;  ///< a text has no zero byte there, a binary STL has

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Whether the text begins with the word, in any case, and a blank follows it.
bool has_word(std::string_view text, std::string_view word) {
  if (text.size() < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (lower(text[i]) != word[i]) return false;
  }
  return text.size() == word.size() || text.find_first_of(" \t\r\n", word.size()) == word.size();
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\f\v\r\n");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

std::string_view without_mark(std::string_view text) {
  return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

/// Calls it with each line that is not blank, from its first word on.
template <class Body>
void for_each_line(std::string_view text, const Body& body) {
  for (text = without_blanks(text); !text.empty(); text = without_blanks(text)) {
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    if (!body(line)) return;
    text.remove_prefix(line.size());
  }
}

/// The next word off the front; empty at the end.
std::string_view take_word(std::string_view& text) {
  text = without_blanks(text);
  const std::string_view word = text.substr(0, text.find_first_of(" \t\f\v\r\n"));
  text.remove_prefix(word.size());
  return word;
}

bool is_text_stl(std::string_view text) {
  return has_word(without_blanks(without_mark(text)), "solid") &&
         text.substr(0, kTextProbe).find('\0') == std::string_view::npos;
}

using StlCorner = std::array<float, 3>;

/// Importers may pass over a facet with two corners in one place, and refuse one that is not finite.
bool is_sound_facet(const std::array<StlCorner, 3>& facet) {
  for (const StlCorner& corner : facet) {
    if (!std::all_of(corner.begin(), corner.end(), [](float x) { return std::isfinite(x); })) return false;
  }
  return facet[0] != facet[1] && facet[1] != facet[2] && facet[2] != facet[0];
}

FileTriangles of_binary_stl(std::span<const std::uint8_t> bytes) {
  FileTriangles found{.at_least = 0, .at_most = 0, .words = "a binary STL of its size holds"};
  for (std::size_t at = kStlHead; at + kStlFacet <= bytes.size(); at += kStlFacet) {
    std::array<StlCorner, 3> facet;
    std::memcpy(facet.data(), &bytes[at + sizeof(StlCorner)], sizeof facet);
    found.at_least += is_sound_facet(facet) ? 1 : 0;
    ++found.at_most;
  }
  return found;
}

/// Corners that are not numbers make no facet.
FileTriangles of_text_stl(std::string_view text) {
  FileTriangles found{.words = "corners of the text STL make"};
  std::array<StlCorner, 3> facet{};
  std::size_t corners = 0;
  for_each_line(without_mark(text), [&](std::string_view line) {
    if (has_word(line, "facet")) corners = 0;
    if (!has_word(line, "vertex") || corners == facet.size()) return true;
    take_word(line);
    for (float& x : facet[corners]) {
      const std::string_view word = take_word(line);
      const bool has_sign = word.starts_with('+');
      double number = std::numeric_limits<double>::quiet_NaN();
      std::from_chars(word.data() + (has_sign ? 1 : 0), word.data() + word.size(), number);
      x = static_cast<float>(number);
    }
    found.at_least += ++corners == facet.size() && is_sound_facet(facet) ? 1 : 0;
    return true;
  });
  return found;
}

/// A face with a corner twice may be none. Of a continued line the first part counts.
FileTriangles of_obj(std::string_view text) {
  FileTriangles found{.words = "faces of the OBJ have"};
  std::vector<std::string_view> corners;
  for_each_line(without_mark(text), [&](std::string_view line) {
    if (!has_word(line, "f")) return true;
    take_word(line);
    corners.clear();
    for (std::string_view word = take_word(line); !word.empty() && word[0] != '#' && word != "\\";
         word = take_word(line)) {
      corners.push_back(word.substr(0, word.find('/')));
    }
    std::sort(corners.begin(), corners.end());
    const bool is_sound = std::adjacent_find(corners.begin(), corners.end()) == corners.end();
    found.at_least += corners.size() >= 3 && is_sound ? 1 : 0;
    return true;
  });
  return found;
}

FileTriangles of_ply(std::string_view text) {
  FileTriangles found{.words = "the header of the PLY states"};
  for_each_line(without_mark(text), [&](std::string_view line) {
    if (has_word(line, "element")) {
      const std::string_view name = without_blanks(line.substr(std::string_view("element").size()));
      const std::string_view count = has_word(name, "face") ? without_blanks(name.substr(4)) : std::string_view();
      if (count.find_first_of("123456789") != std::string_view::npos) found.at_least = 1;
    }
    return !has_word(line, "end_header");
  });
  return found;
}

}  // namespace

std::optional<FileTriangles> count_file_triangles(std::span<const std::uint8_t> bytes, std::string_view name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string extension(name.substr(std::min(name.size(), name.rfind('.'))));
  std::transform(extension.begin(), extension.end(), extension.begin(), lower);
  if (extension == ".stl") return is_text_stl(text) ? of_text_stl(text) : of_binary_stl(bytes);
  if (extension == ".obj") return of_obj(text);
  if (extension == ".ply") return of_ply(text);
  return std::nullopt;
}

}  // namespace meshlode::judge
