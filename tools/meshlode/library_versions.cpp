// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that sees every library, and asks it nothing but what it is. CLI11 and oneTBB are options.cpp's.
#include "library_versions.h"

#include <cstdio>
#include <string>
#include <vector>

#include <meshlode/format.h>

#include <CGAL/version.h>
#include <OpenMesh/Core/System/config.h>
#include <draco/core/draco_version.h>
#include <jpeglib.h>
#include <meshoptimizer.h>
#include <metis.h>
#include <png.h>
#include <webp/decode.h>
#include <xxhash.h>
#include <boost/version.hpp>
#include <nlohmann/json_fwd.hpp>

#include "app/batch/cache/program_id.h"
#include "base/append_format.h"
#include "base/hash.h"
#include "base/vec.h"
#include "base/version.h"
#include "options.h"

namespace meshlode::cli {

namespace {

// A macro's value as text.
#define MESHLODE_TEXT_OF(token) #token
#define MESHLODE_TEXT(macro) MESHLODE_TEXT_OF(macro)

struct LibraryVersion {
  const char* name;
  std::string version;
  const char* used_for;
};

std::string dotted(int major, int minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}
std::string dotted(int major, int minor, int patch) {
  return dotted(major, minor) + "." + std::to_string(patch);
}

std::string boost_version() {
  return dotted(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100);
}

std::string webp_version() {
  const int version = WebPGetDecoderVersion();
  return dotted((version >> 16) & 0xFF, (version >> 8) & 0xFF, version & 0xFF);
}

/// The branches are the same interface by two projects.
std::string jpeg_version() {
#ifdef LIBJPEG_TURBO_VERSION
  return MESHLODE_TEXT(LIBJPEG_TURBO_VERSION) " (turbo)";
#else
  return MESHLODE_TEXT(JPEG_LIB_VERSION);
#endif
}

std::vector<LibraryVersion> list_libraries() {
  return {
      {"Boost", boost_version(), "exact integers"},
      {"CGAL", MESHLODE_TEXT(CGAL_VERSION), "enclosing balls, repair, dented polygons"},
      {"CLI11", cli11_version(), "the command line"},
      {"Draco", draco::kDracoVersion, "meshes of glTF"},
      {"GLM",
       dotted(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH) + "." + std::to_string(GLM_VERSION_REVISION),
       "vectors"},
      {"libjpeg", jpeg_version(), "textures"},
      {"libpng", png_get_libpng_ver(nullptr), "textures, pictures"},
      {"libwebp", webp_version(), "textures"},
      {"meshoptimizer", dotted(MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION / 10 % 100), "meshes of glTF"},
      {"METIS", dotted(METIS_VER_MAJOR, METIS_VER_MINOR, METIS_VER_SUBMINOR), "the partition"},
      {"nlohmann-json", dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH),
       "JSON"},
      {"oneTBB", onetbb_version(), "threads"},
      {"OpenMesh", dotted(OM_VERSION >> 16, OM_VERSION >> 8 & 0xFF, OM_VERSION & 0xFF), "groups, to compare"},
      {"stb_image", MESHLODE_STB_IMAGE_VERSION, "sizes of images"},
      {"stb_image_write", MESHLODE_STB_IMAGE_WRITE_VERSION, "pictures"},
      {"tinygltf", MESHLODE_TINYGLTF_VERSION, "glTF"},
      {"xxHash", dotted(XXH_VERSION_MAJOR, XXH_VERSION_MINOR, XXH_VERSION_RELEASE), "hashes"},
  };
}

const char* compiler() {
#ifdef __clang__
  return "clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

}  // namespace

std::string version_text() {
  std::string text = std::string(program_version()) + "\n";
  const Result<Hash128> id = app::find_program_id();
  const std::string build_id = id ? to_hex(*id) : "unknown: " + id.error().message();
  append_format(text, "build id        %s\n", build_id.c_str());
  append_format(text, "compiler        %s\n", compiler());
  append_format(text, "format version  up to %u\n", format::kVersion);
  text += "\nlibrary         version          for\n";
  for (const LibraryVersion& library : list_libraries()) {
    append_format(text, "%-15s %-16s %s\n", library.name, library.version.c_str(), library.used_for);
  }
  return text;
}

app::Versions library_versions() {
  app::Versions versions{{"format", std::to_string(format::kVersion)}, {"compiler", compiler()}};
  for (const LibraryVersion& library : list_libraries()) versions.emplace_back(library.name, library.version);
  return versions;
}

}  // namespace meshlode::cli
