// SPDX-License-Identifier: GPL-3.0-or-later
// A third-party library is seen through one .cpp per room that uses it, never in a header: `grep -r "include <metis"`
// hits one file. Excepted are GLM, whose types are our vectors, and three headers that a folder shares with nobody:
// draw/gpu/vulkan/types.h, because the Vulkan wrapper is four files, scene/import/gltf/tinygltf.h, because import works
// on tinygltf's model, and app/export/gltf_document.h, because what export writes is a JSON document.
// tools/meshlode/library_versions.cpp sees nearly all of them, for their versions alone.
#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

struct Library {
  std::string_view name, prefix;
};
constexpr std::array kLibraries = {
    Library{"tinygltf", "tiny_gltf"},
    Library{"draco", "draco/"},
    Library{"metis", "metis.h"},
    Library{"OpenMesh", "OpenMesh/"},
    Library{"CGAL", "CGAL/"},
    Library{"glm", "glm/"},
    Library{"meshoptimizer", "meshoptimizer"},
    Library{"embree", "embree3/"},
    Library{"tbb", "tbb/"},
    Library{"zstd", "zstd"},
    Library{"lz4", "lz4"},
    Library{"xxhash", "xxhash.h"},
    Library{"nlohmann", "nlohmann/"},
    Library{"CLI11", "CLI/"},
    Library{"spdlog", "spdlog/"},
    Library{"fmt", "fmt/"},
    Library{"stb", "stb"},
    Library{"libpng", "png.h"},
    Library{"libjpeg", "jpeglib.h"},
    Library{"libjpeg", "jerror.h"},
    Library{"libwebp", "webp/"},
    Library{"vulkan", "vulkan/"},
    Library{"boost", "boost/"},
    Library{"gmp", "gmp"},
};

/// Those of an operating system that are in use: of POSIX, of glibc, of Windows.
bool is_of_a_system(const std::string& path) {
  static const std::set<std::string> headers = {
      "unistd.h",      "fcntl.h",        "sys/mman.h", "sys/stat.h",    "sys/types.h",   "sys/file.h",
      "sys/wait.h",    "sys/resource.h", "sys/vfs.h",  "linux/magic.h", "dlfcn.h",       "link.h",
      "pthread.h",     "malloc.h",       "poll.h",     "dirent.h",      "sys/syscall.h", "sys/prctl.h",
      "sys/utsname.h", "sys/auxv.h",     "windows.h",  "ntsecapi.h",    "psapi.h"};
  return headers.contains(path);
}

/// Standard C++ headers have neither dot nor slash; these are the C headers in use.
bool is_system(const std::string& path) {
  static const std::set<std::string> c = {"fenv.h", "immintrin.h", "stdint.h", "stddef.h", "stdlib.h"};
  return path.find_first_of("./") == std::string::npos || c.contains(path) || is_of_a_system(path);
}

/// Name of the library, empty for the system's and our own headers, "?" for one nobody has named here.
std::string library_of(const Include& include) {
  if (include.is_quoted || include.path.starts_with("meshlode/") || is_system(include.path)) return {};
  for (const Library& library : kLibraries) {
    if (include.path.starts_with(library.prefix)) return std::string(library.name);
  }
  return "?";
}

/// A header that shows a library, to the .cpp files of its own folder and, where that says so, to its headers. Other
/// folders may see the library by themselves where that says so.
struct Wrapper {
  std::string_view library, path;
  bool is_for_headers = false, is_seen_elsewhere = false;
};
constexpr std::array kWrappers = {
    Wrapper{"vulkan", "src/draw/gpu/vulkan/types.h"},
    Wrapper{"tinygltf", "src/scene/import/gltf/tinygltf.h", true},
    Wrapper{"nlohmann", "src/app/export/gltf_document.h", true, true},
};

const Wrapper* wrapper_at(std::string_view path) {
  for (const Wrapper& wrapper : kWrappers) {
    if (wrapper.path == path) return &wrapper;
  }
  return nullptr;
}

TEST(ThirdParty, ALibraryIsSeenByOneFilePerRoomAndNeverInAHeader) {
  std::map<std::pair<std::string, std::string>, std::set<std::string>> users;  // (room, library) -> files
  for (const SourceFile& file : read_tree({"src", "tools"}, kSources)) {
    for (const Include& include : file.includes()) {
      const std::string library = library_of(include);
      const std::string path = file.path.generic_string();
      if (library.empty() || library == "glm") continue;
      EXPECT_NE(library, "?") << path << ":" << include.line << ": name <" << include.path << "> in this test";
      if (wrapper_at(path) != nullptr) continue;
      EXPECT_FALSE(file.is_header()) << path << ":" << include.line << " shows " << include.path << " to its users";
      users[{file.room, library}].insert(path);
    }
  }
  for (const auto& [key, files] : users) {
    std::string list;
    for (const std::string& path : files) list += " " + path;
    EXPECT_EQ(files.size(), 1U) << "room " << key.first << " sees " << key.second << " in" << list;
  }
}

TEST(ThirdParty, AWrappedLibraryIsSeenByItsFolderAlone) {
  std::map<std::string_view, std::size_t> users;
  for (const SourceFile& file : read_tree({"src", "tools", "bench", "tests"}, kSources)) {
    const std::string path = file.path.generic_string();
    for (const Include& include : file.includes()) {
      const std::string library = library_of(include);
      for (const Wrapper& wrapper : kWrappers) {
        const bool is_inside = path.starts_with(wrapper.path.substr(0, wrapper.path.rfind('/') + 1));
        if (library == wrapper.library && (is_inside || !wrapper.is_seen_elsewhere)) {
          EXPECT_EQ(path, wrapper.path) << "line " << include.line;
        }
        if (!include.is_quoted || "src/" + include.path != wrapper.path) continue;
        EXPECT_TRUE(is_inside && (wrapper.is_for_headers || path.ends_with(".cpp")))
            << path << ":" << include.line << " shows " << wrapper.library;
        ++users[wrapper.path];
      }
    }
  }
  EXPECT_EQ(users.size(), kWrappers.size());
}

/// docs/reference/portability.md: what an engine ships asks the system in one place.
TEST(ThirdParty, TheRuntimeSeesTheSystemInOneFileForEach) {
  std::set<std::string> bodies;
  for (const SourceFile& file : read_tree({"src/base", "src/format", "src/run", "include"}, kSources)) {
    const std::string path = file.path.generic_string();
    for (const Include& include : file.includes()) {
      if (!is_of_a_system(include.path)) continue;
      EXPECT_TRUE(path.starts_with("src/base/system_")) << path << ":" << include.line << " asks the system itself";
      bodies.insert(path);
    }
    if (path.starts_with("src/base/system_")) continue;
    for (const char* name : {"_WIN32", "__linux__", "__unix__", "__APPLE__", "__GLIBC__"}) {
      EXPECT_EQ(file.text.find(name), std::string::npos) << path << " asks which system it is on: " << name;
    }
  }
  EXPECT_EQ(bodies, (std::set<std::string>{"src/base/system_posix.cpp", "src/base/system_windows.cpp"}));
}

TEST(ThirdParty, PublicHeadersShowNone) {
  for (const SourceFile& file : read_tree({"include"}, {".h"})) {
    for (const Include& include : file.includes()) {
      EXPECT_EQ(library_of(include), "") << file.path.string() << ":" << include.line << " shows " << include.path;
    }
  }
}

TEST(ThirdParty, TheCheckKnowsALibrary) {
  EXPECT_EQ(library_of(parse_includes("#include <metis.h>").at(0)), "metis");
  EXPECT_EQ(library_of(parse_includes("#include <vector>").at(0)), "");
  EXPECT_EQ(library_of(parse_includes("#include <nobody/knows.h>").at(0)), "?");
}

}  // namespace
}  // namespace meshlode::house
