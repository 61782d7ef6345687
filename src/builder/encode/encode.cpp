// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters are encoded group by group in parallel, then groups are dealt to pages in order, then pages are put together
// in parallel: count, prefix, write (I10).
#include "builder/encode/encode.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "base/release.h"
#include "base/try.h"
#include "builder/encode/attribute_steps.h"
#include "builder/encode/cluster_bytes.h"
#include "builder/encode/quantize_normal.h"

namespace meshlode::builder {

namespace {

static_assert(kNoId == format::kNone, "ids of the build become the format's as they are");

std::string name_mesh(const PreparedMesh& mesh) {
  return "mesh \"" + mesh.name + "\"";
}

/// The nearest float, infinity as the format writes it.
float to_stored_error(double value) {
  if (std::isnan(value) || value >= double(format::kInfiniteError)) return format::kInfiniteError;
  return static_cast<float>(std::max(value, 0.0));
}

/// The least float that is not below `value`: what is stored as a bound must bound.
float to_float_up(double value) {
  const float nearest = to_stored_error(value);
  if (double(nearest) >= value || nearest == format::kInfiniteError) return nearest;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + 1U);  // not negative: the next float up
}

ChannelPlan plan_channels(const PreparedMesh& mesh, const LodDag& dag, const EncodeOptions& options) {
  ChannelPlan plan;
  plan.layout = mesh.layout;
  plan.strip_trials = options.strip_trials;
  plan.mixed_strip_trials = options.mixed_strip_trials;
  const AttributeSteps steps = dag.steps ? *dag.steps : choose_steps(mesh.layout, dag, options);
  plan.normal_scale = steps.normal_scale;
  plan.uv_log2 = steps.uv_log2;
  const bool is_one = !dag.triangle_material.empty() && !dag.has_several_materials();
  plan.material = is_one ? dag.triangle_material.front() : format::kNone;
  return plan;
}

void fill_bounds(const LodDag& dag, format::MeshRecord& record) {
  bool is_first = true;
  for (const DagCluster& cluster : dag.clusters) {
    if (cluster.own_group.is_valid()) continue;
    for (std::size_t v = cluster.first_vertex; v < std::size_t{cluster.first_vertex} + cluster.vertex_count; ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t q = dag.vertex_position[v][axis];
        record.bounds_min[axis] = is_first ? q : std::min(record.bounds_min[axis], q);
        record.bounds_max[axis] = is_first ? q : std::max(record.bounds_max[axis], q);
      }
      is_first = false;
    }
  }
}

format::MeshRecord mesh_record(const PreparedMesh& mesh, const LodDag& dag, const ChannelPlan& plan) {
  format::MeshRecord record{};
  for (int axis = 0; axis < 3; ++axis) record.origin[axis] = mesh.origin[axis];
  record.grid = {mesh.grid.log2, mesh.grid.mantissa};
  fill_bounds(dag, record);
  record.diagonal = mesh.diagonal;
  record.level0_deviation = to_float_up(mesh.level0_deviation);
  record.error_tier = format::ErrorTier::kQem;
  record.normal_mode = mesh.layout.has_normal    ? format::NormalMode::kStored
                       : mesh.layout.flat_normal ? format::NormalMode::kFlat
                                                 : format::NormalMode::kNone;
  record.normal_scale = static_cast<std::uint32_t>(plan.normal_scale);
  record.uv_set_count = mesh.layout.uv_set_count;
  record.has_color = mesh.layout.has_color ? 1U : 0U;
  for (std::uint32_t set = 0; set < mesh.layout.uv_set_count; ++set) {
    record.uv_log2[set] = plan.uv_log2[set];
    record.uv_set_source[set] = mesh.layout.uv_set_source[set];
  }
  record.material = plan.material;
  record.source_triangles = mesh.source_triangles;
  record.source_vertices = mesh.source_vertices;
  record.dropped_degenerate = mesh.dropped_degenerate;
  record.dropped_duplicate = mesh.dropped_duplicate;
  record.dropped_repaired = mesh.dropped_repaired;
  record.grid_collapsed = mesh.grid_collapsed;
  record.level_count = dag.level_count;
  return record;
}

format::GroupRecord group_record(const DagGroup& group, const Hierarchy::Sphere& sphere, float error) {
  format::GroupRecord record{};
  std::copy(std::begin(sphere.center), std::end(sphere.center), std::begin(record.center));
  record.radius = sphere.radius;
  put_errors(group, error, record);
  record.first_cluster = group.first_cluster;
  record.cluster_count = static_cast<std::uint16_t>(group.cluster_count);
  record.level = static_cast<std::uint16_t>(group.level);
  if (group.is_terminal) record.flags |= format::kGroupTerminal;
  if (group.is_aggregate) record.flags |= format::kGroupAggregate;
  if (group.is_terminal && group.stuck_reason != StuckReason::kNotStuck) record.flags |= format::kGroupStuck;
  record.stuck_reason = static_cast<format::StuckReason>(group.stuck_reason);
  return record;
}

format::ClusterRecord cluster_record(const DagCluster& cluster, const Hierarchy::Sphere& sphere,
                                     const Hierarchy::Cone& cone, std::int32_t sphere_log2) {
  format::ClusterRecord record{};
  const double unit =
      format::exp2_exact(sphere_log2);  // the hierarchy's spheres are whole units: nothing is rounded here
  for (int axis = 0; axis < 3; ++axis) {
    record.center[axis] = static_cast<std::int16_t>(double{sphere.center[axis]} / unit);
  }
  record.radius = static_cast<std::uint16_t>(double{sphere.radius} / unit);
  std::copy(std::begin(cone.axis), std::end(cone.axis), std::begin(record.cone_axis));
  record.cone_cutoff = cone.cutoff;
  record.own_group = cluster.own_group.is_valid() ? cluster.own_group.value : format::kNone;
  record.coarser_group = cluster.coarser_group.value;
  record.vertices_less_1 = static_cast<std::uint8_t>(cluster.vertex_count - 1U);
  record.triangles_less_1 = static_cast<std::uint8_t>(cluster.triangle_count - 1U);
  record.level = static_cast<std::uint16_t>(cluster.level);
  return record;
}

/// The stage before left something that the file cannot say: a programmer's mistake caught where it costs least.
Status check_input(const PreparedMesh& mesh, const LodDag& dag, const Hierarchy& hierarchy,
                   const EncodeOptions& options) {
  const auto fail = [&](ErrorCode code, const char* detail) { return Error{code, name_mesh(mesh), detail}; };
  if (!(options.normal_error > 0.0) || options.strip_trials < 1 || options.mixed_strip_trials < 1) {
    return fail(ErrorCode::kUsage, "the normal error must be above 0, and the strip trials at least 1");
  }
  if (mesh.layout.has_normal && octahedral_scale_for(options.normal_error) > format::kMaxNormalScale) {
    return fail(ErrorCode::kUnsupported, "a normal error below 0.01 degrees needs more bits than the format has");
  }
  for (const double error : options.uv_error) {
    if (!(error >= 0.0)) return fail(ErrorCode::kUsage, "a UV error must not be negative");
  }
  if (mesh.grid.log2 < kMinGridLog2 || mesh.grid.log2 > kMaxGridLog2 || mesh.grid.mantissa < 1 ||
      mesh.grid.mantissa >= (1U << 24U)) {
    return fail(ErrorCode::kUnsupported, "the grid's step leaves the range of floats");
  }
  if (dag.vertex_attributes.size() != dag.vertex_position.size() * mesh.layout.stride()) {
    return fail(ErrorCode::kBuildFailed, "the DAG's attributes do not match its vertices");
  }
  if (dag.triangle_material.size() != dag.triangles.size()) {
    return fail(ErrorCode::kBuildFailed, "the DAG's materials do not match its triangles");
  }
  if (hierarchy.group_spheres.size() != dag.groups.size() || hierarchy.group_errors.size() != dag.groups.size() ||
      hierarchy.cluster_spheres.size() != dag.clusters.size() ||
      hierarchy.cluster_cones.size() != dag.clusters.size()) {
    return fail(ErrorCode::kBuildFailed, "the hierarchy does not match the DAG");
  }
  if (hierarchy.sphere_log2 < format::kMinSphereLog2 || hierarchy.sphere_log2 > format::kMaxSphereLog2) {
    return fail(ErrorCode::kBuildFailed, "the hierarchy's spheres leave the range of floats");
  }
  for (const Hierarchy::Sphere& sphere : hierarchy.cluster_spheres) {
    const double unit = format::exp2_exact(hierarchy.sphere_log2);
    const auto is_whole = [&](float value, double most) {
      const double units = double{value} / unit;
      return std::abs(units) <= most && std::floor(units) == units;
    };
    bool fits = is_whole(sphere.radius, 65535.0);
    for (const float c : sphere.center) fits &= is_whole(c, 32767.0);
    if (fits) continue;
    // In the largest unit that there is, it is the mesh that is too large.
    if (hierarchy.sphere_log2 == format::kMaxSphereLog2) {
      return fail(ErrorCode::kUnsupported, "a culling sphere leaves the range of the format");
    }
    return fail(ErrorCode::kBuildFailed, "a culling sphere is not in whole units of 16 bits");
  }
  std::size_t next_cluster = 0;
  for (const DagGroup& group : dag.groups) {
    if (group.first_cluster != next_cluster || group.cluster_count < 1) {
      return fail(ErrorCode::kBuildFailed, "the DAG's groups do not partition its clusters");
    }
    if (group.cluster_count > std::numeric_limits<std::uint16_t>::max()) {
      return fail(ErrorCode::kUnsupported, "a group has more than 65,535 clusters");
    }
    next_cluster += group.cluster_count;
    if (group.level > std::numeric_limits<std::uint16_t>::max() - 1U) {
      return fail(ErrorCode::kBuildFailed, "the DAG has too many levels");
    }
  }
  if (next_cluster != dag.clusters.size()) {
    return fail(ErrorCode::kBuildFailed, "the DAG's groups do not partition its clusters");
  }
  for (const DagCluster& cluster : dag.clusters) {
    if (std::size_t{cluster.first_vertex} + cluster.vertex_count > dag.vertex_position.size() ||
        std::size_t{cluster.first_triangle} + cluster.triangle_count > dag.triangles.size()) {
      return fail(ErrorCode::kBuildFailed, "a cluster reaches beyond the DAG's arrays");
    }
    if (cluster.coarser_group.value >= dag.groups.size() ||
        (cluster.own_group.is_valid() && cluster.own_group.value >= dag.groups.size())) {
      return fail(ErrorCode::kBuildFailed, "a cluster names a group that the DAG lacks");
    }
  }
  return Ok{};
}

/// The encoded members of one group.
struct GroupWords {
  std::vector<ClusterWords> clusters;
  std::size_t bytes_in_page = 0;
  std::optional<Error> error;
};

GroupWords encode_group(const LodDag& dag, const DagGroup& group, const ChannelPlan& plan) {
  GroupWords out;
  out.clusters.reserve(group.cluster_count);
  for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
    Result<ClusterWords> cluster = encode_cluster(dag, dag.clusters[c], plan);
    if (!cluster) {
      out.error = cluster.error();
      out.error->where = "cluster " + std::to_string(c);
      break;
    }
    out.bytes_in_page += 4 * (plan.head_words() + cluster->data.size());
    out.clusters.push_back(std::move(*cluster));
  }
  return out;
}

Result<std::vector<EncodedMesh::Page>> deal_pages(const PreparedMesh& mesh, const LodDag& dag,
                                                  const EncodeOptions& options, const std::vector<GroupWords>& groups,
                                                  std::span<const ViewBits> needs) {
  std::vector<std::size_t> group_bytes;
  group_bytes.reserve(groups.size());
  for (const GroupWords& group : groups) {
    if (kPageFrameBytes + group.bytes_in_page > format::kMaxPageBytes) {
      return Error{ErrorCode::kUnsupported, name_mesh(mesh) + ", group " + std::to_string(group_bytes.size()),
                   "its " + std::to_string(group.clusters.size()) + " clusters take " +
                       std::to_string(group.bytes_in_page) + " bytes and a page holds " +
                       std::to_string(format::kMaxPageBytes)};
    }
    group_bytes.push_back(group.bytes_in_page);
  }
  std::vector<EncodedMesh::Page> pages;
  const std::vector<std::uint32_t> page_of =
      deal_groups(group_bytes, options.first_page_bytes, options.page_bytes, needs);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (page_of[g] == pages.size()) {
      pages.emplace_back();
      pages.back().first_group = static_cast<std::uint32_t>(g);
      pages.back().first_cluster = dag.groups[g].first_cluster;
    }
    ++pages.back().group_count;
    pages.back().cluster_count += dag.groups[g].cluster_count;
  }
  return pages;
}

void assemble_page(const std::vector<GroupWords>& groups, const ChannelPlan& plan, EncodedMesh::Page& page) {
  std::vector<std::uint32_t> words{page.first_cluster, page.cluster_count};
  std::size_t data_word = words.size() + std::size_t{page.cluster_count} * plan.head_words();
  const auto for_each_cluster = [&](const auto& visit) {
    for (std::uint32_t g = page.first_group; g < page.first_group + page.group_count; ++g) {
      for (const ClusterWords& cluster : groups[g].clusters) visit(cluster);
    }
  };
  for_each_cluster([&](const ClusterWords& cluster) {
    auto head = cluster.head;
    format::put_field(head.data(), format::head::kDataWord, static_cast<std::int32_t>(data_word));
    words.insert(words.end(), head.begin(), head.begin() + plan.head_words());
    data_word += cluster.data.size();
  });
  for_each_cluster(
      [&](const ClusterWords& cluster) { words.insert(words.end(), cluster.data.begin(), cluster.data.end()); });
  words.push_back(0);
  static_assert(std::endian::native == std::endian::little, "words are written as they lie in memory");
  page.bytes.resize(4 * words.size());
  std::memcpy(page.bytes.data(), words.data(), page.bytes.size());
}

/// A page needs the pages that hold the clusters made from its groups: with them loaded, its own clusters may be drawn.
void fill_dependencies(const LodDag& dag, EncodedMesh& out) {
  for (const DagCluster& cluster : dag.clusters) {
    if (!cluster.own_group.is_valid()) continue;
    const std::uint32_t page = out.groups[cluster.own_group.value].page;
    const std::uint32_t needed = out.groups[cluster.coarser_group.value].page;
    if (page != needed) out.pages[page].dependencies.push_back(needed);
  }
  for (EncodedMesh::Page& page : out.pages) {
    std::sort(page.dependencies.begin(), page.dependencies.end());
    page.dependencies.erase(std::unique(page.dependencies.begin(), page.dependencies.end()), page.dependencies.end());
  }
}

/// Budgets that may not fall short, held against the steps that the coordinates leave.
Status check_uv_steps(const PreparedMesh& mesh, const ChannelPlan& plan, const EncodeOptions& options) {
  for (std::uint32_t set = 0; set < mesh.layout.uv_set_count && !options.uv_error_may_fall_short; ++set) {
    if (!(options.uv_error[set] > 0.0) || 0.5 * format::exp2_exact(plan.uv_log2[set]) <= options.uv_error[set])
      continue;
    char text[160];
    std::snprintf(text, sizeof text, "a UV error of %g needs more than 24 bits for the coordinates of TEXCOORD_%u",
                  options.uv_error[set], static_cast<unsigned>(mesh.layout.uv_set_source[set]));
    return Error{ErrorCode::kUnsupported, name_mesh(mesh), text};
  }
  return Ok{};
}

}  // namespace

std::int32_t normal_scale_of(const EncodeOptions& options) {
  return static_cast<std::int32_t>(
      std::min(octahedral_scale_for(options.normal_error), std::uint64_t{format::kMaxNormalScale}));
}

void put_errors(const DagGroup& group, float error, format::GroupRecord& record) {
  record.error = group.is_terminal ? format::kInfiniteError : to_stored_error(error);
  record.quadric_error = group.is_terminal ? format::kInfiniteError : to_stored_error(group.quadric_error);
  record.deviation = to_float_up(group.deviation);
  record.normal_deviation = group.is_terminal ? format::kInfiniteError : to_float_up(group.normal_deviation);
  record.uv_deviation = group.is_terminal ? format::kInfiniteError : to_float_up(group.uv_deviation);
}

bool has_aggregates(std::span<const format::GroupRecord> groups) {
  return std::any_of(groups.begin(), groups.end(),
                     [](const format::GroupRecord& group) { return (group.flags & format::kGroupAggregate) != 0; });
}

Result<EncodedMesh> encode_mesh(const PreparedMesh& mesh, const LodDag& dag, const Hierarchy& hierarchy,
                                const EncodeOptions& options, std::span<const ViewBits> needs) {
  TRY(check_input(mesh, dag, hierarchy, options));
  const ChannelPlan plan = plan_channels(mesh, dag, options);
  TRY(check_uv_steps(mesh, plan, options));

  std::vector<GroupWords> group_words(dag.groups.size());
  parallel_for_each_index(dag.groups.size(), 4,
                          [&](std::size_t g) { group_words[g] = encode_group(dag, dag.groups[g], plan); });
  for (const GroupWords& group : group_words) {
    if (group.error) {
      return Error{group.error->code, name_mesh(mesh) + ", " + group.error->where, group.error->detail};
    }
  }

  EncodedMesh out;
  out.record = mesh_record(mesh, dag, plan);
  TRY_LET(pages, deal_pages(mesh, dag, options, group_words, needs));
  out.pages = std::move(*pages);
  parallel_for_each_index(out.pages.size(), 1, [&](std::size_t p) {
    const EncodedMesh::Page& page = out.pages[p];
    assemble_page(group_words, plan, out.pages[p]);
    for (std::uint32_t g = page.first_group; g < page.first_group + page.group_count; ++g)
      release(group_words[g].clusters);
  });

  out.groups.reserve(dag.groups.size());
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    out.groups.push_back(group_record(dag.groups[g], hierarchy.group_spheres[g], hierarchy.group_errors[g]));
  }
  for (std::size_t p = 0; p < out.pages.size(); ++p) {
    const EncodedMesh::Page& page = out.pages[p];
    for (std::uint32_t g = page.first_group; g < page.first_group + page.group_count; ++g) {
      out.groups[g].page = static_cast<std::uint32_t>(p);
    }
  }
  out.record.sphere_log2 = hierarchy.sphere_log2;
  out.clusters.reserve(dag.clusters.size());
  for (std::size_t c = 0; c < dag.clusters.size(); ++c) {
    out.clusters.push_back(cluster_record(dag.clusters[c], hierarchy.cluster_spheres[c], hierarchy.cluster_cones[c],
                                          out.record.sphere_log2));
  }
  fill_dependencies(dag, out);
  out.nodes = hierarchy.nodes;
  for (format::NodeRecord& node : out.nodes) node.error = to_stored_error(node.error);

  out.record.group_count = static_cast<std::uint32_t>(out.groups.size());
  out.record.cluster_count = static_cast<std::uint32_t>(out.clusters.size());
  out.record.node_count = static_cast<std::uint32_t>(out.nodes.size());
  return out;
}

}  // namespace meshlode::builder
