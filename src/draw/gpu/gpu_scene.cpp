// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/gpu_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/shaders/frame.h"
#include "draw/gpu/upload_table.h"
#include "run/decode/decode.h"
#include "run/select/far_instance.h"
#include "run/select/select.h"
#include "run/unpack/unpack.h"

namespace meshlode::draw {

namespace {

/// Selection errors of groups and nodes: infinite, so that they never pass, where an attribute deviates by too much.
struct Errors {
  std::vector<float> group, node;
};

Errors find_errors(const run::Asset& asset, const run::AttributeBounds& bounds) {
  Errors out;
  for (const format::GroupRecord& group : asset.groups()) out.group.push_back(group.error);
  for (const format::NodeRecord& node : asset.nodes()) out.node.push_back(node.error);
  const run::SelectTables tables = run::tables_of(asset);
  for (const format::MeshRecord& mesh : asset.meshes()) {
    const run::AttributeBounds own = run::bounds_for(bounds, mesh);
    if (!own.has_any()) continue;
    for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
      if (!run::is_within(own, asset.groups()[g])) out.group[g] = format::kInfiniteError;
    }
    const std::vector<std::uint8_t> within = run::find_nodes_within(tables, mesh, own);
    for (std::uint32_t n = 0; n < mesh.node_count; ++n) {
      if (within[n] == 0) out.node[mesh.first_node + n] = format::kInfiniteError;
    }
  }
  return out;
}

std::vector<GpuMesh> mesh_table(const run::Asset& asset, const Errors& errors) {
  std::vector<GpuMesh> out;
  const run::SelectTables tables = run::tables_of(asset);
  for (const format::MeshRecord& mesh : asset.meshes()) {
    GpuMesh m{};
    std::copy(mesh.origin, mesh.origin + 3, m.origin);
    m.step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    m.reach = run::mesh_reach(tables, mesh);
    const run::FarBound far = run::find_far_bound(tables, mesh, errors.group);
    std::copy(far.bound.center, far.bound.center + 3, m.root_center);
    m.root_radius = far.bound.radius;
    m.coarse_error = far.bound.error;
    m.only_root = far.only_root;
    m.first_node = mesh.first_node;
    m.node_count = mesh.group_count > 0 ? mesh.node_count : 0;
    m.first_group = mesh.first_group;
    m.first_cluster = mesh.first_cluster;
    m.channel_count = format::channel_count(mesh);
    m.normal_mode = static_cast<std::uint32_t>(mesh.normal_mode);
    m.normal_scale = mesh.normal_scale;
    m.uv_set_count = mesh.uv_set_count;
    m.has_color = mesh.has_color;
    m.group_count = mesh.group_count;
    m.material = mesh.material;
    out.push_back(m);
  }
  return out;
}

std::vector<GpuInstance> instance_table(std::span<const format::InstanceRecord> instances) {
  std::vector<GpuInstance> out(instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i) {
    std::copy(instances[i].transform, instances[i].transform + 12, out[i].transform);
    out[i].scale = instances[i].scale;
    out[i].mesh = instances[i].mesh;
    out[i].flags = instances[i].flags;
  }
  return out;
}

std::vector<GpuNode> node_table(const run::Asset& asset, const Errors& errors) {
  std::vector<GpuNode> out;
  for (const format::NodeRecord& node : asset.nodes()) {
    GpuNode n{};
    std::copy(node.center, node.center + 3, n.center);
    n.radius = node.radius;
    n.error = errors.node[out.size()];
    n.first = node.first;
    n.child_count = node.child_count;
    out.push_back(n);
  }
  return out;
}

/// Nodes on the longest way down. Children lie behind their node, so one pass from the back sees them first.
std::uint32_t bvh_depth(const run::Asset& asset) {
  const auto nodes = asset.nodes();
  std::vector<std::uint32_t> height(nodes.size(), 1);
  std::uint32_t deepest = 0;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    for (std::uint32_t c = 0; c < nodes[i].child_count && nodes[i].first > i; ++c) {
      height[i] = std::max(height[i], height[nodes[i].first + c] + 1);
    }
    deepest = std::max(deepest, height[i]);
  }
  return deepest;
}

struct Pages {
  Buffer buffer;
  std::vector<std::uint32_t> word;  ///< where each page begins
  std::uint64_t bytes = 0;
};

Result<Pages> upload_pages(Device& device, const run::Asset& asset) {
  Pages out;
  std::uint64_t words = 0;
  for (const format::PageRecord& page : asset.pages()) {
    out.word.push_back(static_cast<std::uint32_t>(words));
    words += (std::uint64_t{page.bytes} + 15) / 16 * 4;
  }
  if (words + 4 > 0xFFFFFFFFu) return Error{ErrorCode::kUnsupported, "pages", "more than 16 GiB of pages"};
  out.bytes = words * 4;
  TRY(run::check_decoded_bytes(asset, out.bytes));
  auto buffer = device.make_buffer(out.bytes + 16, Memory::kDevice);  // a reader may look at one word behind a page
  if (!buffer) return buffer.error();
  out.buffer = *buffer;
  std::vector<std::uint8_t> chunk;
  std::uint64_t chunk_at = 0;
  constexpr std::size_t kChunk = 8u << 20;
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    TRY_LET(page, run::load_page(asset, PageId(p)));
    const std::span<const std::uint8_t> bytes = page->bytes();
    chunk.insert(chunk.end(), bytes.begin(), bytes.end());
    chunk.resize((chunk.size() + 15) / 16 * 16, 0);
    if (chunk.size() < kChunk && p + 1 < asset.pages().size()) continue;
    TRY(device.upload(out.buffer, chunk, chunk_at));
    chunk_at += chunk.size();
    chunk.clear();
  }
  return out;
}

/// Room for as many pages as there are slots, each for the largest of the asset.
Result<Pages> make_slots(Device& device, const run::Asset& asset, GpuScene& scene) {
  Pages out;
  out.word.resize(asset.pages().size());
  for (const format::PageRecord& page : asset.pages()) {
    scene.slot_bytes = std::max(scene.slot_bytes, (page.bytes + 15) / 16 * 16);
  }
  out.bytes = std::uint64_t{scene.slot_count} * scene.slot_bytes;
  TRY(run::check_decoded_bytes(asset, out.bytes));
  if (out.bytes / 4 + 4 > 0xFFFFFFFFU) return Error{ErrorCode::kUnsupported, "pages", "a pool of more than 16 GiB"};
  TRY_LET(buffer, device.make_buffer(out.bytes + 16, Memory::kDevice));
  out.buffer = *buffer;
  return out;
}

std::vector<GpuMeshUvs> mesh_uv_table(const run::Asset& asset) {
  std::vector<GpuMeshUvs> out;
  for (const format::MeshRecord& mesh : asset.meshes()) {
    GpuMeshUvs m{};
    for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
      m.log2[set] = mesh.uv_log2[set];
      m.source |= std::uint32_t{mesh.uv_set_source[set]} << 8 * set;
    }
    out.push_back(m);
  }
  return out;
}

struct MaskTables {
  std::vector<GpuMask> masks;
  std::vector<std::uint8_t> texels;  ///< images one after the other, each from a word on
};

MaskTables mask_tables(const AlphaMasks& alpha) {
  MaskTables out;
  std::vector<std::uint32_t> first_word;
  for (const AlphaImage& image : alpha.images) {
    first_word.push_back(static_cast<std::uint32_t>(out.texels.size() / 4));
    out.texels.insert(out.texels.end(), image.texels.begin(), image.texels.end());
    out.texels.resize((out.texels.size() + 3) / 4 * 4, 0);
  }
  for (const AlphaMask& mask : alpha.masks) {
    GpuMask m{};
    std::copy(mask.row_u.begin(), mask.row_u.end(), m.rows);
    std::copy(mask.row_v.begin(), mask.row_v.end(), m.rows + 3);
    m.threshold = mask.threshold;
    m.uv_set = mask.uv_set;
    m.wrap[0] = static_cast<std::uint32_t>(mask.wrap[0]);
    m.wrap[1] = static_cast<std::uint32_t>(mask.wrap[1]);
    if (mask.image != format::kNone) {
      m.width = alpha.images[mask.image].width;
      m.height = alpha.images[mask.image].height;
      m.first_word = first_word[mask.image];
    }
    out.masks.push_back(m);
  }
  return out;
}

std::vector<GpuGroup> group_table(const run::Asset& asset, const Errors& errors) {
  std::vector<GpuGroup> out;
  for (const format::GroupRecord& group : asset.groups()) {
    GpuGroup g{};
    std::copy(group.center, group.center + 3, g.center);
    g.radius = group.radius;
    g.error = errors.group[out.size()];
    g.first_cluster = group.first_cluster;
    g.cluster_count = group.cluster_count;
    g.page = group.page;
    out.push_back(g);
  }
  return out;
}

struct ClusterTable {
  std::vector<GpuCluster> clusters;
  std::uint64_t root_words = 1;  ///< of the buffer of decoded roots; word 0 is nobody's
};

/// Where a mesh has one root, that cluster has a place among the decoded ones. The largest counts go to `scene`.
ClusterTable cluster_table(const run::Asset& asset, const std::vector<GpuMesh>& meshes,
                           const std::vector<GpuGroup>& groups, GpuScene& scene) {
  ClusterTable out;
  for (const format::ClusterRecord& cluster : asset.clusters()) {
    const format::GroupRecord& group = asset.groups()[cluster.coarser_group];
    GpuCluster c{};
    const format::CullSphere sphere = format::cull_sphere(asset.meshes()[group.mesh], cluster);
    std::copy(sphere.center, sphere.center + 3, c.center);
    c.radius = sphere.radius;
    c.own_group = cluster.own_group;
    c.page = groups[cluster.coarser_group].page;
    c.index = static_cast<std::uint32_t>(out.clusters.size()) - asset.pages()[group.page].first_cluster;
    c.index |= static_cast<std::uint32_t>(cluster.level) << 16u;
    scene.max_cluster_triangles = std::max(scene.max_cluster_triangles, cluster.triangle_count());
    scene.max_cluster_vertices = std::max(scene.max_cluster_vertices, cluster.vertex_count());
    const std::uint32_t only = meshes[group.mesh].only_root;
    if (only == cluster.coarser_group && groups[only].cluster_count == 1) {
      scene.max_root_triangles = std::max(scene.max_root_triangles, cluster.triangle_count());
      scene.max_root_vertices = std::max(scene.max_root_vertices, cluster.vertex_count());
      c.root_word = static_cast<std::uint32_t>(out.root_words);
      out.root_words += 1 + 3 * cluster.vertex_count() + cluster.triangle_count();
    }
    out.clusters.push_back(c);
  }
  return out;
}

std::vector<GpuMaterial> material_table(const run::Asset& asset, const AlphaMasks& alpha) {
  std::vector<GpuMaterial> out;
  for (const format::MaterialRecord& material : asset.materials()) {
    GpuMaterial m{};
    m.base_color = {material.base_color[0], material.base_color[1], material.base_color[2], material.base_color[3]};
    m.double_sided = material.double_sided;
    m.mask = alpha.is_empty() ? format::kNone : alpha.of_material[out.size()];
    out.push_back(m);
  }
  return out;
}

/// Counts of what is drawn, by which the renderer's lists are sized.
void count_instances(const run::Asset& asset, std::span<const format::InstanceRecord> instances, GpuScene& scene) {
  scene.instance_count = static_cast<std::uint32_t>(instances.size());
  scene.cluster_count = static_cast<std::uint32_t>(asset.clusters().size());
  scene.mesh_count = static_cast<std::uint32_t>(asset.meshes().size());
  for (const format::InstanceRecord& instance : instances) {
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    scene.group_instances += asset.meshes()[instance.mesh].group_count;
    scene.cluster_instances += asset.meshes()[instance.mesh].cluster_count;
  }
}

/// What its materials and meshes call for, by which passes are planned.
void find_needs(const run::Asset& asset, GpuScene& scene) {
  scene.has_alpha_mask = !scene.alpha_masks->is_empty();
  scene.has_textures = has_textures(scene.material_textures);
  scene.has_double_sided = std::any_of(asset.materials().begin(), asset.materials().end(),
                                       [](const format::MaterialRecord& m) { return m.double_sided != 0; });
  scene.has_stored_normals = std::any_of(asset.meshes().begin(), asset.meshes().end(), [](const format::MeshRecord& m) {
    return m.normal_mode == format::NormalMode::kStored;
  });
}

Status upload_tables(Device& device, const run::Asset& asset, std::span<const format::InstanceRecord> instances,
                     const Errors& errors, const Pages& pages, GpuScene& scene) {
  const std::vector<GpuMesh> meshes = mesh_table(asset, errors);
  const std::vector<GpuGroup> groups = group_table(asset, errors);
  const ClusterTable clusters = cluster_table(asset, meshes, groups, scene);
  const MaskTables mask = mask_tables(*scene.alpha_masks);
  auto roots = device.make_buffer(clusters.root_words * 4, Memory::kDevice);  // filled by the renderer
  if (!roots) return roots.error();
  scene.roots = *roots;
  const auto put = [&](Buffer& slot, const auto& table) -> Status {
    TRY_LET(buffer, make_table(device, table));
    slot = *buffer;
    return Ok{};
  };
  if (const Status s = put(scene.meshes, meshes); !s) return s;
  if (const Status s = put(scene.instances, instance_table(instances)); !s) return s;
  if (const Status s = put(scene.nodes, node_table(asset, errors)); !s) return s;
  if (const Status s = put(scene.groups, groups); !s) return s;
  if (const Status s = put(scene.clusters, clusters.clusters); !s) return s;
  if (const Status s = put(scene.page_words, pages.word); !s) return s;
  const std::vector<std::uint32_t> ready((groups.size() + 31) / 32, scene.slot_count > 0 ? 0U : ~0U);
  if (const Status s = put(scene.ready, ready); !s) return s;
  if (const Status s = put(scene.priorities, std::vector<std::uint32_t>(pages.word.size())); !s) return s;
  if (const Status s = put(scene.materials, material_table(asset, *scene.alpha_masks)); !s) return s;
  if (const Status s = put(scene.mesh_uvs, mesh_uv_table(asset)); !s) return s;
  if (const Status s = put(scene.masks, mask.masks); !s) return s;
  return put(scene.mask_texels, mask.texels);
}

}  // namespace

Result<GpuScene> upload_scene(Device& device, const run::Asset& asset,
                              std::span<const format::InstanceRecord> instances, const run::AttributeBounds& bounds,
                              ImageBudget* images, std::uint32_t slots) {
  if (instances.empty()) instances = asset.instances();
  GpuScene out;
  out.bvh_depth = bvh_depth(asset);
  if (out.bvh_depth > MAX_DEPTH) {
    return Error{
        ErrorCode::kUnsupported, "hierarchy",
        std::to_string(out.bvh_depth) + " nodes deep, the GPU traversal has room for " + std::to_string(MAX_DEPTH)};
  }
  count_instances(asset, instances, out);
  out.slot_count = slots;
  TRY_LET(pages, slots > 0 ? make_slots(device, asset, out) : upload_pages(device, asset));
  out.pages = pages->buffer;
  out.page_bytes = pages->bytes;

  ImageBudget own_budget;
  out.material_textures = read_material_textures(asset);
  out.alpha_masks = std::make_shared<const AlphaMasks>(
      load_alpha_masks(asset, out.material_textures, images != nullptr ? *images : own_budget));
  if (!out.alpha_masks->damage) return out.alpha_masks->damage.error();
  find_needs(asset, out);
  const Errors errors = find_errors(asset, bounds);
  TRY(upload_tables(device, asset, instances, errors, *pages, out));
  return out;
}

}  // namespace meshlode::draw
