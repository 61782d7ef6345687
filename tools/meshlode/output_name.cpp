// SPDX-License-Identifier: GPL-3.0-or-later
#include "output_name.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "base/printable.h"

namespace meshlode::cli {

namespace {

/// Extensions that name a format: of pictures, of models, of text and of archives.
constexpr std::string_view kNamed[] = {
    ".avif",     ".bmp",  ".dds", ".exr",  ".gif", ".hdr",   ".jfif", ".jpeg", ".jpg",  ".jxl",   ".ktx",
    ".ktx2",     ".pdf",  ".pgm", ".png",  ".pnm", ".ppm",   ".psd",  ".qoi",  ".svg",  ".tga",   ".tif",
    ".tiff",     ".webp", ".3ds", ".3mf",  ".abc", ".blend", ".bvh",  ".dae",  ".fbx",  ".glb",   ".gltf",
    ".lode",     ".lwo",  ".obj", ".off",  ".ply", ".stl",   ".usd",  ".usda", ".usdc", ".usdz",  ".vrm",
    ".wrl",      ".x3d",  ".xyz", ".csv",  ".gz",  ".htm",   ".html", ".js",   ".json", ".jsonl", ".md",
    ".markdown", ".pdb",  ".tar", ".toml", ".txt", ".xml",   ".yaml", ".yml",  ".zip",  ".zst"};

bool is_among(std::string_view extension, const std::string_view* first, const std::string_view* last) {
  return std::find(first, last, extension) != last;
}

}  // namespace

Status check_output_name(const char* option, const std::string& path, std::initializer_list<std::string_view> formats) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  if (!is_among(extension, std::begin(kNamed), std::end(kNamed))) return Ok{};
  if (is_among(extension, formats.begin(), formats.end())) return Ok{};
  const std::string name = printable(path, 200);
  if (formats.size() == 0) {
    return Error{ErrorCode::kUsage, option, "what is written is no " + extension + " file (got '" + name + "')"};
  }
  const std::string wanted(*formats.begin());
  return Error{ErrorCode::kUsage, option,
               "what is written is a " + wanted + " file, not a " + extension + " file (got '" + name +
                   "'); give a name that ends in " + wanted};
}

}  // namespace meshlode::cli
