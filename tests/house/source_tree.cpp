// SPDX-License-Identifier: GPL-3.0-or-later
#include "source_tree.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace meshlode::house {

namespace fs = std::filesystem;

fs::path repository() {
  return MESHLODE_SOURCE_DIR;
}

namespace {

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::string room_of(const fs::path& relative) {
  std::vector<std::string> parts;
  for (const fs::path& part : relative) parts.push_back(part.string());
  if (parts.size() < 3) return {};
  if (parts[0] == "tools") return parts[1] == "meshlode" ? "cli" : parts[1];
  if (parts[0] != "src") return {};
  return parts.size() == 3 ? parts[1] : parts[1] + "/" + parts[2];
}

std::string floor_of(const std::string& room) {
  return room.substr(0, room.find('/'));
}

std::vector<Include> parse_includes(const std::string& text) {
  std::vector<Include> includes;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    std::size_t i = line.find_first_not_of(" \t");
    if (i == std::string::npos || line[i] != '#') continue;
    i = line.find_first_not_of(" \t", i + 1);
    if (i == std::string::npos || line.compare(i, 7, "include") != 0) continue;
    i = line.find_first_of("<\"", i + 7);
    if (i == std::string::npos) continue;
    const char closing = line[i] == '<' ? '>' : '"';
    const std::size_t end = line.find(closing, i + 1);
    if (end == std::string::npos) continue;
    includes.push_back({line.substr(i + 1, end - i - 1), closing == '"', number});
  }
  return includes;
}

std::vector<Include> SourceFile::includes() const {
  return parse_includes(text);
}

SourceFile read_file(const fs::path& relative) {
  return {relative, room_of(relative), read_text(repository() / relative)};
}

std::vector<SourceFile> read_tree(const std::vector<std::string>& folders, const std::vector<std::string>& extensions) {
  std::vector<SourceFile> files;
  for (const std::string& folder : folders) {
    const fs::path root = repository() / folder;
    if (!fs::exists(root)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
      if (!entry.is_regular_file()) continue;
      const fs::path& path = entry.path();
      const std::string extension = path.extension().string();
      const bool wanted = std::find(extensions.begin(), extensions.end(), extension) != extensions.end() &&
                          (extension != ".txt" || path.filename() == "CMakeLists.txt");
      if (!wanted) continue;
      const fs::path relative = path.lexically_relative(repository());
      files.push_back({relative, room_of(relative), read_text(path)});
    }
  }
  std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

}  // namespace meshlode::house
