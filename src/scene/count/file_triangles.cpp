// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/count/file_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>

#include "scene/count/ply_faces.h"
#include "scene/count/words.h"

namespace meshlode::scene::count {

namespace {

constexpr std::size_t kStlHead = 84, kStlFacet = 50;
constexpr std::size_t kTextProbe = 1024;  ///< how far is looked for what no text has

std::uint32_t stated_facets(std::span<const std::uint8_t> bytes) {
  std::uint32_t stated = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&stated, &bytes[kStlHead - sizeof stated], sizeof stated);
  return stated;
}

bool is_stl_word(std::string_view word) {
  constexpr std::string_view kWords[] = {"solid",   "facet",    "normal",   "outer", "loop",  "vertex",
                                         "endloop", "endfacet", "endsolid", "end",   "color", "colour"};
  return std::any_of(std::begin(kWords), std::end(kWords),
                     [&](std::string_view known) { return is_word(word, known); });
}

/// What has the size of a binary STL is one, whatever it begins with. Else a text begins with a word of its kind, and
/// so does the line behind `solid` where bytes are in it that no text has.
bool is_text_stl(std::span<const std::uint8_t> bytes, std::string_view text) {
  if (bytes.size() >= kStlHead && kStlHead + std::uint64_t{kStlFacet} * stated_facets(bytes) == bytes.size()) {
    return false;
  }
  text = without_mark(text);
  const std::string_view head = text.substr(0, kTextProbe);
  const bool is_clean = std::none_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0 || byte == 0x7F || (byte < 0x20 && kBlanks.find(c) == std::string_view::npos);
  });
  const std::string_view first = take_word(text);
  if (!is_word(first, "solid")) return is_clean && is_stl_word(first);
  take_line(text);
  return is_clean || is_stl_word(take_word(text));
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
  std::size_t at = kStlHead;
  for (; at + kStlFacet <= bytes.size(); at += kStlFacet) {
    std::array<StlCorner, 3> facet;
    std::memcpy(facet.data(), &bytes[at + sizeof(StlCorner)], sizeof facet);
    found.at_least += is_sound_facet(facet) ? 1 : 0;
    ++found.at_most;
  }
  const bool has_rest = at < bytes.size() && std::any_of(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(),
                                                         [](std::uint8_t byte) { return byte != 0; });
  if (has_rest && stated_facets(bytes) > found.at_most) {
    ++found.at_least, ++found.at_most;
    found.words = "a binary STL of its size, cut short in a facet that its header counts, holds";
  }
  return found;
}

/// Corners that are not numbers make no facet.
FileTriangles of_text_stl(std::string_view text) {
  FileTriangles found{.words = "corners of the text STL make"};
  std::array<StlCorner, 3> facet{};
  std::size_t corners = 0;
  for (text = without_mark(text); !text.empty();) {
    std::string_view line = take_line(text);
    const std::string_view keyword = take_word(line);
    if (is_word(keyword, "facet")) corners = 0;
    if (!is_word(keyword, "vertex") || corners == facet.size()) continue;
    for (float& x : facet[corners]) {
      x = static_cast<float>(number_of<double>(take_word(line)).value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    found.at_least += ++corners == facet.size() && is_sound_facet(facet) ? 1 : 0;
  }
  return found;
}

/// Takes a statement off the front. A backslash joins it with the next line, but at the end of a comment or of a name's
/// last word.
std::string_view take_statement(std::string_view& text, std::string& joined) {
  const auto goes_on = [](std::string_view line) {
    const std::size_t last = line.find_last_not_of(kBlanks);
    return last != std::string_view::npos && line[last] == '\\';
  };
  std::string_view line = take_line(text), rest = line;
  if (!goes_on(line)) return line;
  const std::string_view keyword = take_word(rest);
  const std::string_view before = line.substr(0, line.find_last_of('\\'));
  const bool is_in_word = !before.empty() && kBlanks.find(before.back()) == std::string_view::npos;
  for (const std::string_view named : {"g", "o", "usemtl", "mtllib", "usemap", "maplib"}) {
    if (keyword == named && is_in_word) return line;
  }
  if (keyword.starts_with('#')) return line;
  joined.clear();
  for (bool is_open = true; is_open;) {
    is_open = goes_on(line);
    joined.append(is_open ? line.substr(0, line.find_last_of('\\')) : line).append(" ");
    is_open = is_open && !text.empty();
    if (is_open) line = take_line(text);
  }
  return joined;
}

/// Whether what follows an `f` has three different corners. Negative numbers count back from the last vertex.
bool is_obj_face(std::string_view line, std::int64_t vertices) {
  Corners corners;
  for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
    const auto corner = number_of<std::int64_t>(word.substr(0, word.find('/')));
    if (!corner) return false;
    corners.add(*corner < 0 ? vertices + 1 + *corner : *corner);
  }
  return corners.are_three();
}

FileTriangles of_obj(std::string_view text) {
  FileTriangles found{.words = "faces of the OBJ have"};
  std::string joined;
  std::int64_t vertices = 0;
  for (text = without_mark(text); !text.empty();) {
    std::string_view line = take_statement(text, joined);
    const std::string_view keyword = take_word(line);
    if (keyword == "v") ++vertices;
    if (keyword == "f" || keyword == "fo") found.at_least += is_obj_face(line, vertices) ? 1 : 0;
  }
  return found;
}

bool is_ply(std::string_view text) {
  text = without_mark(text);
  std::string_view line = take_line(text);
  return line.starts_with("ply") && take_word(line) == "ply" && is_empty(line);
}

}  // namespace

}  // namespace meshlode::scene::count

namespace meshlode::scene {

std::optional<FileTriangles> count_file_triangles(std::span<const std::uint8_t> bytes, std::string_view name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("glTF")) return std::nullopt;
  std::string extension(name.substr(std::min(name.size(), name.rfind('.'))));
  std::transform(extension.begin(), extension.end(), extension.begin(), count::lower);
  if (extension == ".ply" || count::is_ply(text.substr(0, 16))) {
    return FileTriangles{.at_least = count::count_ply_faces(count::without_mark(text)),
                         .words = "faces of the PLY have"};
  }
  if (extension == ".stl")
    return count::is_text_stl(bytes, text) ? count::of_text_stl(text) : count::of_binary_stl(bytes);
  if (extension == ".obj") return count::of_obj(text);
  return std::nullopt;
}

}  // namespace meshlode::scene
