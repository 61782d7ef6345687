// SPDX-License-Identifier: GPL-3.0-or-later
// One definition of a name (C++20, [basic.def.odr]): two types of one namespace that have one name, each in a file of
// its own, go together through compiler and linker without a word, and then one's functions are run on the other.
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

/// Full names of the types that a text defines where other files could see or repeat them: in named namespaces, not
/// inside of other types. The text has the form of .clang-format.
std::vector<std::string> defined_types(const std::string& text) {
  static const std::regex opens("^(?:inline )?namespace ?([A-Za-z0-9_:]*) \\{[^}]*"),
      defines(
          "^(?:struct|class|union|enum class|enum)(?: alignas\\([^)]*\\)| \\[\\[[^\\]]*\\]\\])* ([A-Za-z0-9_]+)"
          "(?: final)?(?:(?: :.*)? \\{.*)?");
  std::vector<std::string> namespaces, types;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("}  // namespace") && !namespaces.empty()) {
      namespaces.pop_back();
    } else if (std::regex_match(line, match, opens)) {
      namespaces.push_back(match[1]);
    } else if (std::regex_match(line, match, defines)) {
      std::string name;
      bool is_of_file = false;  // in a namespace without a name
      for (const std::string& part : namespaces) {
        is_of_file = is_of_file || part.empty();
        name += part + "::";
      }
      if (!is_of_file) types.push_back(name + match[1].str());
    }
  }
  return types;
}

TEST(Definitions, ATypeIsDefinedOnce) {
  std::map<std::string, std::string> file_of;
  for (const SourceFile& file : read_tree({"src", "tools"}, {".h", ".cpp", ".inl"})) {
    for (const std::string& type : defined_types(file.text)) {
      const auto [first, is_new] = file_of.try_emplace(type, file.path.string());
      EXPECT_TRUE(is_new) << type << " is in " << first->second << " and in " << file.path.string();
    }
  }
  EXPECT_GT(file_of.size(), 500U);
}

TEST(Definitions, TypesOfNamedNamespacesAreSeen) {
  EXPECT_EQ(
      defined_types("namespace a::b {\n\nstruct One {\n  struct Inner {};\n};\nclass Two : public One {\n};\n"
                    "namespace {\nstruct Own {\n};\n}  // namespace\nenum class Three : int { k };\n"
                    "namespace c { struct Other; }\nstruct Named;\nstruct alignas(16) [[nodiscard]] Four {\n};\n"
                    "struct Five\n    : public One {\n};\nunion Six {\n};\n}  // namespace a::b\n"),
      (std::vector<std::string>{"a::b::One", "a::b::Two", "a::b::Three", "a::b::Four", "a::b::Five", "a::b::Six"}));
}

}  // namespace
}  // namespace meshlode::house
