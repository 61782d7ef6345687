// SPDX-License-Identifier: MIT
// Read: an asset's tables as validated, zero-copy views. Opening checks every offset, count, range and id once, so that
// code behind this line may index without checks (I11). Pages are checked when they are loaded (unpack, decode).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "base/file.h"
#include "base/ids.h"
#include "run/read/limits.h"

namespace meshlode::run {

/// Immutable. What it holds is shared by with_promise(), so that an asset by another promise costs its own errors
/// alone.
class Asset {
 public:
  /// Maps the file. Errors: kIo; kInvalid with the place in the file; kUnsupported for a newer version or an unknown
  /// required section, and where sections decode to more than decoded_limit() of the file's size and `max_decoded`.
  [[nodiscard]] static Result<Asset> open(const std::filesystem::path& path,
                                          std::uint64_t max_decoded = kDefaultMaxDecoded);
  /// Views `bytes`, which must outlive the asset and be aligned to 8 bytes.
  [[nodiscard]] static Result<Asset> from_bytes(std::span<const std::uint8_t> bytes);
  /// Takes the bytes.
  [[nodiscard]] static Result<Asset> from_vector(std::vector<std::uint8_t> bytes);

  /// Views the head of a file of `file_bytes`: at least all bytes before its pages and images (find_head, sections.h),
  /// which must outlive the asset and be aligned to 8 bytes. What lies behind them is not looked at, and is not there:
  /// stored_page() and blob_bytes() are empty. Errors: as above; kUnsupported where tables lie behind pages or images.
  [[nodiscard]] static Result<Asset> from_head(std::span<const std::uint8_t> bytes, std::uint64_t file_bytes);
  /// Takes the bytes.
  [[nodiscard]] static Result<Asset> from_head(std::vector<std::uint8_t> bytes, std::uint64_t file_bytes);
  /// False of a head.
  [[nodiscard]] bool has_body() const { return has_body_; }

  /// The file that open() mapped; nothing for bytes.
  [[nodiscard]] std::optional<FileId> file_id() const;

  [[nodiscard]] const format::FileHeader& header() const { return *header_; }
  [[nodiscard]] std::span<const format::SectionEntry> sections() const { return sections_; }
  [[nodiscard]] std::span<const format::MeshRecord> meshes() const { return meshes_; }
  [[nodiscard]] std::span<const format::MaterialRecord> materials() const { return materials_; }
  [[nodiscard]] std::span<const format::InstanceRecord> instances() const { return instances_; }
  [[nodiscard]] std::span<const format::GroupRecord> groups() const { return groups_; }
  [[nodiscard]] std::span<const format::ClusterRecord> clusters() const { return clusters_; }
  [[nodiscard]] std::span<const format::NodeRecord> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const format::PageRecord> pages() const { return pages_; }
  [[nodiscard]] std::span<const std::uint32_t> page_dependencies() const { return page_dependencies_; }
  [[nodiscard]] std::span<const format::BlobRecord> blobs() const { return blobs_; }
  /// One a mesh, and one a group; empty where the asset promises positions alone (or has no mesh, or no group).
  [[nodiscard]] std::span<const format::PromiseMeshRecord> promises() const { return promises_; }
  [[nodiscard]] std::span<const format::PromiseGroupRecord> promise_errors() const { return promise_errors_; }
  /// One a page, of the errors of positions; empty where the file has none. Nothing holds them against the groups here.
  [[nodiscard]] std::span<const format::PageHintRecord> page_hints() const { return page_hints_; }
  /// Whether with_promise() will do: positions always, else where the asset was built to promise it or more.
  [[nodiscard]] bool has_promise(format::Promise promise) const;
  /// The same asset, whose `error` of groups() and nodes(), and `level0_deviation` of meshes(), are those of this
  /// promise, so that whoever selects by them keeps it (docs/reference/selection.md). What the file holds is the same:
  /// section_bytes(), bytes(), content hash. It may outlive this one.
  /// Error: kUnsupported where the asset does not promise it, with how to build one that does.
  [[nodiscard]] Result<Asset> with_promise(format::Promise promise) const;
  /// That of with_promise(); kPosition of an asset as it was opened.
  [[nodiscard]] format::Promise promise() const { return promise_; }
  [[nodiscard]] std::string_view meta_json() const { return meta_; }
  [[nodiscard]] std::string_view scene_json() const { return scene_; }
  [[nodiscard]] std::string_view strings() const { return strings_; }  ///< what StringRef points into
  [[nodiscard]] std::string_view string(format::StringRef ref) const { return strings_.substr(ref.offset, ref.bytes); }
  [[nodiscard]] std::span<const std::uint8_t> blob_bytes(const format::BlobRecord& blob) const;
  [[nodiscard]] std::span<const std::uint8_t> stored_page(PageId page) const;   ///< as on disk
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }  ///< the whole file, or its head
  /// What whoever decodes the asset as a whole may take for it.
  [[nodiscard]] std::uint64_t max_decoded_bytes() const { return decoded_limit(bytes_.size(), max_decoded_); }
  /// The decoded bytes of one of sections() that is known; PAGE and BLOB as they are stored.
  [[nodiscard]] std::span<const std::uint8_t> section_bytes(const format::SectionEntry& entry) const;

 private:
  /// What the views point into; the caller's bytes have no storage here.
  struct Owned {
    std::variant<std::monostate, MappedFile, std::vector<std::uint8_t>> storage;
    /// Of sections that are stored by columns, by their offset in the file; the others are viewed where they lie.
    std::map<std::uint64_t, std::vector<std::uint8_t>> decoded;
  };
  /// The tables that hold errors, as the file has them, and those of a promise besides positions.
  struct ErrorViews {
    std::span<const format::MeshRecord> meshes;
    std::span<const format::GroupRecord> groups;
    std::span<const format::NodeRecord> nodes;
  };
  struct PromiseErrors {
    std::vector<format::MeshRecord> meshes;
    std::vector<format::GroupRecord> groups;
    std::vector<format::NodeRecord> nodes;
  };

  Asset() = default;
  [[nodiscard]] Status index(std::uint64_t file_bytes);
  [[nodiscard]] Status index() { return index(bytes_.size()); }
  [[nodiscard]] Status index_head(std::uint64_t file_bytes);

  std::shared_ptr<Owned> owned_ = std::make_shared<Owned>();  ///< written while it is opened alone
  std::span<const std::uint8_t> bytes_;
  bool has_body_ = true;
  std::uint64_t max_decoded_ = kDefaultMaxDecoded;
  const format::FileHeader* header_ = nullptr;
  std::span<const format::SectionEntry> sections_;
  std::span<const format::MeshRecord> meshes_;
  std::span<const format::MaterialRecord> materials_;
  std::span<const format::InstanceRecord> instances_;
  std::span<const format::GroupRecord> groups_;
  std::span<const format::ClusterRecord> clusters_;
  std::span<const format::NodeRecord> nodes_;
  std::span<const format::PageRecord> pages_;
  std::span<const std::uint32_t> page_dependencies_;
  std::span<const format::BlobRecord> blobs_;
  std::span<const format::PromiseMeshRecord> promises_;
  std::span<const format::PromiseGroupRecord> promise_errors_;
  std::span<const format::PageHintRecord> page_hints_;
  std::string_view meta_, scene_, strings_;
  format::Promise promise_ = format::Promise::kPosition;
  ErrorViews stored_;
  std::shared_ptr<const PromiseErrors> errors_;  ///< null: meshes_, groups_ and nodes_ are stored_
};

}  // namespace meshlode::run
