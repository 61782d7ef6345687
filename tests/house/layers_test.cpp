// SPDX-License-Identifier: GPL-3.0-or-later
// The border between rooms: every #include of src/ and tools/ against cmake/layers.txt.
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

using Layers = std::map<std::string, std::set<std::string>>;

Layers read_layers() {
  Layers layers;
  std::ifstream in(repository() / "cmake/layers.txt");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) {
      ADD_FAILURE() << "not `room: rooms`: " << line;
      continue;
    }
    std::istringstream rooms(line.substr(colon + 1));
    std::set<std::string>& allowed = layers[line.substr(0, colon)];
    for (std::string room; rooms >> room;) allowed.insert(room);
  }
  return layers;
}

/// The room a quoted path leads to; empty for a file of the same folder.
std::string target_room(const Include& include) {
  const std::size_t slash = include.path.find('/');
  return slash == std::string::npos ? std::string() : include.path.substr(0, slash);
}

/// What is wrong with an #include of `room`; empty where nothing is.
std::string judge(const Layers& layers, const std::string& room, const Include& include) {
  if (!include.is_quoted) return {};
  if (include.path.find("..") != std::string::npos) return "goes up with ..";
  const std::string target = target_room(include);
  if (target.empty() || target == room) return {};
  const auto it = layers.find(room);
  if (it == layers.end()) return "room " + room + " is not in cmake/layers.txt";
  if (it->second.contains(target) || it->second.contains("*")) return {};
  return room + " may not include " + target;
}

TEST(Layers, EveryIncludeIsAnAllowedEdge) {
  const Layers layers = read_layers();
  const auto files = read_tree({"src", "tools"}, {".h", ".cpp", ".c"});
  ASSERT_FALSE(files.empty());
  for (const SourceFile& file : files) {
    for (const Include& include : file.includes()) {
      const std::string complaint = judge(layers, file.room, include);
      EXPECT_TRUE(complaint.empty()) << file.path.string() << ":" << include.line << ": " << complaint;
    }
  }
}

TEST(Layers, PublicHeadersIncludeNoRoom) {
  for (const SourceFile& file : read_tree({"include"}, {".h"})) {
    for (const Include& include : file.includes()) {
      EXPECT_FALSE(include.is_quoted) << file.path.string() << ":" << include.line << " includes " << include.path;
    }
  }
}

TEST(Layers, TheCheckFailsOnAForbiddenEdge) {
  const Layers layers = read_layers();
  const auto include = [](const char* line) { return parse_includes(line).at(0); };
  EXPECT_EQ(judge(layers, "verify", include("#include \"dag/dag.h\"")), "verify may not include dag");
  EXPECT_EQ(judge(layers, "select", include("  #  include \"mesh/scene.h\"\n")), "select may not include mesh");
  EXPECT_EQ(judge(layers, "nobody", include("#include \"base/vec.h\"")), "room nobody is not in cmake/layers.txt");
  EXPECT_NE(judge(layers, "mesh", include("#include \"../dag/dag.h\"")), "");
  EXPECT_EQ(judge(layers, "verify", include("#include \"read/asset.h\"")), "");
}

// The judge shares no code with what it judges, the runtime stands alone, and neither half of a codec sees the other.
TEST(Layers, TheTableKeepsTheDesignsBorders) {
  const Layers layers = read_layers();
  const std::set<std::string> run = {"base", "coding", "read", "unpack", "select", "decode"};
  for (const char* room : {"coding", "read", "unpack", "select", "decode", "api_runtime"}) {
    for (const std::string& target : layers.at(room)) EXPECT_TRUE(run.contains(target)) << room << " -> " << target;
  }
  for (const char* room : {"metrics", "validate", "verify", "raster", "report"}) {
    for (const char* builder : {"cluster", "group", "simplify", "deviation", "dag", "hierarchy", "encode", "pack",
                                "partition", "prepare", "write", "pipeline", "*"}) {
      EXPECT_FALSE(layers.at(room).contains(builder)) << room << " -> " << builder;
    }
  }
  EXPECT_FALSE(layers.at("encode").contains("decode") || layers.at("decode").contains("encode"));
  EXPECT_FALSE(layers.at("pack").contains("unpack") || layers.at("unpack").contains("pack"));
}

}  // namespace
}  // namespace meshlode::house
