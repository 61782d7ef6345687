// SPDX-License-Identifier: MIT
// The C structs of <meshlode/meshlode.h> are the records of <meshlode/format.h>, byte for byte: their views are handed
// out without a copy. What the compiler proves here needs no test.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <meshlode/format.h>
#include <meshlode/meshlode.h>

namespace meshlode {
namespace {

#define SAME_RECORD(c_type, cpp_type) \
  static_assert(sizeof(c_type) == sizeof(cpp_type) && alignof(c_type) == alignof(cpp_type))
#define SAME_FIELD(c_type, c_field, cpp_type, cpp_field)                      \
  static_assert(offsetof(c_type, c_field) == offsetof(cpp_type, cpp_field) && \
                sizeof(c_type::c_field) == sizeof(cpp_type::cpp_field))

SAME_RECORD(meshlode_string, format::StringRef);
SAME_FIELD(meshlode_string, bytes, format::StringRef, bytes);

SAME_RECORD(meshlode_mesh, format::MeshRecord);
SAME_FIELD(meshlode_mesh, origin, format::MeshRecord, origin);
SAME_FIELD(meshlode_mesh, bounds_min, format::MeshRecord, bounds_min);
SAME_FIELD(meshlode_mesh, bounds_max, format::MeshRecord, bounds_max);
SAME_FIELD(meshlode_mesh, diagonal, format::MeshRecord, diagonal);
SAME_FIELD(meshlode_mesh, level0_deviation, format::MeshRecord, level0_deviation);
SAME_FIELD(meshlode_mesh, error_tier, format::MeshRecord, error_tier);
SAME_FIELD(meshlode_mesh, normal_mode, format::MeshRecord, normal_mode);
SAME_FIELD(meshlode_mesh, normal_scale, format::MeshRecord, normal_scale);
SAME_FIELD(meshlode_mesh, uv_set_count, format::MeshRecord, uv_set_count);
SAME_FIELD(meshlode_mesh, has_color, format::MeshRecord, has_color);
SAME_FIELD(meshlode_mesh, uv_log2, format::MeshRecord, uv_log2);
SAME_FIELD(meshlode_mesh, uv_set_source, format::MeshRecord, uv_set_source);
SAME_FIELD(meshlode_mesh, material, format::MeshRecord, material);
SAME_FIELD(meshlode_mesh, sphere_log2, format::MeshRecord, sphere_log2);
SAME_FIELD(meshlode_mesh, level_count, format::MeshRecord, level_count);
SAME_FIELD(meshlode_mesh, source_triangles, format::MeshRecord, source_triangles);
SAME_FIELD(meshlode_mesh, source_vertices, format::MeshRecord, source_vertices);
SAME_FIELD(meshlode_mesh, dropped_degenerate, format::MeshRecord, dropped_degenerate);
SAME_FIELD(meshlode_mesh, dropped_duplicate, format::MeshRecord, dropped_duplicate);
SAME_FIELD(meshlode_mesh, dropped_repaired, format::MeshRecord, dropped_repaired);
SAME_FIELD(meshlode_mesh, grid_collapsed, format::MeshRecord, grid_collapsed);
SAME_FIELD(meshlode_mesh, first_group, format::MeshRecord, first_group);
SAME_FIELD(meshlode_mesh, group_count, format::MeshRecord, group_count);
SAME_FIELD(meshlode_mesh, first_cluster, format::MeshRecord, first_cluster);
SAME_FIELD(meshlode_mesh, cluster_count, format::MeshRecord, cluster_count);
SAME_FIELD(meshlode_mesh, first_node, format::MeshRecord, first_node);
SAME_FIELD(meshlode_mesh, node_count, format::MeshRecord, node_count);
static_assert(offsetof(meshlode_mesh, grid_log2) == offsetof(format::MeshRecord, grid) &&
              offsetof(meshlode_mesh, grid_mantissa) ==
                  offsetof(meshlode_mesh, grid_log2) + offsetof(format::Grid, mantissa));

SAME_RECORD(meshlode_material, format::MaterialRecord);
SAME_FIELD(meshlode_material, source_index, format::MaterialRecord, source_index);
SAME_FIELD(meshlode_material, alpha_mode, format::MaterialRecord, alpha_mode);
SAME_FIELD(meshlode_material, base_color, format::MaterialRecord, base_color);
SAME_FIELD(meshlode_material, alpha_cutoff, format::MaterialRecord, alpha_cutoff);
SAME_FIELD(meshlode_material, double_sided, format::MaterialRecord, double_sided);
SAME_FIELD(meshlode_material, base_color_texture, format::MaterialRecord, base_color_texture);
SAME_FIELD(meshlode_material, base_color_uv_set, format::MaterialRecord, base_color_uv_set);

SAME_RECORD(meshlode_instance, format::InstanceRecord);
SAME_FIELD(meshlode_instance, transform, format::InstanceRecord, transform);
SAME_FIELD(meshlode_instance, scale, format::InstanceRecord, scale);
SAME_FIELD(meshlode_instance, mesh, format::InstanceRecord, mesh);
SAME_FIELD(meshlode_instance, node, format::InstanceRecord, node);
SAME_FIELD(meshlode_instance, flags, format::InstanceRecord, flags);
SAME_FIELD(meshlode_instance, name, format::InstanceRecord, name);

SAME_RECORD(meshlode_group, format::GroupRecord);
SAME_FIELD(meshlode_group, center, format::GroupRecord, center);
SAME_FIELD(meshlode_group, radius, format::GroupRecord, radius);
SAME_FIELD(meshlode_group, error, format::GroupRecord, error);
SAME_FIELD(meshlode_group, quadric_error, format::GroupRecord, quadric_error);
SAME_FIELD(meshlode_group, deviation, format::GroupRecord, deviation);
SAME_FIELD(meshlode_group, normal_deviation, format::GroupRecord, normal_deviation);
SAME_FIELD(meshlode_group, uv_deviation, format::GroupRecord, uv_deviation);
SAME_FIELD(meshlode_group, first_cluster, format::GroupRecord, first_cluster);
SAME_FIELD(meshlode_group, mesh, format::GroupRecord, mesh);
SAME_FIELD(meshlode_group, page, format::GroupRecord, page);
SAME_FIELD(meshlode_group, cluster_count, format::GroupRecord, cluster_count);
SAME_FIELD(meshlode_group, level, format::GroupRecord, level);
SAME_FIELD(meshlode_group, flags, format::GroupRecord, flags);
SAME_FIELD(meshlode_group, stuck_reason, format::GroupRecord, stuck_reason);

SAME_RECORD(meshlode_cluster, format::ClusterRecord);
SAME_FIELD(meshlode_cluster, center, format::ClusterRecord, center);
SAME_FIELD(meshlode_cluster, radius, format::ClusterRecord, radius);
SAME_FIELD(meshlode_cluster, cone_axis, format::ClusterRecord, cone_axis);
SAME_FIELD(meshlode_cluster, cone_cutoff, format::ClusterRecord, cone_cutoff);
SAME_FIELD(meshlode_cluster, own_group, format::ClusterRecord, own_group);
SAME_FIELD(meshlode_cluster, coarser_group, format::ClusterRecord, coarser_group);
SAME_FIELD(meshlode_cluster, vertices_less_1, format::ClusterRecord, vertices_less_1);
SAME_FIELD(meshlode_cluster, triangles_less_1, format::ClusterRecord, triangles_less_1);
SAME_FIELD(meshlode_cluster, level, format::ClusterRecord, level);

SAME_RECORD(meshlode_node, format::NodeRecord);
SAME_FIELD(meshlode_node, center, format::NodeRecord, center);
SAME_FIELD(meshlode_node, radius, format::NodeRecord, radius);
SAME_FIELD(meshlode_node, error, format::NodeRecord, error);
SAME_FIELD(meshlode_node, first, format::NodeRecord, first);
SAME_FIELD(meshlode_node, child_count, format::NodeRecord, child_count);

SAME_RECORD(meshlode_page, format::PageRecord);
SAME_FIELD(meshlode_page, offset, format::PageRecord, offset);
SAME_FIELD(meshlode_page, stored_bytes, format::PageRecord, stored_bytes);
SAME_FIELD(meshlode_page, bytes, format::PageRecord, bytes);
SAME_FIELD(meshlode_page, codec, format::PageRecord, codec);
SAME_FIELD(meshlode_page, first_group, format::PageRecord, first_group);
SAME_FIELD(meshlode_page, group_count, format::PageRecord, group_count);
SAME_FIELD(meshlode_page, first_cluster, format::PageRecord, first_cluster);
SAME_FIELD(meshlode_page, cluster_count, format::PageRecord, cluster_count);
SAME_FIELD(meshlode_page, first_dependency, format::PageRecord, first_dependency);
SAME_FIELD(meshlode_page, dependency_count, format::PageRecord, dependency_count);
SAME_FIELD(meshlode_page, checksum, format::PageRecord, checksum);
SAME_FIELD(meshlode_page, decoded_checksum, format::PageRecord, decoded_checksum);

SAME_RECORD(meshlode_blob, format::BlobRecord);
SAME_FIELD(meshlode_blob, mime_type, format::BlobRecord, mime_type);
SAME_FIELD(meshlode_blob, offset, format::BlobRecord, offset);
SAME_FIELD(meshlode_blob, bytes, format::BlobRecord, bytes);
SAME_FIELD(meshlode_blob, kind, format::BlobRecord, kind);
SAME_FIELD(meshlode_blob, source_index, format::BlobRecord, source_index);
SAME_FIELD(meshlode_blob, checksum, format::BlobRecord, checksum);

static_assert(MESHLODE_NONE == format::kNone);
static_assert(MESHLODE_INFINITE_ERROR == format::kInfiniteError);
static_assert(MESHLODE_MAX_CLUSTER_VERTICES == format::kMaxClusterVertices);
static_assert(MESHLODE_MAX_CLUSTER_TRIANGLES == format::kMaxClusterTriangles);
static_assert(MESHLODE_MAX_PAGE_BYTES == format::kMaxPageBytes);
static_assert(MESHLODE_MAX_UV_SETS == format::kMaxUvSets);
static_assert(MESHLODE_NORMALS_STORED == static_cast<int>(format::NormalMode::kStored));
static_assert(MESHLODE_NORMALS_FLAT == static_cast<int>(format::NormalMode::kFlat));
static_assert(MESHLODE_INSTANCE_MIRRORED == format::kInstanceMirrored);
static_assert(MESHLODE_INSTANCE_SINGULAR == format::kInstanceSingular);
static_assert(MESHLODE_GROUP_TERMINAL == format::kGroupTerminal && MESHLODE_GROUP_STUCK == format::kGroupStuck &&
              MESHLODE_GROUP_AGGREGATE == format::kGroupAggregate);

#undef SAME_RECORD
#undef SAME_FIELD

}  // namespace
}  // namespace meshlode
