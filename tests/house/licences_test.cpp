// SPDX-License-Identifier: GPL-3.0-or-later
// The border between the licences: the runtime half is MIT, so that an engine may ship it; the rest is
// GPL-3.0-or-later.
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

bool is_mit(const SourceFile& file) {
  static const std::set<std::string> floors = {"format", "run"};
  static const std::set<std::string> headers = {"include/meshlode/format.h",
                                                "include/meshlode/result.h",
                                                "include/meshlode/runtime.h",
                                                "include/meshlode/meshlode.h",
                                                "include/meshlode/page.h",
                                                "include/meshlode/page_cache.h",
                                                "include/meshlode/version.h",
                                                "tests/api/c_example.c",
                                                "tests/api/first_frame.cpp",
                                                "tests/install/consumer/use_c.c",
                                                "tests/install/consumer/use_runtime.cpp"};
  static const std::set<std::string> shaders = {".glsl", ".comp", ".vert", ".frag", ".mesh"};
  const std::string path = file.path.generic_string();
  if (shaders.contains(file.path.extension().string()) || path.starts_with("src/draw/gpu/shaders/")) return true;
  if (path.starts_with("tools/wasm/")) return true;     // what engines on the web get
  if (path.starts_with("docs/examples/")) return true;  // to be copied
  // What goes into pages that users give away; the program that writes them does not.
  static const std::set<std::string> page_texts = {".js", ".css", ".html"};
  if (path.starts_with("src/app/page/") && page_texts.contains(file.path.extension().string())) return true;
  if (floor_of(file.room) == "base") return !path.starts_with("src/base/parallel.");  // oneTBB: of the builder alone
  return floors.contains(floor_of(file.room)) || headers.contains(path);
}

std::string first_comment(const SourceFile& file) {
  std::string line = file.text.substr(0, file.text.find('\n'));
  if (line.starts_with("#!")) {
    const std::size_t start = file.text.find('\n') + 1;
    line = file.text.substr(start, file.text.find('\n', start) - start);
  }
  return line;
}

TEST(Licences, EveryFileSaysItsLicenceInItsFirstLine) {
  const auto files = read_tree({"src", "include", "tools", "tests", "cmake", "bench", "docs/examples"},
                               {".h", ".cpp", ".c", ".txt", ".cmake", ".sh", ".py", ".js", ".mjs", ".ts", ".css",
                                ".html", ".glsl", ".comp", ".vert", ".frag", ".mesh"});
  ASSERT_FALSE(files.empty());
  for (const SourceFile& file : files) {
    const std::string line = first_comment(file);
    const std::string mark = "SPDX-License-Identifier: ";
    const std::size_t at = line.find(mark);
    EXPECT_NE(at, std::string::npos) << file.path.string() << " has no SPDX line";
    if (at == std::string::npos) continue;
    const std::string named = line.substr(at + mark.size());
    EXPECT_EQ(named.substr(0, named.find(' ')), is_mit(file) ? "MIT" : "GPL-3.0-or-later") << file.path.string();
  }
}

TEST(Licences, TheTextsAreThere) {
  for (const char* name : {"LICENSES/GPL-3.0-or-later.txt", "LICENSES/MIT.txt"}) {
    std::ifstream in(repository() / name);
    EXPECT_TRUE(in.good()) << name;
  }
}

// An MIT file must be usable without any GPL file: it includes MIT files only.
TEST(Licences, MitFilesIncludeMitFilesOnly) {
  const auto files = read_tree({"src", "include"}, kSources);
  std::set<std::string> mit;
  for (const SourceFile& file : files) {
    if (is_mit(file)) mit.insert(file.path.generic_string());
  }
  for (const SourceFile& file : files) {
    if (!is_mit(file)) continue;
    for (const Include& include : file.includes()) {
      std::string path;
      if (include.is_quoted) {
        path = include.path.find('/') == std::string::npos ? (file.path.parent_path() / include.path).generic_string()
                                                           : "src/" + include.path;
      } else if (include.path.starts_with("meshlode/")) {
        path = "include/" + include.path;
      } else {
        continue;
      }
      EXPECT_TRUE(mit.contains(path)) << file.path.string() << ":" << include.line << " includes " << include.path;
    }
  }
}

}  // namespace
}  // namespace meshlode::house
