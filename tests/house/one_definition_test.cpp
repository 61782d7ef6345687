// SPDX-License-Identifier: GPL-3.0-or-later
// The one-definition rule across rooms. Rooms are libraries that never see each other's private headers, yet share one
// namespace: two functions or classes of one name in two headers link without a word, and which of them a call reaches
// is the compiler's choice (I10: two compilers chose differently once).
#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

constexpr std::string_view kEndOfNamespace = "}  // namespace";

/// Comments go, but for those that say which brace ends a namespace.
std::string without_comments(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0 && !out.ends_with(kEndOfNamespace.substr(0, 3))) {
      i = text.find('\n', i);
      if (i == std::string::npos) break;
    }
    out += text[i];
  }
  return out;
}

/// Drops the parameter's name, default and the space around: "const Vec3d& p = {}" -> "const Vec3d&".
std::string type_of_parameter(std::string parameter) {
  parameter = parameter.substr(0, parameter.find('='));
  while (!parameter.empty() && std::isspace(static_cast<unsigned char>(parameter.back())) != 0) parameter.pop_back();
  std::size_t begin = parameter.size();
  while (begin > 0 && is_word(parameter[begin - 1])) --begin;
  const bool has_name = begin > 0 && parameter.substr(begin) != "const" && parameter[begin - 1] != ':';
  if (has_name) parameter.resize(begin);
  std::string out;
  for (const char c : parameter) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) out += c;
  }
  return out;
}

std::string types_of(const std::string& parameters) {
  std::string out, parameter;
  int depth = 0;
  for (const char c : parameters + ",") {
    depth += c == '<' || c == '(' || c == '{' ? 1 : c == '>' || c == ')' || c == '}' ? -1 : 0;
    if (c == ',' && depth == 0) {
      out += type_of_parameter(parameter) + ",";
      parameter.clear();
    } else {
      parameter += c;
    }
  }
  return out;
}

/// Names with linkage that a header puts into namespaces: "meshlode::Ball", "meshlode::area(constVec3d&,)". Declarations
/// begin in the first column; templates and forward declarations are left out.
std::vector<std::string> names_in(const std::string& header) {
  const std::string text = without_comments(header);
  std::vector<std::string> out, spaces;
  bool is_template = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t here = begin;
    begin = end + 1;
    if (line.empty() || std::isspace(static_cast<unsigned char>(line[0])) != 0 || line[0] == '#') continue;
    if (line.starts_with("namespace ") && line.find('{') != std::string::npos && line.find('}') == std::string::npos) {
      spaces.push_back(line.substr(10, line.find_first_of(" {", 10) - 10) + "::");
      continue;
    }
    if (line[0] == '}') {
      if (line.starts_with(kEndOfNamespace) && !spaces.empty()) spaces.pop_back();
      continue;
    }
    if (line.starts_with("template")) {
      is_template = true;
      if (line.find('>') != std::string::npos && line.find("struct") == std::string::npos &&
          line.find("class") == std::string::npos && line.find('(') == std::string::npos) {
        continue;  // the declaration is on the next line
      }
    }
    const bool skip = is_template;
    is_template = false;
    if (skip || line.starts_with("using") || line.starts_with("extern") || line.starts_with("constexpr") ||
        line.starts_with("inline constexpr") || line.starts_with("static")) {
      continue;
    }
    std::string space;
    for (const std::string& s : spaces) space += s;
    bool is_class = false;
    for (const std::string key : {"struct ", "class ", "union ", "enum class "}) {
      if (!line.starts_with(key)) continue;
      is_class = true;
      std::size_t k = key.size();
      while (k < line.size() && (is_word(line[k]) || line[k] == ':')) ++k;
      std::string name = line.substr(key.size(), k - key.size());
      while (!name.empty() && name.back() == ':') name.pop_back();
      if (line.find('{') != std::string::npos) out.push_back(space + name);
      break;
    }
    const std::size_t open = line.find('(');
    if (is_class || open == std::string::npos) continue;
    std::size_t name_begin = open;
    while (name_begin > 0 && is_word(line[name_begin - 1])) --name_begin;
    if (name_begin == 0 || name_begin == open || line[name_begin - 1] == ':') continue;
    int depth = 0;
    std::size_t close = here + open;
    for (; close < text.size(); ++close) {
      depth += text[close] == '(' ? 1 : text[close] == ')' ? -1 : 0;
      if (depth == 0) break;
    }
    out.push_back(space + line.substr(name_begin, open - name_begin) + "(" +
                  types_of(text.substr(here + open + 1, close - here - open - 1)) + ")");
  }
  return out;
}

/// Names that more than one header defines or declares, with those headers.
std::map<std::string, std::set<std::string>> collisions(const std::vector<SourceFile>& files) {
  std::map<std::string, std::set<std::string>> places;
  for (const SourceFile& file : files) {
    for (const std::string& name : names_in(file.text)) places[name].insert(file.path.string());
  }
  std::erase_if(places, [](const auto& entry) { return entry.second.size() < 2; });
  return places;
}

TEST(House, EveryNameHasOneHeader) {
  std::vector<SourceFile> headers;
  std::size_t names = 0;
  for (SourceFile& file : read_tree({"src", "include"}, {".h"})) {
    if (file.path.string().find("shaders") != std::string::npos) continue;  // GLSL's
    names += names_in(file.text).size();
    headers.push_back(std::move(file));
  }
  EXPECT_GT(names, 500U) << "the scan finds too little to say anything";
  for (const auto& [name, places] : collisions(headers)) {
    std::string list;
    for (const std::string& place : places) list += " " + place;
    ADD_FAILURE() << name << " is in" << list;
  }
}

TEST(House, ASecondHeaderOfANameIsFound) {
  const auto file = [](const char* path, const char* text) { return SourceFile{path, "", text}; };
  const auto found = collisions(
      {file("a.h", "namespace m {\n\nstruct Ball {\n  int x;\n};\n[[nodiscard]] inline double f(const V& p,\n"
                   "   const std::map<int, int>& m) {\n  return 0;\n}\nint g(int);\n}  // namespace m\n"),
       file("b.h", "namespace m {\nstruct Ball {\n  float y;\n};\nclass Other;\n[[nodiscard]] double f(const V& q, "
                   "const std::map<int, int>& other);\nint g(float);\n}  // namespace m\n"),
       file("c.h", "namespace n {\nstruct Ball {\n};\nclass Other {\n};\n}  // namespace n\n")});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(found.contains("m::Ball"));
  EXPECT_TRUE(found.contains("m::f(constV&,conststd::map<int,int>&,)"));
}

}  // namespace
}  // namespace meshlode::house
