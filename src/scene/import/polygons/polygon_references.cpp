// SPDX-License-Identifier: GPL-3.0-or-later
// The files that an OBJ or a PLY names, without opening more than an OBJ's libraries.
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "base/file.h"
#include "scene/import/polygons/obj_materials.h"
#include "scene/import/polygons/ply_header.h"
#include "scene/import/polygons/read_mtl.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

class ReferenceList {
 public:
  ReferenceList(std::filesystem::path folder, std::span<const std::filesystem::path> allow_outside)
      : folder_(std::move(folder)), allow_outside_(allow_outside) {}

  /// The line of a mtllib: one name with blanks, or several. Where the one is not there, another may be some day.
  void add_libraries(std::string_view line) {
    if (add_library(std::string(unquoted(line)))) return;
    for (std::string_view name = take_name(line); !name.empty(); name = take_name(line)) {
      add_library(std::string(name));
    }
  }

  void add_image(const std::string& name) { add(Kind::kImage, name); }

  [[nodiscard]] std::vector<FileReference> take() { return std::move(references_); }

 private:
  using Kind = FileReference::Kind;

  /// \returns where it is; nothing where it is not, or may not be opened
  std::optional<std::filesystem::path> add(Kind kind, const std::string& name) {
    auto resolved = resolve_named(folder_, name, allow_outside_);
    if (!resolved && resolved.error().code != ErrorCode::kIo) {
      // May not be opened, and is not: it is listed without a path, so that who may asks again.
      if (refused_.insert(name).second) references_.push_back({kind, name, {}});
      return std::nullopt;
    }
    const std::filesystem::path where = folder_ / std::filesystem::path(with_slashes(name)).lexically_normal();
    if (known_.insert(where).second) references_.push_back({kind, name, where});
    return resolved ? std::optional(std::move(*resolved)) : std::nullopt;
  }

  bool add_library(const std::string& name) {
    const auto path = add(Kind::kMaterials, name);
    if (!path) return false;
    const auto file = MappedFile::open(*path);
    if (!file) return false;
    for (const MtlMaterial& material : read_mtl(file->bytes()).materials) {
      for (const MtlMap* map : {&material.base_color, &material.alpha, &material.rough, &material.metal,
                                &material.normal, &material.emissive}) {
        if (!map->file.empty()) add_image(map->file);
      }
    }
    return true;
  }

  std::filesystem::path folder_;
  std::span<const std::filesystem::path> allow_outside_;
  std::set<std::filesystem::path> known_;
  std::set<std::string> refused_;
  std::vector<FileReference> references_;
};

}  // namespace

std::vector<FileReference> list_obj_references(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                                               std::span<const std::filesystem::path> allow_outside) {
  std::string_view text = text_of(bytes);
  std::set<std::string> known;
  std::vector<std::string> libraries;  // in the order of the import
  std::string joined;
  for (std::size_t lines = 0; !text.empty();) {
    std::string_view line = take_joined_line(text, joined, lines);
    if (take_word(line) != "mtllib" || trimmed(line).empty()) continue;
    if (known.emplace(trimmed(line)).second) libraries.emplace_back(trimmed(line));
  }
  ReferenceList list(path.parent_path(), allow_outside);
  for (const std::string& line : libraries) list.add_libraries(line);
  return list.take();
}

std::vector<FileReference> list_ply_references(const std::filesystem::path& path, std::span<const std::uint8_t> bytes,
                                               std::span<const std::filesystem::path> allow_outside) {
  std::string_view text = text_of(bytes);
  const auto header = take_ply_header(text);
  if (!header) return {};
  ReferenceList list(path.parent_path(), allow_outside);
  for (const std::string& name : header->textures) list.add_image(name);
  return list.take();
}

}  // namespace meshlode::scene
