// SPDX-License-Identifier: GPL-3.0-or-later
// docs/reference/api.md shows the example that is compiled and run, to the letter.
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode {
namespace {

std::string read_text(const std::string& path) {
  std::ifstream in(std::string(MESHLODE_SOURCE_DIR) + "/" + path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(ApiDocs, ShowTheExampleThatIsCompiled) {
  const std::string code = read_text("tests/api/example.cpp");
  const std::string page = read_text("docs/reference/api.md");
  ASSERT_FALSE(code.empty());
  ASSERT_FALSE(page.empty());
  const std::string body = code.substr(code.find("#include"));
  EXPECT_NE(page.find("```cpp\n" + body + "```"), std::string::npos)
      << "copy tests/api/example.cpp into docs/reference/api.md";
}

/// The C++ blocks of the page, each as it stands between its fences.
std::vector<std::string> cpp_blocks(const std::string& page) {
  std::vector<std::string> blocks;
  const std::string begin = "```cpp\n";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    blocks.push_back(page.substr(at, page.find("```", at) - at));
  }
  return blocks;
}

TEST(ApiDocs, TheFirstFrameIsDrawnByTheProgramThatIsCompiled) {
  const std::string code = read_text("tests/api/first_frame.cpp");
  const std::vector<std::string> blocks = cpp_blocks(read_text("docs/tutorials/first-frame.md"));
  EXPECT_EQ(blocks.size(), 5U);
  for (const std::string& block : blocks) {
    EXPECT_NE(code.find(block), std::string::npos) << "not in tests/api/first_frame.cpp:\n" << block;
  }
}

/// The lines between \\code and \\endcode, without marks of comments and blanks around them.
std::vector<std::string> code_of_header(const std::string& header) {
  std::vector<std::string> lines;
  std::istringstream text(header.substr(0, header.find("\\endcode")));
  bool is_code = false;
  for (std::string line; std::getline(text, line);) {
    const std::size_t first = line.find_first_not_of(" /*");
    if (is_code && first != std::string::npos && line.substr(first) != "...") lines.push_back(line.substr(first));
    is_code = is_code || line.find("\\code") != std::string::npos;
  }
  return lines;
}

TEST(ApiDocs, HeadersShowExamplesThatAreCompiled) {
  for (const auto& [header, example] : {std::pair{"runtime.h", "header_examples.cpp"},
                                        {"build.h", "header_examples.cpp"},
                                        {"meshlode.h", "header_examples.c"},
                                        {"meshlode_build.h", "header_examples.c"}}) {
    const std::string code = read_text(std::string("tests/api/") + example);
    const std::vector<std::string> lines = code_of_header(read_text(std::string("include/meshlode/") + header));
    EXPECT_GE(lines.size(), 4U) << header;
    std::size_t at = 0;
    for (const std::string& line : lines) {
      at = code.find("\n  " + line + "\n", at);
      ASSERT_NE(at, std::string::npos) << header << ": not in " << example << ", in this order: " << line;
    }
  }
}

TEST(ApiDocs, ShowTheCExampleThatIsCompiled) {
  const std::string code = read_text("tests/api/c_example.c");
  ASSERT_FALSE(code.empty());
  const std::string body = code.substr(code.find("#include"));
  EXPECT_NE(read_text("docs/reference/api.md").find("```c\n" + body + "```"), std::string::npos)
      << "copy tests/api/c_example.c into docs/reference/api.md";
}

}  // namespace
}  // namespace meshlode
