// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF file on its way to a Scene: its text as a checked tree and as tinygltf's model, its buffers as mapped bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/ids.h"
#include "scene/import/gltf/tinygltf.h"
#include "scene/import/json.h"
#include "scene/scene.h"

namespace meshlode::scene {

/// Of glTF text, the file's and what tinygltf reads: it takes the length as an unsigned int, and keeps indices, counts
/// of sparse elements and their offsets in an int. A list in less text than this has fewer than 2^31 elements.
constexpr std::uint64_t kMaxTextBytes = 0x7FFFFFFFu;

/// glTF's componentType values.
enum GltfComponent : std::uint32_t {
  kGltfByte = 5120,
  kGltfUnsignedByte = 5121,
  kGltfShort = 5122,
  kGltfUnsignedShort = 5123,
  kGltfUnsignedInt = 5125,
  kGltfFloat = 5126
};

/// Bytes of one component, 0 for a value that is none of glTF's.
[[nodiscard]] std::uint32_t component_size(std::uint64_t component_type);

/// Files and data URIs, each opened and hashed once, in the order in which they are asked for.
class GltfFiles {
 public:
  /// `files_read`, where given, gets every file that is opened.
  explicit GltfFiles(std::filesystem::path folder, std::vector<FileId>* files_read,
                     std::vector<std::filesystem::path> allow_outside)
      : folder_(std::move(folder)), files_read_(files_read), allow_outside_(std::move(allow_outside)) {}
  /// The bytes of a URI; they live as long as this object.
  [[nodiscard]] Result<std::span<const std::uint8_t>> open(std::string_view uri);
  void hash(std::span<const std::uint8_t> bytes) { hasher_.update(bytes); }
  [[nodiscard]] std::string hash_hex() const { return to_hex(hasher_.digest()); }
  [[nodiscard]] std::uint64_t total_bytes() const { return total_bytes_; }

 private:
  std::filesystem::path folder_;
  std::vector<FileId>* files_read_;
  std::vector<std::filesystem::path> allow_outside_;
  std::map<std::string, std::size_t> by_path_;  ///< canonical path -> mapped_
  std::vector<MappedFile> mapped_;
  std::vector<std::vector<std::uint8_t>> decoded_;
  std::uint64_t total_bytes_ = 0;
  Hasher hasher_;
};

/// How much may be decoded: a bound that grows with the file, so that a small file cannot ask for gigabytes by naming
/// the same bytes again and again, or by a count that no byte stands behind (I11). Counted in vertices and indices.
/// A byte of Draco's or meshoptimizer's may stand for 60 of them, but only as long as they take less than `max_decoded`
/// bytes; beyond that the stream's size must justify them as that of other buffers does.
class DecodeBudget {
 public:
  static constexpr std::uint64_t kElementBytes = 24;  ///< of a position, the largest of them

  /// `compressed_bytes`: of the streams, at most as many as the files have.
  DecodeBudget(std::uint64_t file_bytes, std::uint64_t compressed_bytes, std::uint64_t max_decoded)
      : left_((std::uint64_t{1} << 20U) + 4 * file_bytes +
              std::min(60 * compressed_bytes, std::max(4 * compressed_bytes, max_decoded / kElementBytes))) {}
  [[nodiscard]] std::uint64_t left_bytes() const { return left_ * kElementBytes; }
  [[nodiscard]] bool take(std::uint64_t elements) {
    if (elements > left_) return false;
    left_ -= elements;
    return true;
  }

 private:
  std::uint64_t left_;
};

struct GltfAsset {
  std::string file;  ///< as named in messages
  Json root;         ///< checked; materials, extensions and what is carried through are read here
  /// Accessors and their views, meshes, nodes, scenes, skins and animations, as many of each as the tree has. All else
  /// is empty: buffers above all, materials, extensions and extras.
  tinygltf::Model model;
  std::vector<std::span<const std::uint8_t>> buffers;  ///< by buffer index; empty where a buffer has no data
  /// By view, where any is compressed (meshopt_views.h): the bytes that stand in the place of its buffer's.
  std::vector<std::vector<std::uint8_t>> decoded_views;
  bool has_every_scene = false;  ///< the default scene is one that choose_scene() made of all others

  /// "scene.gltf: /meshes/0": where an error lies.
  [[nodiscard]] Error error(ErrorCode code, const std::string& json_path, std::string detail) const {
    return {code, file + ": " + json_path, std::move(detail)};
  }
  [[nodiscard]] Error invalid(const std::string& json_path, std::string detail) const {
    return error(ErrorCode::kInvalid, json_path, std::move(detail));
  }
  /// The bytes of a buffer view. `json_path`: what names the view. Errors: its buffer has no data, kInvalid, or
  /// kUnsupported where an extension compresses the view. \pre the buffers are loaded
  [[nodiscard]] Result<std::span<const std::uint8_t>> view_bytes(std::size_t view, const std::string& json_path) const;
};

/// Checks types, ranges, indices, bounds and cycles of everything that is read later: after this nothing can point
/// outside the text or outside the lengths that the buffers state. `file` is named in errors.
/// Errors: kInvalid, and kUnsupported for another major version or an unknown required extension.
[[nodiscard]] Status check_gltf(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_extensions(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_accessors(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_nodes(const Json& root, const std::string& file);
/// \pre check_gltf_accessors passed. Errors: kInvalid; kUnsupported for a mode or filter that is not known.
[[nodiscard]] Status check_gltf_meshopt(const Json& root, const std::string& file);
/// Optional extensions that geometry would be lost without. \pre the other checks passed. Errors: kUnsupported.
[[nodiscard]] Status check_gltf_lost_geometry(const Json& root, const std::string& file);

/// What common writers get wrong and every viewer shows, put right in a checked tree and named: a node that a scene
/// lists below others that no scene shows becomes a root; an interpolation of 0 is taken out.
void mend_gltf(Json& root, std::vector<LeftOut>& left_out);

/// tinygltf's model of a checked tree; nothing that it would open is handed to it. What it has no number for is -1.
/// Errors: kInvalid and kUnsupported, without a place.
[[nodiscard]] Result<tinygltf::Model> read_gltf_model(const Json& root);

}  // namespace meshlode::scene
