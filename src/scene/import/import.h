// SPDX-License-Identifier: GPL-3.0-or-later
// Import: a file on disk becomes a validated Scene, or one error that names file, JSON path and reason.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"
#include "scene/scene.h"

namespace meshlode::scene {

struct ImportOptions {
  /// Drop (and count) triangles that touch non-finite positions or indices out of range, then repair_scene
  /// (scene/repair/repair.h).
  bool repair = false;
  /// glTF: the name or else the index of the scene that is instanced, or "all"; empty: the file's default.
  std::string scene{};
  std::vector<FileId>* files_read = nullptr;  ///< gets every file that was opened, also where the import fails
  /// Bytes of indices and vertices that compressed geometry may take beyond what its own size justifies.
  std::uint64_t max_decoded = std::uint64_t{512} << 20U;
  /// An image that cannot be read (its file is missing, or lies where nothing may be opened; its data URI is broken),
  /// and a library of an OBJ's materials, is left out and said so (Scene::left_out), for geometry does not need it;
  /// else it is an error, as it always is of a buffer.
  bool may_lack_images = false;
  /// Folders beside the scene's own from which files may be opened that the scene names; links that leave all of them
  /// are not followed.
  std::vector<std::filesystem::path> allow_outside{};
  /// Colours of PLY and STL that are levels (whole numbers) are taken as linear, not as sRGB.
  bool linear_colors = false;
};

/// Reads .gltf, .glb, .ply, .obj or .stl (told apart by content where possible, else by extension).
/// Errors: kIo the file (or one it refers to) cannot be read; kInvalid it breaks its format; kUnsupported it requires a
/// geometry extension that is not known; kUsage there is no such scene.
[[nodiscard]] Result<Scene> import_scene(const std::filesystem::path& path, const ImportOptions& options);

/// What import_scene reads such a file as: "GLB", "glTF", "PLY", "OBJ" or "STL"; empty where it refuses it unread.
[[nodiscard]] std::string_view find_format_name(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// A file that a scene names.
struct FileReference {
  /// Materials are an OBJ's libraries, which it can do without.
  enum class Kind : std::uint8_t { kBuffer, kImage, kMaterials };
  Kind kind = Kind::kBuffer;
  std::string uri;  ///< as the scene, or its library, has it
  /// To open it by, whether or not there is such a file; links not followed. Empty: import opens no file for it, such
  /// as an image outside the scene's folder or on the web.
  std::filesystem::path path;
};

/// Every file that import_scene opens, or would open were it there, beside the scene's own: each path once, in the
/// order of import. Reads the scene's text and looks for the files, but opens none. Errors: as import_scene, as far as
/// it looks; what it finds nothing wrong with may still be refused there.
/// `allow_outside`: ImportOptions'.
[[nodiscard]] Result<std::vector<FileReference>> list_references(
    const std::filesystem::path& path, std::span<const std::filesystem::path> allow_outside = {});

}  // namespace meshlode::scene
