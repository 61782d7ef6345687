// SPDX-License-Identifier: GPL-3.0-or-later
// Engines copy src/draw/gpu/shaders/frame.h: who changes a record, the push constants or the id of a specialization
// constant raises FRAME_LAYOUT_VERSION and says so in docs/reference/shaders.md.
#include <cstdint>
#include <cstdio>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

/// Without comments and white space: what is left decides a layout.
std::string squeeze(const std::string& text) {
  const std::string code = std::regex_replace(text, std::regex("//[^\n]*"), "");
  return std::regex_replace(code, std::regex("\\s+"), "");
}

/// FNV-1a, 64 bits.
std::string mark_of(const std::string& text) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001B3U;
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(hash));
  return out;
}

TEST(FrameLayout, AChangeRaisesTheVersionAndIsDocumented) {
  const std::string frame = read_file("src/draw/gpu/shaders/frame.h").text;
  std::string text = squeeze(frame);
  static const std::regex constant("layout\\(constant_id = [0-9]+\\) const uint k[A-Za-z]+");
  std::size_t constants = 0;
  for (const SourceFile& file : read_tree({"src/draw/gpu/shaders"}, {".comp", ".frag", ".glsl", ".mesh", ".vert"})) {
    for (std::sregex_iterator it(file.text.begin(), file.text.end(), constant), end; it != end; ++it, ++constants) {
      text += file.path.filename().string() + squeeze(it->str());
    }
  }
  EXPECT_GT(constants, 10U);
  const std::string common = read_file("src/draw/gpu/shaders/common.glsl").text;
  std::smatch push;
  ASSERT_TRUE(std::regex_search(common, push, std::regex("uniform Push \\{[^}]*\\}")));
  text += squeeze(push.str());
  std::smatch version;
  ASSERT_TRUE(std::regex_search(frame, version, std::regex("#define FRAME_LAYOUT_VERSION ([0-9]+)")));
  const std::string document = read_file("docs/reference/shaders.md").text;
  const std::regex row("\\| " + version[1].str() + " \\| [^|\n]+ \\| `([0-9a-f]{16})` \\|\n\n");  // the table's last
  std::smatch mark;
  ASSERT_TRUE(std::regex_search(document, mark, row)) << "docs/reference/shaders.md has no last row for the version";
  EXPECT_EQ(mark[1].str(), mark_of(text)) << "raise FRAME_LAYOUT_VERSION and add its row to docs/reference/shaders.md";
}

}  // namespace
}  // namespace meshlode::house
