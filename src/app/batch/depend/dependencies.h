// SPDX-License-Identifier: GPL-3.0-or-later
// The files that an asset is made from: the scene's own and every one that it names, with what is in them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"
#include "base/hash.h"

namespace meshlode::app {

enum class FileKind : std::uint8_t { kScene, kBuffer, kImage, kMaterials, kSettings };
[[nodiscard]] const char* name_of(FileKind kind);

/// Tells whether a file was written since: of this machine alone.
struct FileStamp {
  FileId id;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  ///< mtime and ctime since 1970
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

struct Dependency {
  FileKind kind = FileKind::kScene;
  std::string name;                ///< as the scene has it; of the scene its file name
  std::filesystem::path path;      ///< to open it by; empty: it may not be opened, wherever it is
  std::optional<FileStamp> stamp;  ///< nothing: it cannot be opened
  Hash128 hash{};                  ///< of its bytes; zeros where it cannot be opened
};

/// The scene first, then in the order of import, each file once. Errors: as scene::list_references; kIo the scene
/// itself cannot be opened. `allow_outside`: scene::ImportOptions'.
[[nodiscard]] Result<std::vector<Dependency>> find_dependencies(
    const std::filesystem::path& scene, std::span<const std::filesystem::path> allow_outside = {});

/// One file beside these. Errors: kIo it cannot be opened.
[[nodiscard]] Result<Dependency> find_file(FileKind kind, const std::filesystem::path& path);

/// Whether every file is still as it was when it was hashed, those included that were missing.
[[nodiscard]] bool are_unchanged(std::span<const Dependency> dependencies);

/// Whether all of these files are among the dependencies.
[[nodiscard]] bool cover(std::span<const Dependency> dependencies, std::span<const FileId> files);

}  // namespace meshlode::app
