// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF file on its way to a Scene: its text as a checked tree, its buffers as mapped bytes, its geometry as structs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"
#include "base/hash.h"
#include "scene/import/json.h"

namespace meshlode::scene {

constexpr std::uint32_t kNoIndex = 0xFFFFFFFFu;

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

struct GltfBufferView {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0, length = 0;  ///< bytes
  std::uint32_t stride = 0;              ///< bytes, 0: tightly packed
};

struct GltfSparse {
  std::uint64_t count = 0;
  std::uint32_t index_view = 0, value_view = 0;
  std::uint64_t index_offset = 0, value_offset = 0;
  std::uint32_t index_type = 0;
};

struct GltfAccessor {
  std::uint32_t view = kNoIndex;  ///< none: all zero before the sparse part
  std::uint64_t offset = 0;
  std::uint64_t count = 0;
  std::uint32_t component_type = 0;
  std::uint32_t component_count = 1;  ///< 1 SCALAR … 4 VEC4; 4, 9, 16 for matrices
  bool normalized = false;
  std::optional<GltfSparse> sparse;
};

struct GltfPrimitive {
  std::map<std::string, std::uint32_t> attributes;
  std::uint32_t indices = kNoIndex;
  std::uint32_t material = kNoIndex;
  std::uint32_t mode = 4;
  std::size_t target_count = 0;
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
};

struct GltfNode {
  std::string name;
  std::uint32_t mesh = kNoIndex, skin = kNoIndex;
  std::vector<std::uint32_t> children;
  std::vector<double> matrix, translation, rotation, scale;  ///< empty where absent
};

/// What tinygltf makes of the geometry and the nodes.
struct GltfModel {
  std::vector<GltfBufferView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
};

/// Files and data URIs, each opened and hashed once, in the order in which they are asked for.
class GltfFiles {
 public:
  /// `files_read`, where given, gets every file that is opened.
  explicit GltfFiles(std::filesystem::path folder, std::vector<FileId>* files_read = nullptr)
      : folder_(std::move(folder)), files_read_(files_read) {}
  /// The bytes of a URI; they live as long as this object.
  [[nodiscard]] Result<std::span<const std::uint8_t>> open(const std::string& uri);
  void hash(std::span<const std::uint8_t> bytes) { hasher_.update(bytes); }
  [[nodiscard]] std::string hash_hex() const { return to_hex(hasher_.digest()); }
  [[nodiscard]] std::uint64_t total_bytes() const { return total_bytes_; }

 private:
  std::filesystem::path folder_;
  std::vector<FileId>* files_read_;
  std::map<std::string, std::size_t> by_path_;  ///< canonical path -> mapped_
  std::vector<MappedFile> mapped_;
  std::vector<std::vector<std::uint8_t>> decoded_;
  std::uint64_t total_bytes_ = 0;
  Hasher hasher_;
};

/// How much may be decoded: a bound that grows with the file, so that a small file cannot ask for gigabytes by naming
/// the same bytes again and again, or by a count that no byte stands behind (I11). Counted in vertices and indices.
/// A byte of Draco's may stand for 60 of them, but only as long as they take less than `max_decoded` bytes; beyond that
/// the stream's size must justify them as that of other buffers does.
class DecodeBudget {
 public:
  static constexpr std::uint64_t kElementBytes = 24;  ///< of a position, the largest of them

  DecodeBudget(std::uint64_t file_bytes, std::uint64_t draco_bytes, std::uint64_t max_decoded)
      : left_((std::uint64_t{1} << 20U) + 4 * file_bytes +
              std::min(60 * draco_bytes, std::max(4 * draco_bytes, max_decoded / kElementBytes))) {}
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
  Json root;
  GltfModel model;
  std::vector<std::span<const std::uint8_t>> buffers;  ///< by buffer index; empty where a buffer has no data

  /// "scene.gltf: /meshes/0": where an error lies.
  [[nodiscard]] Error error(ErrorCode code, const std::string& json_path, std::string detail) const {
    return {code, file + ": " + json_path, std::move(detail)};
  }
  [[nodiscard]] Error invalid(const std::string& json_path, std::string detail) const {
    return error(ErrorCode::kInvalid, json_path, std::move(detail));
  }
  /// To read from a view whose buffer has no data: where an extension compresses the view, that is what is not read.
  [[nodiscard]] Error no_data(std::uint32_t view, const std::string& json_path) const;
  /// The bytes of a buffer view. \pre the asset is checked and its buffers are loaded
  [[nodiscard]] std::span<const std::uint8_t> view_bytes(std::uint32_t view) const {
    const GltfBufferView& v = model.views[view];
    return buffers[v.buffer].subspan(v.offset, v.length);
  }
};

/// Checks types, ranges, indices, bounds and cycles of everything that is read later: after this nothing can point
/// outside the text or outside the lengths that the buffers state. `file` is named in errors.
/// Errors: kInvalid, and kUnsupported for another major version or an unknown required extension.
[[nodiscard]] Status check_gltf(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_extensions(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_accessors(const Json& root, const std::string& file);
[[nodiscard]] Status check_gltf_nodes(const Json& root, const std::string& file);
/// Optional extensions that geometry would be lost without. \pre the other checks passed. Errors: kUnsupported.
[[nodiscard]] Status check_gltf_lost_geometry(const Json& root, const std::string& file);

/// Geometry and nodes of a checked tree, through tinygltf. Nothing that tinygltf would open is handed to it.
[[nodiscard]] Result<GltfModel> parse_gltf_model(const Json& root);

}  // namespace meshlode::scene
