// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/jobs/weigh.h"

#include <system_error>

#include "scene/import/import.h"

namespace meshlode::app {

namespace {

std::uint64_t size_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return error ? std::uint64_t{0} : std::uint64_t{size};
}

}  // namespace

std::uint64_t weigh_scene(const std::filesystem::path& scene) {
  std::uint64_t bytes = 1 + size_of(scene);
  // The others hold their geometry themselves, and looking for names would mean reading it.
  if (scene.extension() != ".gltf" && scene.extension() != ".GLTF") return bytes;
  if (const auto references = scene::list_references(scene)) {
    for (const scene::FileReference& reference : *references) bytes += size_of(reference.path);
  }
  return bytes;
}

}  // namespace meshlode::app
