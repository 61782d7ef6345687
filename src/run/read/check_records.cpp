// SPDX-License-Identifier: MIT
// Meshes, materials, instances and blobs: records that stand alone.
#include <cmath>
#include <string>

#include "run/read/check_tables.h"
#include "run/read/file_place.h"

namespace meshlode::run {

namespace {

using format::SectionId;

constexpr std::int32_t kMinLog2 = -126;  ///< 2^log2 and everything on the grid are normal floats
constexpr std::int32_t kMaxLog2 = 104;
constexpr std::uint32_t kMaxGridMantissa = (1U << 24U) - 1U;
constexpr std::int32_t kMaxPosition = (1 << 23) - 1;

bool is_string(const RawTables& tables, format::StringRef ref) {
  return std::uint64_t{ref.offset} + ref.bytes <= tables.string_bytes;
}

/// A range of a mesh starts where the one before it ended and stays inside its table.
bool extends(std::uint32_t first, std::uint32_t count, std::uint64_t& end, std::size_t size) {
  if (first != end || count > size - end) return false;
  end += count;
  return true;
}

Status check_mesh_values(std::size_t m, const format::MeshRecord& mesh) {
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kMeshes, m, field, detail);
  };
  for (const double value : mesh.origin) {
    if (!std::isfinite(value)) return fail("origin", "is not finite");
  }
  if (mesh.grid.log2 < kMinLog2 || mesh.grid.log2 > kMaxLog2) return fail("grid.log2", "must be -126 to 104");
  if (mesh.grid.mantissa < 1 || mesh.grid.mantissa > kMaxGridMantissa) {
    return fail("grid.mantissa", "must be 1 to 2^24 - 1");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (mesh.bounds_min[axis] < -kMaxPosition) return fail("bounds_min", "needs more than 24 bits");
    if (mesh.bounds_max[axis] > kMaxPosition) return fail("bounds_max", "needs more than 24 bits");
    if (mesh.bounds_min[axis] > mesh.bounds_max[axis]) return fail("bounds_min", "is larger than bounds_max");
  }
  if (!std::isfinite(mesh.diagonal) || mesh.diagonal < 0.0) return fail("diagonal", "must be finite and not negative");
  if (!std::isfinite(mesh.level0_deviation) || mesh.level0_deviation < 0.0F) {
    return fail("level0_deviation", "must be finite and not negative");
  }
  if (mesh.error_tier > format::ErrorTier::kCertified) return fail("error_tier", "is unknown");
  if (mesh.normal_mode > format::NormalMode::kFlat) return fail("normal_mode", "is unknown");
  const bool has_normal = mesh.normal_mode == format::NormalMode::kStored;
  if (has_normal ? mesh.normal_scale < 1 || mesh.normal_scale > format::kMaxNormalScale : mesh.normal_scale != 0) {
    return fail("normal_scale", "must be 1 to 8191 where normals are stored, else 0");
  }
  if (mesh.uv_set_count > format::kMaxUvSets) return fail("uv_set_count", "must be 0 to 4");
  if (mesh.has_color > 1) return fail("has_color", "must be 0 or 1");
  for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
    if (mesh.uv_log2[set] < kMinLog2 || mesh.uv_log2[set] > kMaxLog2) return fail("uv_log2", "must be -126 to 104");
  }
  for (std::uint32_t set = mesh.uv_set_count; set < format::kMaxUvSets; ++set) {
    if (mesh.uv_log2[set] != 0) return fail("uv_log2", "must be 0 from uv_set_count on");
  }
  if (mesh.sphere_log2 < format::kMinSphereLog2 || mesh.sphere_log2 > format::kMaxSphereLog2) {
    return fail("sphere_log2", "must be -126 to 104");
  }
  return Ok{};
}

}  // namespace

std::uint64_t count_name_bytes(const RawTables& tables) {
  std::uint64_t sum = 0;
  for (const format::MeshRecord& mesh : tables.meshes) sum += mesh.name.bytes;
  for (const format::MaterialRecord& material : tables.materials) sum += material.name.bytes;
  for (const format::InstanceRecord& instance : tables.instances) sum += instance.name.bytes;
  for (const format::BlobRecord& blob : tables.blobs) sum += std::uint64_t{blob.name.bytes} + blob.mime_type.bytes;
  return sum;
}

Status check_meshes(const RawTables& tables) {
  std::uint64_t group_end = 0;
  std::uint64_t cluster_end = 0;
  std::uint64_t node_end = 0;
  for (std::size_t m = 0; m < tables.meshes.size(); ++m) {
    const format::MeshRecord& mesh = tables.meshes[m];
    const auto fail = [&](const char* field, const char* detail) {
      return invalid_record(SectionId::kMeshes, m, field, detail);
    };
    if (!is_string(tables, mesh.name)) return fail("name", "reaches beyond the strings");
    if (mesh.material != format::kNone && mesh.material >= tables.materials.size()) {
      return fail("material", "is out of range");
    }
    if (Status status = check_mesh_values(m, mesh); !status) return status;
    if (!extends(mesh.first_group, mesh.group_count, group_end, tables.groups.size())) {
      return fail("first_group", "meshes do not partition the groups");
    }
    if (!extends(mesh.first_cluster, mesh.cluster_count, cluster_end, tables.clusters.size())) {
      return fail("first_cluster", "meshes do not partition the clusters");
    }
    if (!extends(mesh.first_node, mesh.node_count, node_end, tables.nodes.size())) {
      return fail("first_node", "meshes do not partition the nodes");
    }
    if ((mesh.group_count == 0) != (mesh.cluster_count == 0)) {
      return fail("cluster_count", "groups and clusters go together");
    }
    if ((mesh.group_count == 0) != (mesh.node_count == 0)) return fail("node_count", "groups and nodes go together");
    if (mesh.level_count > 65536 || (mesh.group_count == 0) != (mesh.level_count == 0)) {
      return fail("level_count", "does not match the groups");
    }
  }
  const std::size_t count = tables.meshes.size();
  if (group_end != tables.groups.size()) {
    return invalid_record(SectionId::kMeshes, count, "first_group", "groups are left over");
  }
  if (cluster_end != tables.clusters.size()) {
    return invalid_record(SectionId::kMeshes, count, "first_cluster", "clusters are left over");
  }
  if (node_end != tables.nodes.size()) {
    return invalid_record(SectionId::kMeshes, count, "first_node", "nodes are left over");
  }
  return Ok{};
}

Status check_materials(const RawTables& tables) {
  for (std::size_t i = 0; i < tables.materials.size(); ++i) {
    const format::MaterialRecord& material = tables.materials[i];
    const auto fail = [&](const char* field, const char* detail) {
      return invalid_record(SectionId::kMaterials, i, field, detail);
    };
    if (!is_string(tables, material.name)) return fail("name", "reaches beyond the strings");
    if (material.alpha_mode > format::AlphaMode::kBlend) return fail("alpha_mode", "is unknown");
    for (const float value : material.base_color) {
      if (!std::isfinite(value)) return fail("base_color", "is not finite");
    }
    if (!std::isfinite(material.alpha_cutoff)) return fail("alpha_cutoff", "is not finite");
    if (material.double_sided > 1) return fail("double_sided", "must be 0 or 1");
  }
  return Ok{};
}

Status check_instances(const RawTables& tables) {
  for (std::size_t i = 0; i < tables.instances.size(); ++i) {
    const format::InstanceRecord& instance = tables.instances[i];
    const auto fail = [&](const char* field, const char* detail) {
      return invalid_record(SectionId::kInstances, i, field, detail);
    };
    if (!is_string(tables, instance.name)) return fail("name", "reaches beyond the strings");
    for (const double value : instance.transform) {
      if (!std::isfinite(value)) return fail("transform", "is not finite");
    }
    if ((instance.flags & ~(format::kInstanceMirrored | format::kInstanceSingular)) != 0U) {
      return fail("flags", "has an unknown bit");
    }
    const bool is_singular = (instance.flags & format::kInstanceSingular) != 0U;
    if (is_singular && (instance.flags & format::kInstanceMirrored) != 0U) {
      return fail("flags", "a singular instance is not mirrored");
    }
    if (!std::isfinite(instance.scale) || instance.scale < 0.0 || (instance.scale == 0.0 && !is_singular)) {
      return fail("scale", "must be finite and above 0");
    }
    if (instance.mesh >= tables.meshes.size()) return fail("mesh", "is out of range");
  }
  return Ok{};
}

Status check_blobs(const RawTables& tables) {
  std::uint64_t end = tables.blob_data->offset;
  const std::uint64_t section_end = tables.blob_data->offset + tables.blob_data->bytes;
  for (std::size_t i = 0; i < tables.blobs.size(); ++i) {
    const format::BlobRecord& blob = tables.blobs[i];
    const auto fail = [&](const char* field, const char* detail) {
      return invalid_record(SectionId::kBlobs, i, field, detail);
    };
    if (!is_string(tables, blob.name)) return fail("name", "reaches beyond the strings");
    if (!is_string(tables, blob.mime_type)) return fail("mime_type", "reaches beyond the strings");
    if (blob.kind != format::BlobKind::kImage && blob.kind != format::BlobKind::kBuffer) {
      return fail("kind", "is unknown");
    }
    if (blob.offset % format::kSectionAlignment != 0) return fail("offset", "is not a multiple of 16");
    if (blob.offset < end || blob.offset - end >= format::kSectionAlignment) {
      return fail("offset", "does not follow the blob before it");
    }
    if (blob.offset > section_end || blob.bytes > section_end - blob.offset) {
      return fail("bytes", "reaches beyond its section");
    }
    end = blob.offset + blob.bytes;
  }
  if (end != section_end) {
    return invalid_record(SectionId::kBlobs, tables.blobs.size(), "offset", "bytes of section BLOB are left over");
  }
  return Ok{};
}

}  // namespace meshlode::run
