// SPDX-License-Identifier: GPL-3.0-or-later
// The borders between floors, and the few inside them: every #include of src/ and tools/ against cmake/layers.txt.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

struct Layers {
  std::map<std::string, std::set<std::string>> allowed;    ///< floor -> floors
  std::map<std::string, std::set<std::string>> forbidden;  ///< room -> rooms, other floors
};

Layers read_layers() {
  Layers layers;
  std::ifstream in(repository() / "cmake/layers.txt");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t mark = line.find_first_of(":!");
    if (mark == std::string::npos) {
      ADD_FAILURE() << "neither `floor: floors` nor `room ! rooms`: " << line;
      continue;
    }
    std::istringstream left(line.substr(0, mark)), right(line.substr(mark + 1));
    std::string name;
    left >> name;
    std::set<std::string>& targets = line[mark] == ':' ? layers.allowed[name] : layers.forbidden[name];
    for (std::string target; right >> target;) targets.insert(target);
  }
  return layers;
}

/// What is wrong with an #include by a file of `room` (floor/room, or the floor alone); empty where nothing is.
std::string judge(const Layers& layers, const std::string& room, const Include& include) {
  if (!include.is_quoted) return {};
  if (include.path.find("..") != std::string::npos) return "goes up with ..";
  const std::string target = room_of("src/" + include.path);
  if (target.empty() || target == room) return {};
  const std::string floor = floor_of(room), target_floor = floor_of(target);
  if (floor != target_floor) {
    const auto it = layers.allowed.find(floor);
    if (it == layers.allowed.end()) return "floor " + floor + " is not in cmake/layers.txt";
    if (!it->second.contains(target_floor) && !it->second.contains("*")) {
      return floor + " may not include " + target_floor;
    }
  }
  const auto it = layers.forbidden.find(room);
  if (it == layers.forbidden.end()) return "";
  for (const std::string& closed : {target, target_floor}) {
    if (it->second.contains(closed)) return room + " may not include " + closed;
  }
  return "";
}

TEST(Layers, EveryIncludeIsAnAllowedEdge) {
  const Layers layers = read_layers();
  const auto files = read_tree({"src", "tools"}, kSources);
  ASSERT_FALSE(files.empty());
  for (const SourceFile& file : files) {
    for (const Include& include : file.includes()) {
      const std::string complaint = judge(layers, file.room, include);
      EXPECT_TRUE(complaint.empty()) << file.path.string() << ":" << include.line << ": " << complaint;
    }
  }
}

using Arrows = std::map<std::string, std::set<std::string>>;

/// A room, or a file that lies in the floor itself with its header: "builder/dag", "base/file".
std::string box_of(const std::filesystem::path& path) {
  const std::string room = room_of(path);
  if (room.empty() || room.find('/') != std::string::npos) return room;
  const std::string name = path.filename().string();
  return room + "/" + name.substr(0, name.find('.'));
}

/// Boxes of a circle in `arrows`, each including the next; empty where there is none.
std::vector<std::string> find_circle(const Arrows& arrows) {
  std::set<std::string> done;
  for (const auto& [start, ignored] : arrows) {
    std::vector<std::string> path;
    std::set<std::string> on_path;
    const std::function<bool(const std::string&)> walk = [&](const std::string& box) {
      if (on_path.contains(box)) {
        path.erase(path.begin(), std::find(path.begin(), path.end(), box));
        return true;
      }
      if (done.contains(box)) return false;
      path.push_back(box);
      on_path.insert(box);
      if (const auto it = arrows.find(box); it != arrows.end()) {
        for (const std::string& target : it->second) {
          if (walk(target)) return true;
        }
      }
      path.pop_back();
      on_path.erase(box);
      done.insert(box);
      return false;
    };
    if (walk(start)) return path;
  }
  return {};
}

TEST(Layers, TheRoomsOfAFloorIncludeEachOtherInNoCircle) {
  Arrows arrows;
  for (const SourceFile& file : read_tree({"src"}, kSources)) {
    const std::string box = box_of(file.path);
    for (const Include& include : file.includes()) {
      const std::filesystem::path target = std::filesystem::path("src") / include.path;
      if (!include.is_quoted || !std::filesystem::is_regular_file(repository() / target)) continue;
      const std::string other = box_of(target);
      if (other != box && floor_of(other) == floor_of(box)) arrows[box].insert(other);
    }
  }
  ASSERT_GT(arrows.size(), 40U);
  std::string shown;
  for (const std::string& box : find_circle(arrows)) shown += box + " -> ";
  EXPECT_EQ(shown, "");
}

TEST(Layers, ACircleIsFound) {
  EXPECT_EQ(find_circle({{"a", {"b", "d"}}, {"b", {"c"}}, {"c", {"d"}}}), std::vector<std::string>{});
  EXPECT_EQ(find_circle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"d", "b"}}}), (std::vector<std::string>{"b", "c"}));
}

TEST(Layers, EveryNameIsAFolder) {
  const Layers layers = read_layers();
  const auto expect_folder = [](const std::string& name) {
    if (name == "*" || name == "cli" || name == "generate") return;
    EXPECT_TRUE(std::filesystem::is_directory(repository() / "src" / name)) << name;
  };
  for (const auto* table : {&layers.allowed, &layers.forbidden}) {
    for (const auto& [name, targets] : *table) {
      expect_folder(name);
      for (const std::string& target : targets) expect_folder(target);
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
  EXPECT_EQ(judge(layers, "judge/verify", include("#include \"builder/dag/build_dag.h\"")),
            "judge may not include builder");
  EXPECT_EQ(judge(layers, "run/select", include("  #  include \"scene/scene.h\"\n")), "run may not include scene");
  EXPECT_EQ(judge(layers, "draw/raster", include("#include \"draw/gpu/renderer.h\"")),
            "draw/raster may not include draw/gpu");
  EXPECT_EQ(judge(layers, "attic", include("#include \"base/vec.h\"")), "floor attic is not in cmake/layers.txt");
  EXPECT_NE(judge(layers, "scene", include("#include \"../build/dag/build_dag.h\"")), "");
  EXPECT_EQ(judge(layers, "judge/verify", include("#include \"run/read/asset.h\"")), "");
  EXPECT_EQ(judge(layers, "draw/gpu", include("#include \"draw/raster/raster.h\"")), "");
  EXPECT_EQ(judge(layers, "app/report", include("#include \"builder/builder.h\"")),
            "app/report may not include builder");
  EXPECT_EQ(judge(layers, "app/batch", include("#include \"builder/builder.h\"")), "");
  EXPECT_EQ(judge(layers, "lab/samples", include("#include \"scene/import/import.h\"")),
            "lab/samples may not include scene/import");
  EXPECT_EQ(judge(layers, "cli", include("#include \"lab/samples/samples.h\"")), "cli may not include lab/samples");
}

// The judge shares no code with what it judges, the runtime stands alone, and neither half of a codec sees the other.
TEST(Layers, TheTableKeepsTheBordersOfTheHouse) {
  const Layers layers = read_layers();
  for (const char* floor : {"base", "format", "run"}) {
    for (const std::string& target : layers.allowed.at(floor)) {
      EXPECT_TRUE(target == "base" || target == "format") << floor << " -> " << target;
    }
  }
  for (const char* floor : {"base", "format", "scene", "run", "draw", "judge"}) {
    EXPECT_FALSE(layers.allowed.at(floor).contains("builder") || layers.allowed.at(floor).contains("*")) << floor;
  }
  for (const char* room : {"lab/sweep", "lab/page", "lab/flip", "lab/child"}) {  // they run the program
    EXPECT_TRUE(layers.forbidden.at(room).contains("builder")) << room;
  }
  EXPECT_FALSE(layers.allowed.at("builder").contains("run"));  // encode and decode, pack and unpack
}

TEST(Layers, NoFloorStandsOnItself) {
  const Layers layers = read_layers();
  // Follows the arrows from each floor; a table without circles is walked through in as many steps as it has floors.
  for (const auto& [start, targets] : layers.allowed) {
    std::set<std::string> reached = targets;
    for (std::size_t step = 0; step < layers.allowed.size(); ++step) {
      std::set<std::string> further = reached;
      for (const std::string& floor : reached) {
        if (const auto it = layers.allowed.find(floor); it != layers.allowed.end()) {
          further.insert(it->second.begin(), it->second.end());
        }
      }
      reached = std::move(further);
    }
    EXPECT_FALSE(reached.contains(start)) << start;
  }
}

}  // namespace
}  // namespace meshlode::house
