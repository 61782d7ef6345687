// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/jobs/find_inputs.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "app/batch/jobs/glob.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

bool is_input_file(const fs::path& path, InputKind kind) {
  constexpr std::array kSceneExtensions{".gltf", ".glb", ".ply", ".obj", ".stl"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (kind != InputKind::kScenes && extension == ".lode") return true;
  return kind != InputKind::kAssets &&
         std::find(kSceneExtensions.begin(), kSceneExtensions.end(), extension) != kSceneExtensions.end();
}

/// In byte order of the paths, so that a batch runs the same way everywhere.
Result<std::vector<fs::path>> scan_folder(const fs::path& folder, InputKind kind) {
  std::vector<fs::path> found;
  std::error_code ec;
  for (fs::recursive_directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    std::error_code type_error;
    if (it->is_regular_file(type_error) && is_input_file(it->path(), kind)) found.push_back(it->path());
  }
  if (ec) return Error{ErrorCode::kIo, folder.string(), ec.message()};
  std::sort(found.begin(), found.end(), [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return found;
}

}  // namespace

bool is_pattern(const std::string& word) {
  std::error_code error;
  return has_wildcards(word) && !fs::exists(word, error);
}

Result<FoundInputs> find_inputs(const std::string& word, InputKind kind) {
  std::error_code error;
  if (fs::is_directory(word, error)) {
    TRY_LET(files, scan_folder(word, kind));
    return FoundInputs{word, std::move(*files)};
  }
  if (!is_pattern(word)) return FoundInputs{{}, {word}};
  TRY_LET(matches, find_matches(word));
  FoundInputs found{matches->base, {}};
  for (const fs::path& file : matches->files) {
    if (is_input_file(file, kind)) found.files.push_back(file);
  }
  if (!found.files.empty()) return found;
  return Error{ErrorCode::kIo, word,
               kind == InputKind::kScenes   ? "no scene matches this pattern"
               : kind == InputKind::kAssets ? "no asset matches this pattern"
                                            : "no scene and no asset matches this pattern"};
}

}  // namespace meshlode::app
