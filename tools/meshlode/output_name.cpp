// SPDX-License-Identifier: GPL-3.0-or-later
#include "output_name.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <span>

#include "base/printable.h"

namespace meshlode::cli {

namespace {

/// Extensions that name a format: of pictures, of models, of text and of archives.
constexpr std::string_view kNamed[] = {
    ".avif",  ".bmp",  ".dds",      ".exr",  ".gif",  ".hdr",  ".heic", ".ico",  ".jfif", ".jpe",  ".jpeg",  ".jpg",
    ".jxl",   ".ktx",  ".ktx2",     ".pdf",  ".pgm",  ".png",  ".pnm",  ".ppm",  ".psd",  ".qoi",  ".svg",   ".tga",
    ".tif",   ".tiff", ".webp",     ".3ds",  ".3mf",  ".b3dm", ".mtl",  ".step", ".stp",  ".abc",  ".blend", ".bvh",
    ".dae",   ".fbx",  ".glb",      ".gltf", ".lode", ".lwo",  ".obj",  ".off",  ".ply",  ".stl",  ".usd",   ".usda",
    ".usdc",  ".usdz", ".vrm",      ".wrl",  ".x3d",  ".xyz",  ".csv",  ".gz",   ".htm",  ".html", ".js",    ".json",
    ".jsonl", ".md",   ".markdown", ".pdb",  ".tar",  ".toml", ".txt",  ".xml",  ".yaml", ".yml",  ".zip",   ".zst"};

/// Of files that are written under another name than they get in the end, or that keep what was there.
constexpr std::string_view kPassing[] = {".tmp", ".temp", ".part", ".partial", ".new",  ".out",  ".data",
                                         ".bak", ".old",  ".orig", ".next",    ".test", ".work", ".asset"};

bool is_among(std::string_view extension, std::span<const std::string_view> known) {
  return std::find(known.begin(), known.end(), extension) != known.end();
}

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return extension;
}

/// "scene.v2", "cut-0.001", "a.lode.4711", and the names of mktemp.
bool names_no_format(const std::string& path, std::string_view extension) {
  if (extension.size() < 2 || is_among(extension, kPassing)) return true;
  if (std::filesystem::path(path).filename().string().starts_with("tmp.")) return true;
  const std::string_view number = extension.substr(extension[1] == 'v' && extension.size() > 2 ? 2 : 1);
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

Error wrong_name(const char* option, const std::string& path, const std::string& extension,
                 std::span<const std::string_view> formats) {
  const std::string name = printable(path, 200);
  if (formats.empty()) {
    return {ErrorCode::kUsage, option, "does not write " + extension + " file (got '" + name + "')"};
  }
  const std::string wanted(formats.front());
  return {ErrorCode::kUsage, option,
          "writes a " + wanted + " file, not a " + extension + " file (got '" + name +
              "'); choose a name that ends in " + wanted};
}

}  // namespace

Status check_output_name(const char* option, const std::string& path, std::string_view format) {
  const std::string extension = extension_of(path);
  if (extension == format || names_no_format(path, extension)) return Ok{};
  return wrong_name(option, path, printable(extension, 64), {&format, 1});
}

Status check_text_name(const char* option, const std::string& path, std::initializer_list<std::string_view> formats) {
  const std::string extension = extension_of(path);
  const std::span<const std::string_view> known(formats.begin(), formats.size());
  if (!is_among(extension, kNamed) || is_among(extension, known)) return Ok{};
  if (known.empty() && extension == ".txt") return Ok{};
  return wrong_name(option, path, extension, known);
}

}  // namespace meshlode::cli
