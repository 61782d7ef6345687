// SPDX-License-Identifier: GPL-3.0-or-later
// Documents name files and rooms; when these move, the text must follow.
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

namespace fs = std::filesystem;

std::vector<SourceFile> documents() {
  std::vector<SourceFile> files = read_tree({"docs"}, {".md"});
  for (const char* name : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"}) files.push_back(read_file(name));
  return files;
}

/// `src/builder/builder.cpp` and the like in backticks: paths from the repository's root that name a file or a folder.
/// What has a placeholder or a pattern in it is no path.
std::vector<std::string> named_paths(const std::string& text) {
  static const std::regex path("`((?:src|include|tests|tools|cmake|bench|docs|data)/[A-Za-z0-9_./-]+)`");
  std::vector<std::string> paths;
  for (std::sregex_iterator it(text.begin(), text.end(), path), end; it != end; ++it) {
    const std::string name = (*it)[1];
    if (name.find("NAME") == std::string::npos) paths.push_back(name);
  }
  return paths;
}

/// Targets of Markdown links that are files of the repository.
std::vector<std::string> linked_files(const std::string& text) {
  static const std::regex link(R"(\]\(([^)\s#:]+)(?:#[^)\s]*)?\))");
  std::vector<std::string> files;
  for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it) files.push_back((*it)[1]);
  return files;
}

TEST(Documents, EveryPathTheyNameExists) {
  std::size_t count = 0;
  for (const SourceFile& file : documents()) {
    for (const std::string& path : named_paths(file.text)) {
      EXPECT_TRUE(fs::exists(repository() / path)) << file.path.string() << " names " << path;
      ++count;
    }
  }
  EXPECT_GT(count, 100U);
}

TEST(Documents, EveryLinkLeadsToAFile) {
  for (const SourceFile& file : documents()) {
    for (const std::string& target : linked_files(file.text)) {
      EXPECT_TRUE(fs::exists(repository() / file.path.parent_path() / target))
          << file.path.string() << " links " << target;
    }
  }
}

TEST(Documents, EveryRoomIsInTheArchitecture) {
  const std::string text = read_file("docs/explanation/architecture.md").text;
  for (const fs::directory_entry& floor : fs::directory_iterator(repository() / "src")) {
    const std::string floor_name = floor.path().filename().string();
    const std::size_t start = text.find("**`" + floor_name + "/`**");
    ASSERT_NE(start, std::string::npos) << "floor " << floor_name;
    const std::string section = text.substr(start, text.find("\n**`", start) - start);
    for (const fs::directory_entry& room : fs::directory_iterator(floor.path())) {
      if (!room.is_directory()) continue;
      EXPECT_NE(section.find("| `" + room.path().filename().string() + "/` |"), std::string::npos) << room.path();
    }
  }
}

TEST(Documents, TheChecksFindWhatIsMissing) {
  EXPECT_EQ(named_paths("see `src/attic/old.cpp`, `tools/meshlode/verb_NAME.cpp` and `data/*.glb`"),
            std::vector<std::string>{"src/attic/old.cpp"});
  EXPECT_EQ(linked_files("[a](b.md), [c](d.md#e), [f](#g), [h](https://example.org/i)"),
            (std::vector<std::string>{"b.md", "d.md"}));
}

}  // namespace
}  // namespace meshlode::house
