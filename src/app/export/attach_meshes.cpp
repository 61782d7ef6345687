// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/attach_meshes.h"

#include <cmath>
#include <utility>

#include "base/try.h"

namespace meshlode::app {
namespace {

using Json = GltfJson;

/// Nothing but a name: no transform, no children, nothing that something else could replace.
bool is_plain_node(const Json& node) {
  return node.size() == node.count("name");
}

class NodeWriter {
 public:
  NodeWriter(const run::Asset& asset, std::span<const std::size_t> origins, std::span<const ExportedMesh> exported,
             Json& document)
      : asset_(asset), origins_(origins), exported_(exported), document_(document) {}
  Result<bool> run();

 private:
  Status make_instance_nodes();
  Status attach_mesh(std::size_t node);
  void attach_levels(std::size_t node, const ExportedMesh& mesh);

  const run::Asset& asset_;
  std::span<const std::size_t> origins_;
  std::span<const ExportedMesh> exported_;
  Json& document_;
  bool has_lods_ = false;
};

/// No scene graph in the source (PLY, arrays in memory): one root node for each instance.
Status NodeWriter::make_instance_nodes() {
  Json nodes = Json::array();
  Json roots = Json::array();
  for (const format::InstanceRecord& instance : asset_.instances()) {
    if (origins_[instance.mesh] != instance.mesh) continue;
    Json node = {{"mesh", instance.mesh}};
    if (const auto name = asset_.string(instance.name); !name.empty()) node["name"] = std::string(name);
    Json matrix = Json::array();
    bool is_identity = true;
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t row = 0; row < 4; ++row) {
        const double value = row < 3 ? instance.transform[row * 4 + column] : (column == 3 ? 1.0 : 0.0);
        if (!std::isfinite(value)) return malformed("an instance's transform is not finite");
        is_identity = is_identity && value == (row == column ? 1.0 : 0.0);
        matrix.push_back(value);
      }
    }
    if (!is_identity) node["matrix"] = std::move(matrix);
    roots.push_back(nodes.size());
    nodes.push_back(std::move(node));
  }
  if (nodes.empty()) return Ok{};
  document_["nodes"] = std::move(nodes);
  document_["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
  document_["scene"] = 0;
  return Ok{};
}

/// The coarser levels become nodes that no scene has: MSFT_lod names them. Whether such a node stands in the frame of
/// the node that names it, or in that of its parent, and whether it replaces the children too, readers see differently;
/// so the node that names them is one without transform or children, where the two are the same.
void NodeWriter::attach_levels(std::size_t node, const ExportedMesh& mesh) {
  Json& nodes = array_of(document_, "nodes");
  nodes[node]["mesh"] = mesh.levels.front();
  if (mesh.levels.size() == 1) return;
  Json ids = Json::array();
  for (std::size_t k = 1; k < mesh.levels.size(); ++k) {
    Json level = {{"mesh", mesh.levels[k]}};
    const Json name = nodes[node].value("name", Json());
    if (name.is_string()) level["name"] = level_name(name.get<std::string>(), k);
    ids.push_back(nodes.size());
    nodes.push_back(std::move(level));
  }
  nodes[node]["extensions"]["MSFT_lod"] = {{"ids", std::move(ids)}};
  if (!mesh.screen_coverage.empty()) nodes[node]["extras"]["MSFT_screencoverage"] = mesh.screen_coverage;
  has_lods_ = true;
}

/// Gives a node that draws a mesh its exported mesh, or none where the cut is empty.
Status NodeWriter::attach_mesh(std::size_t i) {
  Json& nodes = array_of(document_, "nodes");
  Json& node = nodes[i];
  node.erase("skin");  // the static triangles were built: skins and morph targets are not in the asset
  node.erase("weights");
  if (!node.contains("mesh")) return Ok{};
  const auto index = node.at("mesh").get<std::size_t>();
  if (index >= exported_.size()) return malformed("mesh " + std::to_string(index) + " does not exist");
  const ExportedMesh& mesh = exported_[index];
  node.erase("mesh");
  if (mesh.levels.empty()) return Ok{};
  const bool is_fixed = is_plain_node(node) && !document_.contains("animations");
  const bool needs_frame = mesh.levels.size() > 1 && !is_fixed;
  if (!mesh.is_moved() && !needs_frame) {
    attach_levels(i, mesh);
    return Ok{};
  }
  TRY(check_arrays(node, {"children"}));
  std::size_t holder = i;
  const auto add_child = [&](const char* suffix) {
    Json child = Json::object();
    if (nodes[i].contains("name")) child["name"] = nodes[i].at("name").get<std::string>() + suffix;
    array_of(nodes[holder], "children").push_back(nodes.size());
    holder = nodes.size();
    nodes.push_back(std::move(child));  // `node` dangles from here on
  };
  if (mesh.is_moved()) {
    add_child(" (origin)");
    nodes[holder]["translation"] = {mesh.translation.x, mesh.translation.y, mesh.translation.z};
    if (mesh.step > 0.0) nodes[holder]["scale"] = {mesh.step, mesh.step, mesh.step};
  }
  if (mesh.levels.size() > 1) add_child(" (levels)");
  attach_levels(holder, mesh);
  return Ok{};
}

Result<bool> NodeWriter::run() {
  if (!document_.contains("nodes")) {
    TRY(make_instance_nodes());
    if (!document_.contains("nodes")) return false;
  }
  Json& nodes = array_of(document_, "nodes");
  for (const format::InstanceRecord& instance : asset_.instances()) {
    if (instance.node < nodes.size() && !nodes[instance.node].contains("mesh")) {
      nodes[instance.node]["mesh"] = origins_[instance.mesh];
    }
  }
  const std::size_t node_count = nodes.size();
  for (std::size_t i = 0; i < node_count; ++i) {
    TRY(attach_mesh(i));
  }
  return has_lods_;
}

}  // namespace

std::string level_name(const std::string& name, std::size_t level) {
  return name + " (level " + std::to_string(level) + ")";
}

Result<bool> attach_meshes(const run::Asset& asset, std::span<const std::size_t> origins,
                           std::span<const ExportedMesh> exported, GltfJson& document) {
  return NodeWriter(asset, origins, exported, document).run();
}

}  // namespace meshlode::app
