// SPDX-License-Identifier: GPL-3.0-or-later
// The repository as the house tests read it: files, their rooms and their #include lines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace meshlode::house {

struct Include {
  std::string path;
  bool is_quoted = false;  ///< "…" rather than <…>
  std::size_t line = 0;
};

struct SourceFile {
  std::filesystem::path path;  ///< relative to the repository
  std::string room;            ///< as room_of() has it
  std::string text;
  [[nodiscard]] std::vector<Include> includes() const;
  [[nodiscard]] bool is_header() const { return path.extension() == ".h" || path.extension() == ".inl"; }
};

/// "floor/room", or "floor" for a file of the floor itself; "cli" for tools/meshlode, "generate" for tools/generate;
/// else empty. `relative` to the repository.
[[nodiscard]] std::string room_of(const std::filesystem::path& relative);
[[nodiscard]] std::string floor_of(const std::string& room);

inline const std::vector<std::string> kSources = {".h", ".cpp", ".c", ".inl"};

/// Files below the given folders of the repository whose extension is in `extensions` (or that are CMakeLists.txt,
/// where
/// ".txt" is), sorted by path.
[[nodiscard]] std::vector<SourceFile> read_tree(const std::vector<std::string>& folders,
                                                const std::vector<std::string>& extensions);

/// One file. \pre it exists
[[nodiscard]] SourceFile read_file(const std::filesystem::path& relative);

[[nodiscard]] std::filesystem::path repository();

/// #include lines of a text.
[[nodiscard]] std::vector<Include> parse_includes(const std::string& text);

}  // namespace meshlode::house
