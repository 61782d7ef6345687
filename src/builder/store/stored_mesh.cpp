// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/store/stored_mesh.h"

#include <algorithm>
#include <cassert>

#include "base/byte_stream.h"

namespace meshlode::builder {

namespace {

constexpr std::uint32_t kVersion = 3;  // 1 knew nothing of the decision about area on the grid, 2 nothing of promises
constexpr std::size_t kFewestPageBytes = 4 * sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t);
constexpr std::size_t kFewestDecisionBytes = 2 * sizeof(std::uint64_t) + 2;

/// Whether [first, first + count) lies in a table of `size`.
bool is_range(std::uint64_t first, std::uint64_t count, std::size_t size) {
  return first <= size && count <= size - first;
}

bool are_groups_sound(const EncodedMesh& mesh) {
  return std::all_of(mesh.groups.begin(), mesh.groups.end(), [&](const format::GroupRecord& group) {
    return group.cluster_count > 0 && is_range(group.first_cluster, group.cluster_count, mesh.clusters.size()) &&
           group.page < mesh.pages.size();
  });
}

bool are_clusters_sound(const EncodedMesh& mesh) {
  return std::all_of(mesh.clusters.begin(), mesh.clusters.end(), [&](const format::ClusterRecord& cluster) {
    return (cluster.own_group == format::kNone || cluster.own_group < mesh.groups.size()) &&
           cluster.coarser_group < mesh.groups.size();
  });
}

bool are_nodes_sound(const EncodedMesh& mesh) {
  return std::all_of(mesh.nodes.begin(), mesh.nodes.end(), [&](const format::NodeRecord& node) {
    return node.child_count == 0 ? node.first < mesh.groups.size()
                                 : is_range(node.first, node.child_count, mesh.nodes.size());
  });
}

bool are_pages_sound(const EncodedMesh& mesh) {
  std::uint64_t groups = 0, clusters = 0;
  for (const EncodedMesh::Page& page : mesh.pages) {
    if (page.first_group != groups || page.first_cluster != clusters || page.group_count == 0) return false;
    groups += page.group_count;
    clusters += page.cluster_count;
    const std::size_t size = page.bytes.size();
    if (size < kPageFrameBytes || size > format::kMaxPageBytes || size % sizeof(std::uint32_t) != 0) return false;
    for (const std::uint32_t needed : page.dependencies) {
      if (needed >= mesh.pages.size()) return false;
    }
  }
  return groups == mesh.groups.size() && clusters == mesh.clusters.size();
}

bool is_record_sound(const EncodedMesh& mesh) {
  const format::MeshRecord& record = mesh.record;
  return record.uv_set_count <= format::kMaxUvSets && record.has_color <= 1 &&
         record.group_count == mesh.groups.size() && record.cluster_count == mesh.clusters.size() &&
         record.node_count == mesh.nodes.size() &&
         (mesh.promise_errors.empty() || mesh.promise_errors.size() == mesh.groups.size());
}

bool read_pages(ByteReader& in, EncodedMesh& mesh) {
  std::uint64_t count = 0;
  if (!in.count(count, kFewestPageBytes)) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    EncodedMesh::Page& page = mesh.pages.emplace_back();
    if (!in.value(page.first_group) || !in.value(page.group_count) || !in.value(page.first_cluster) ||
        !in.value(page.cluster_count) || !in.list(page.bytes) || !in.list(page.dependencies)) {
      return false;
    }
  }
  return true;
}

bool read_decisions(ByteReader& in, const std::string& label, std::vector<PlanDecision>& decisions) {
  std::uint64_t count = 0;
  if (!in.count(count, kFewestDecisionBytes)) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    PlanDecision& decision = decisions.emplace_back();
    std::uint8_t kept = 0, is_loss = 0;
    if (!in.text(decision.what) || !in.text(decision.reason) || !in.value(kept) || !in.value(is_loss)) return false;
    decision.what.insert(0, label);
    decision.kept = kept != 0;
    decision.is_loss = is_loss != 0;
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> stored_mesh_bytes(const EncodedMesh& mesh, std::span<const PlanDecision> decisions,
                                            const std::string& label) {
  ByteWriter out;
  out.value(kVersion);
  out.value(mesh.record);
  out.list(mesh.groups);
  out.list(mesh.clusters);
  out.list(mesh.nodes);
  out.value(mesh.promise);
  out.list(mesh.promise_errors);
  out.value(std::uint64_t{mesh.pages.size()});
  for (const EncodedMesh::Page& page : mesh.pages) {
    out.value(page.first_group);
    out.value(page.group_count);
    out.value(page.first_cluster);
    out.value(page.cluster_count);
    out.list(page.bytes);
    out.list(page.dependencies);
  }
  out.value(std::uint64_t{decisions.size()});
  for (const PlanDecision& decision : decisions) {
    assert(decision.what.starts_with(label));
    out.text(decision.what.substr(label.size()));
    out.text(decision.reason);
    out.value(static_cast<std::uint8_t>(decision.kept));
    out.value(static_cast<std::uint8_t>(decision.is_loss));
  }
  return out.take();
}

std::optional<StoredMesh> read_stored_mesh(std::span<const std::uint8_t> bytes, const std::string& label) {
  ByteReader in(bytes);
  StoredMesh out;
  EncodedMesh& mesh = out.encoded;
  std::uint32_t version = 0;
  if (!in.value(version) || version != kVersion || !in.value(mesh.record) || !in.list(mesh.groups) ||
      !in.list(mesh.clusters) || !in.list(mesh.nodes) || !in.value(mesh.promise) || !in.list(mesh.promise_errors) ||
      !read_pages(in, mesh) || !read_decisions(in, label, out.decisions) || !in.is_at_end()) {
    return std::nullopt;
  }
  const bool is_sound = is_record_sound(mesh) && are_groups_sound(mesh) && are_clusters_sound(mesh) &&
                        are_nodes_sound(mesh) && are_pages_sound(mesh);
  return is_sound ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace meshlode::builder
