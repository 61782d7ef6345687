// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/depend/dependencies.h"

#include <sys/stat.h>
#include <algorithm>

#include "base/try.h"
#include "scene/import/import.h"

namespace meshlode::app {

namespace {

std::int64_t nanoseconds(const struct timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FileStamp{{static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino)},
                   static_cast<std::uint64_t>(info.st_size),
                   nanoseconds(info.st_mtim),
                   nanoseconds(info.st_ctim)};
}

FileKind kind_of(scene::FileReference::Kind kind) {
  using Kind = scene::FileReference::Kind;
  return kind == Kind::kImage ? FileKind::kImage : kind == Kind::kBuffer ? FileKind::kBuffer : FileKind::kMaterials;
}

/// Looks at the stamp first: what is written while it is hashed has another one afterwards.
Status look_at(Dependency& file) {
  file.stamp = stamp_of(file.path);
  const auto mapped = MappedFile::open(file.path);
  if (!mapped) {
    file.stamp.reset();
    return mapped.error();
  }
  file.hash = hash128(mapped->bytes());
  return Ok{};
}

}  // namespace

const char* name_of(FileKind kind) {
  switch (kind) {
    case FileKind::kScene: return "scene";
    case FileKind::kBuffer: return "buffer";
    case FileKind::kImage: return "image";
    case FileKind::kMaterials: return "materials";
    case FileKind::kSettings: break;
  }
  return "settings";
}

Result<Dependency> find_file(FileKind kind, const std::filesystem::path& path) {
  Dependency file{kind, path.filename().string(), path, std::nullopt, {}};
  TRY(look_at(file));
  return file;
}

Result<std::vector<Dependency>> find_dependencies(const std::filesystem::path& scene,
                                                  std::span<const std::filesystem::path> allow_outside) {
  std::vector<Dependency> files;
  TRY_LET(own, find_file(FileKind::kScene, scene));
  files.push_back(std::move(*own));
  TRY_LET(references, scene::list_references(scene, allow_outside));
  for (const scene::FileReference& reference : *references) {
    files.push_back({kind_of(reference.kind), reference.uri, reference.path, std::nullopt, {}});
    static_cast<void>(look_at(files.back()));  // what is missing is the import's to judge
  }
  return files;
}

bool are_unchanged(std::span<const Dependency> dependencies) {
  return std::all_of(dependencies.begin(), dependencies.end(),
                     [](const Dependency& file) { return stamp_of(file.path) == file.stamp; });
}

bool cover(std::span<const Dependency> dependencies, std::span<const FileId> files) {
  return std::all_of(files.begin(), files.end(), [&](const FileId& id) {
    return std::any_of(dependencies.begin(), dependencies.end(),
                       [&](const Dependency& file) { return file.stamp && file.stamp->id == id; });
  });
}

}  // namespace meshlode::app
