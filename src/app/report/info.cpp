// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/info.h"

#include <algorithm>
#include <map>
#include <span>

#include "base/image_size.h"

namespace meshlode::app {

namespace {

/// Pages and the tables that a renderer needs to draw them.
bool is_geometry(std::uint32_t id) {
  using format::SectionId;
  switch (static_cast<SectionId>(id)) {
    case SectionId::kMeshes:
    case SectionId::kGroups:
    case SectionId::kClusters:
    case SectionId::kNodes:
    case SectionId::kPages:
    case SectionId::kPageDeps:
    case SectionId::kPromises:
    case SectionId::kPromiseErrors:
    case SectionId::kPageHints:
    case SectionId::kPageData: return true;
    default: return false;
  }
}

MeshInfo describe_mesh(const run::Asset& asset, std::uint32_t mesh_id, std::uint32_t cap) {
  const format::MeshRecord& mesh = asset.meshes()[mesh_id];
  MeshInfo info;
  info.levels.resize(mesh.level_count);
  for (std::uint32_t i = 0; i < mesh.level_count; ++i) info.levels[i].level = i;
  std::vector<std::uint64_t> group_triangles(mesh.group_count, 0);

  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[c];
    info.clusters += 1;
    info.triangles += cluster.triangle_count();
    info.vertices += cluster.vertex_count();
    const format::GroupRecord& coarser = asset.groups()[cluster.coarser_group];
    if ((coarser.flags & format::kGroupTerminal) != 0) {
      info.roots += 1;
      info.root_triangles += cluster.triangle_count();
    }
    group_triangles[cluster.coarser_group - mesh.first_group] += cluster.triangle_count();
    if (cluster.level >= info.levels.size()) continue;  // validate reports it
    LevelInfo& level = info.levels[cluster.level];
    const float error = cluster.own_group == format::kNone ? 0.0F : asset.groups()[cluster.own_group].error;
    level.error_min = level.clusters == 0 ? error : std::min(level.error_min, error);
    level.error_max = level.clusters == 0 ? error : std::max(level.error_max, error);
    if (cluster.own_group != format::kNone) {
      const format::GroupRecord& own = asset.groups()[cluster.own_group];
      level.normal_deviation_max = std::max(level.normal_deviation_max, own.normal_deviation);
      level.uv_deviation_max = std::max(level.uv_deviation_max, own.uv_deviation);
    }
    level.clusters += 1;
    level.triangles += cluster.triangle_count();
    level.vertices += cluster.vertex_count();
    level.full_clusters += cluster.triangle_count() >= cap ? 1U : 0U;
  }
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
    const format::GroupRecord& group = asset.groups()[g];
    const bool is_listed = (group.flags & format::kGroupStuck) != 0;
    const bool is_stuck = is_listed && group.stuck_reason != format::StuckReason::kBorder;
    info.stuck_groups += is_stuck ? 1U : 0U;
    if (is_listed) {
      info.stuck.push_back(
          {mesh_id, g, group.level, group.stuck_reason, group.cluster_count, group_triangles[g - mesh.first_group]});
    }
    if (group.level >= info.levels.size()) continue;
    info.levels[group.level].groups += 1;
    info.levels[group.level].stuck_groups += is_stuck ? 1U : 0U;
  }
  for (LevelInfo& level : info.levels) {
    if (level.clusters > 0) {
      level.fill = static_cast<double>(level.triangles) / (static_cast<double>(level.clusters) * cap);
    }
  }
  return info;
}

/// Sizes that META states are not trusted: as large as an image may be, and sums that wrap around do no harm.
constexpr std::uint32_t kMostSourceSide = 1U << 20U;

void describe_images(const run::Asset& asset, AssetInfo& info) {
  std::map<std::uint64_t, const MetaInfo::SourceImage*> sources;
  for (const MetaInfo::SourceImage& source : info.meta.source_images) sources.emplace(source.blob, &source);
  for (std::uint32_t i = 0; i < asset.blobs().size(); ++i) {
    const format::BlobRecord& blob = asset.blobs()[i];
    if (blob.kind != format::BlobKind::kImage) continue;
    ImageInfo& image = info.images.emplace_back();
    image.blob = i;
    const std::span<const std::uint8_t> bytes = asset.blob_bytes(blob);
    if (const auto size = read_image_size(bytes)) {
      image.width = size->width;
      image.height = size->height;
    }
    image.gpu_bytes = find_gpu_bytes(bytes);
    if (const auto source = sources.find(i); source != sources.end()) {
      image.source = *source->second;
      const std::uint32_t width = std::min(image.source->width, kMostSourceSide);
      const std::uint32_t height = std::min(image.source->height, kMostSourceSide);
      if (width > 0 && height > 0) image.source_gpu_bytes = gpu_bytes_of({width, height});
    }
    info.image_bytes += blob.bytes;
    info.image_gpu_bytes += image.gpu_bytes.value_or(0);
    info.source_image_bytes += image.source ? image.source->bytes : blob.bytes;
    info.source_image_gpu_bytes += image.source ? image.source_gpu_bytes : image.gpu_bytes.value_or(0);
  }
}

}  // namespace

AssetInfo describe_asset(const run::Asset& asset) {
  AssetInfo info;
  info.meta = read_meta(asset.meta_json());
  info.cluster_cap = info.meta.cluster_triangles;
  if (info.cluster_cap == 0) {
    info.cluster_cap = 128;
    for (const format::ClusterRecord& cluster : asset.clusters()) {
      if (cluster.triangle_count() > info.cluster_cap) info.cluster_cap = format::kMaxClusterTriangles;
    }
  }
  for (const format::SectionEntry& section : asset.sections()) {
    if (is_geometry(section.id)) info.geometry_bytes += section.bytes;
  }
  describe_images(asset, info);
  const std::vector<std::size_t> origins = origins_of_meshes(info.meta, asset.meshes().size());
  for (std::uint32_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    MeshInfo one = describe_mesh(asset, m, info.cluster_cap);
    if (origins[m] != m) one.part_of = origins[m];
    info.source_triangles += mesh.source_triangles;
    info.source_vertices += mesh.source_vertices;
    info.stored_triangles += one.triangles;
    info.stored_vertices += one.vertices;
    info.levels = std::max<std::uint64_t>(info.levels, mesh.level_count);
    info.roots += one.roots;
    info.max_roots_per_mesh = std::max(info.max_roots_per_mesh, one.roots);
    info.stuck_groups += one.stuck_groups;
    info.border_groups += one.stuck.size() - one.stuck_groups;
    info.dropped_degenerate += mesh.dropped_degenerate;
    info.dropped_duplicate += mesh.dropped_duplicate;
    info.dropped_repaired += mesh.dropped_repaired;
    info.meshes.push_back(std::move(one));
  }
  return info;
}

std::string section_name(std::uint32_t id) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((id >> (8 * i)) & 0xFFU);
    name += c >= 0x20 && c < 0x7F ? c : '?';
  }
  return name;
}

std::uint64_t section_decoded_bytes(const run::Asset& asset, const format::SectionEntry& section) {
  if (section.id != static_cast<std::uint32_t>(format::SectionId::kPageData)) return section.decoded_bytes;
  std::uint64_t bytes = section.bytes;  // pages have codecs of their own
  for (const format::PageRecord& page : asset.pages()) bytes += std::uint64_t{page.bytes} - page.stored_bytes;
  return bytes;
}

}  // namespace meshlode::app
