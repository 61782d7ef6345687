// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/asset_tables.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/try.h"
#include "builder/write/instance_scale.h"
#include "format/page_hint.h"

namespace meshlode::builder {

namespace {

std::uint32_t count32(std::size_t count) {
  return static_cast<std::uint32_t>(count);
}

Error limit_error(std::string where, std::string detail) {
  return {ErrorCode::kBuildFailed, std::move(where), std::move(detail)};
}

void append_mesh(EncodedMesh& mesh, const std::string& name, std::uint32_t promises, AssetTables& out) {
  const auto mesh_id = count32(out.meshes.size());
  const auto first_group = count32(out.groups.size());
  const auto first_cluster = count32(out.clusters.size());
  const auto first_node = count32(out.nodes.size());
  const auto first_page = count32(out.pages.size());
  format::MeshRecord record = mesh.record;
  record.name = out.strings.add(name);
  record.first_group = first_group;
  record.first_cluster = first_cluster;
  record.first_node = first_node;
  out.meshes.push_back(record);

  for (format::GroupRecord group : mesh.groups) {
    group.first_cluster += first_cluster;
    group.mesh = mesh_id;
    group.page += first_page;
    out.groups.push_back(group);
  }
  for (format::ClusterRecord cluster : mesh.clusters) {
    if (cluster.own_group != format::kNone) cluster.own_group += first_group;
    cluster.coarser_group += first_group;
    out.clusters.push_back(cluster);
  }
  for (format::NodeRecord node : mesh.nodes) {
    node.first += node.child_count == 0 ? first_group : first_node;
    out.nodes.push_back(node);
  }
  if (promises != 0) {
    format::PromiseMeshRecord promise = mesh.promise;
    promise.promises = promises;
    out.promises.push_back(promise);
    out.promise_errors.insert(out.promise_errors.end(), mesh.promise_errors.begin(), mesh.promise_errors.end());
  }
  for (EncodedMesh::Page& page : mesh.pages) {
    format::PageRecord page_record{};
    page_record.bytes = count32(page.bytes.size());
    page_record.first_group = page.first_group + first_group;
    page_record.group_count = page.group_count;
    page_record.first_cluster = page.first_cluster + first_cluster;
    page_record.cluster_count = page.cluster_count;
    page_record.first_dependency = count32(out.page_dependencies.size());
    page_record.dependency_count = count32(page.dependencies.size());
    for (const std::uint32_t needed : page.dependencies) out.page_dependencies.push_back(needed + first_page);
    const format::PageHeader header{page_record.first_cluster, page_record.cluster_count};
    std::memcpy(page.bytes.data(), &header, sizeof(header));
    out.pages.push_back(page_record);
    out.page_bytes.push_back(std::move(page.bytes));
  }
}

format::MaterialRecord material_record(const scene::SceneMaterial& material, StringTable& strings) {
  format::MaterialRecord record{};
  record.name = strings.add(material.name);
  record.source_index = material.source_index;
  record.alpha_mode = static_cast<format::AlphaMode>(material.alpha_mode);
  for (int i = 0; i < 4; ++i) record.base_color[i] = material.base_color[i];
  record.alpha_cutoff = material.alpha_cutoff;
  record.double_sided = material.double_sided ? 1U : 0U;
  record.base_color_texture = material.base_color_texture;
  record.base_color_uv_set = material.base_color_uv_set;
  return record;
}

format::InstanceRecord instance_record(const scene::SceneInstance& instance, StringTable& strings) {
  format::InstanceRecord record{};
  const InstanceScale scale = measure_instance(instance.transform);
  // A transform that is not finite is never drawn; zeros keep the file free of values that no reader accepts.
  const bool is_drawable = scale.largest > 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      record.transform[4 * row + column] = is_drawable ? instance.transform[column][row] : 0.0;
    }
  }
  record.scale = scale.largest;
  record.flags = scale.flags;
  record.mesh = instance.mesh.value;
  record.node = instance.node;
  record.name = strings.add(instance.name);
  return record;
}

format::BlobRecord blob_record(const scene::SceneBlob& blob, StringTable& strings) {
  format::BlobRecord record{};
  record.name = strings.add(blob.name);
  record.mime_type = strings.add(blob.mime_type);
  record.bytes = blob.bytes.size();
  record.kind = blob.kind == scene::SceneBlob::Kind::kImage ? format::BlobKind::kImage : format::BlobKind::kBuffer;
  record.source_index = blob.source_index;
  record.checksum = hash64(blob.bytes);
  return record;
}

Status check_counts(const WriteInput& input) {
  if (input.scene == nullptr) return limit_error("write", "no scene was given");
  if (input.mesh_names.size() != input.meshes.size()) return limit_error("write", "each mesh needs a name");
  std::uint64_t clusters = 0;
  std::uint64_t nodes = 0;
  for (const EncodedMesh& mesh : input.meshes) {
    if (input.promises != 0 && mesh.promise_errors.size() != mesh.groups.size()) {
      return limit_error("write", "a mesh lacks the errors of what is promised");
    }
    clusters += mesh.clusters.size();  // every other table is shorter: groups, pages and dependencies hang on clusters
    nodes += mesh.nodes.size();
  }
  const std::uint64_t limit = std::numeric_limits<std::uint32_t>::max() / 2;
  if (clusters >= limit || nodes >= limit) return limit_error("write", "more than 2^31 clusters");
  for (std::size_t i = 0; i < input.scene->instances.size(); ++i) {
    if (input.scene->instances[i].mesh.value >= input.meshes.size()) {
      return limit_error("instance " + std::to_string(i), "names a mesh that is not there");
    }
  }
  return Ok{};
}

}  // namespace

format::StringRef StringTable::add(const std::string& text) {
  if (text.empty()) return {0, 0};
  const auto known = refs_.find(text);
  if (known != refs_.end()) return known->second;
  const format::StringRef ref{count32(bytes_.size()), count32(text.size())};
  bytes_ += text;
  refs_.emplace(text, ref);
  return ref;
}

std::uint32_t version_of(const AssetTables& tables) {
  return has_aggregates(tables.groups) ? format::kVersion : format::kPlainVersion;
}

Result<AssetTables> make_tables(WriteInput& input) {
  TRY(check_counts(input));
  AssetTables out;
  for (std::size_t m = 0; m < input.meshes.size(); ++m) {
    append_mesh(input.meshes[m], input.mesh_names[m], input.promises, out);
  }
  for (const scene::SceneMaterial& material : input.all_materials()) {
    out.materials.push_back(material_record(material, out.strings));
  }
  for (const scene::SceneInstance& instance : input.scene->instances) {
    out.instances.push_back(instance_record(instance, out.strings));
  }
  for (const scene::SceneBlob& blob : input.all_blobs()) out.blobs.push_back(blob_record(blob, out.strings));
  if (input.has_page_hints) {
    for (const format::PageRecord& page : out.pages) {
      out.page_hints.push_back(
          format::make_page_hint(std::span(out.groups).subspan(page.first_group, page.group_count)));
    }
  }
  parallel_for_each_index(out.pages.size(), 4,
                          [&](std::size_t p) { out.pages[p].decoded_checksum = hash64(out.page_bytes[p]); });
  if (out.strings.bytes().size() >= std::numeric_limits<std::uint32_t>::max()) {
    return limit_error("write", "more than 4 GiB of names");
  }
  return out;
}

}  // namespace meshlode::builder
