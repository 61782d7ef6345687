// SPDX-License-Identifier: GPL-3.0-or-later
// The glTF document of a cut: the asset's own scene document with its geometry put back. Everything that is not
// geometry (nodes, materials, textures, cameras, lights, animations, extras) is carried through as it was imported.
//
// Far-away meshes: a float32 POSITION cannot hold both a large origin and small features. Where adding the origin would
// cost more than the grid can bear, positions stay relative to the origin and the mesh moves into a child node that is
// translated by it (`choose_origin`); the node's own transform, animation and children are not touched.
#include "app/export/export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/export/attach_meshes.h"
#include "app/export/carry_contents.h"
#include "app/export/cut_geometry.h"
#include "app/export/float_positions.h"
#include "app/export/glb_file.h"
#include "app/export/gltf_document.h"
#include "app/export/sniff.h"
#include "app/export/write_primitive.h"
#include "app/report/read_meta.h"
#include "base/guarded.h"
#include "base/json_handle.h"
#include "base/try.h"

namespace meshlode::app {
namespace {

using Json = GltfJson;

constexpr std::size_t kMaxDepth = 200;  // of JSON nesting: copying and writing a document are recursive

/// Extensions that describe how geometry was stored; the exported geometry is plain.
constexpr std::array<std::string_view, 5> kGeometryExtensions = {"EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
                                                                 "KHR_meshopt_compression",
                                                                 "KHR_draco_mesh_compression", "KHR_mesh_quantization"};

/// A mesh of the asset in an exported one: the mesh itself, or a part of it that the asset has as a mesh of its own.
struct Member {
  const format::MeshRecord& record;
  const LodChain& chain;
  std::vector<std::vector<CutPrimitive>> levels = {};

  [[nodiscard]] Vec3d origin() const { return {record.origin[0], record.origin[1], record.origin[2]}; }
};

/// A level is meant until the next one of every member is good enough, in shares of the largest one's size.
std::vector<double> join_coverage(std::span<const Member> members, std::size_t level_count) {
  if (members.size() == 1) return members[0].chain.screen_coverage;
  double diagonal = 0.0;
  for (const Member& member : members) diagonal = std::max(diagonal, member.record.diagonal);
  std::vector<double> joined(level_count, 1.0);
  for (const auto& [record, chain, levels] : members) {
    if (chain.screen_coverage.empty()) return {};
    const double scale = record.diagonal > 0.0 ? diagonal / record.diagonal : 1.0;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
      joined[k] = std::min(joined[k], scale * chain.screen_coverage[k]);
    }
  }
  joined.back() = 0.0;
  for (std::size_t k = 1; k < level_count; ++k) joined[k] = std::min(joined[k], joined[k - 1]);
  return joined;
}

class Exporter {
 public:
  Exporter(const run::Asset& asset, std::span<const LodChain> chains, Packing packing)
      : asset_(asset), chains_(chains), packing_(packing) {}
  Result<std::vector<std::uint8_t>> run();

 private:
  Result<std::vector<Member>> gather_members(std::span<const MeshId> member_ids) const;
  Status find_steps(std::span<const std::vector<MeshId>> meshes);
  Status add_mesh(std::size_t mesh, std::span<const MeshId> member_ids);
  Status place_mesh(std::span<const Member> members, ExportedMesh& exported) const;
  Status add_primitives(const Member& member, const Json* source, std::span<CutPrimitive> primitives,
                        const ExportedMesh& exported, Json& json);
  void finish_document(bool has_lods);

  const run::Asset& asset_;
  std::span<const LodChain> chains_;
  Packing packing_;
  std::vector<std::size_t> origins_ = origins_of_meshes(read_meta(asset_.meta_json()), asset_.meshes().size());
  Json document_;
  Json meshes_ = Json::array();
  std::vector<ExportedMesh> exported_;
  std::map<double, double> steps_;  ///< of quantized positions, by the step of a mesh's grid
  GlbBinary binary_;
  PrimitiveWriter primitives_{asset_, document_, binary_, packing_};
};

/// What the document has for the primitives of a mesh, by material (KHR_materials_variants); null: the default one.
std::map<Json, const Json*> extensions_by_material(const Json* mesh) {
  std::map<Json, const Json*> out;
  if (mesh == nullptr || !mesh->is_object()) return out;
  const auto carried = mesh->find("primitives");
  if (carried == mesh->end() || !carried->is_array()) return out;
  for (const Json& one : *carried) {
    if (!one.is_object() || !one.contains("extensions") || !one.at("extensions").is_object()) continue;
    out.try_emplace(one.value("material", Json()), &one.at("extensions"));
  }
  return out;
}

Status Exporter::add_primitives(const Member& member, const Json* source, std::span<CutPrimitive> primitives,
                                const ExportedMesh& exported, Json& json) {
  const auto extensions = extensions_by_material(source);
  for (CutPrimitive& primitive : primitives) {
    TRY_LET(made, primitives_.write(member.record, primitive, member.origin() - exported.translation, exported.step));
    const auto known = extensions.find(made->value("material", Json()));
    if (known != extensions.end()) (*made)["extensions"] = *known->second;
    json["primitives"].push_back(std::move(*made));
  }
  return Ok{};
}

FrameOfPositions collect_positions(std::span<const Member> members) {
  FrameOfPositions positions;
  for (const Member& member : members) {
    for (const auto& level : member.levels) positions.add(member.record, level);
  }
  return positions;
}

/// Meshes of one grid may share a border (`build --grid`), which stays closed where they have one step.
Status Exporter::find_steps(std::span<const std::vector<MeshId>> meshes) {
  for (const std::vector<MeshId>& member_ids : meshes) {
    TRY_LET(members, gather_members(member_ids));
    const FrameOfPositions positions = collect_positions(*members);
    double& step = steps_[positions.grid_step()];
    step = std::max(step, positions.frame(step).step);
  }
  return Ok{};
}

/// What all levels of a mesh stand in: a viewer puts one in the place of another.
Status Exporter::place_mesh(std::span<const Member> members, ExportedMesh& exported) const {
  if (!packing_.quantize) {
    // Of the members one decides, unless its floats hold the origin.
    for (const Member& member : members) {
      if (!exported.is_moved()) exported.translation = member.origin() - choose_origin(member.record, member.levels);
    }
    return Ok{};
  }
  const FrameOfPositions positions = collect_positions(members);
  const QuantizedFrame frame = positions.frame(steps_.at(positions.grid_step()));
  // Readers have the transforms of nodes as floats.
  const bool is_held =
      std::isnormal(static_cast<float>(frame.step)) && std::isfinite(static_cast<float>(frame.origin.x)) &&
      std::isfinite(static_cast<float>(frame.origin.y)) && std::isfinite(static_cast<float>(frame.origin.z));
  if (!is_held) {
    return Error{ErrorCode::kUnsupported, std::string(asset_.string(members.front().record.name)),
                 "a position does not fit glTF's 32-bit floats"};
  }
  exported.translation = frame.origin;
  exported.step = frame.step;
  return Ok{};
}

Result<std::vector<Member>> Exporter::gather_members(std::span<const MeshId> member_ids) const {
  std::vector<Member> members;
  for (const MeshId id : member_ids) {
    Member member{asset_.meshes()[id.value], chains_[id.value]};
    for (const std::vector<ClusterId>& cut : member.chain.cuts) {
      TRY_LET(primitives, gather_cut(asset_, id, cut));
      if (!primitives->empty()) member.levels.push_back(std::move(*primitives));
    }
    if (!member.levels.empty()) members.push_back(std::move(member));
  }
  return members;
}

/// The source's mesh with this index, of what the asset has of it. A level that a member lacks is its coarsest.
Status Exporter::add_mesh(std::size_t mesh, std::span<const MeshId> member_ids) {
  ExportedMesh& exported = exported_.emplace_back();
  TRY_LET(gathered, gather_members(member_ids));
  std::vector<Member>& members = *gathered;
  if (members.empty()) return Ok{};
  std::size_t level_count = 0;
  for (const Member& member : members) level_count = std::max(level_count, member.levels.size());
  TRY(place_mesh(members, exported));
  exported.screen_coverage = join_coverage(members, level_count);
  const Json* source = find_element(document_, "meshes", mesh);
  if (source != nullptr && source->is_object() && source->contains("name")) exported.name = source->at("name");
  if (exported.name.empty()) exported.name = asset_.string(asset_.meshes()[mesh].name);
  for (std::size_t k = 0; k < level_count; ++k) {
    Json json = {{"primitives", Json::array()}};
    for (Member& member : members) {
      auto& level = member.levels[std::min(k, member.levels.size() - 1)];
      TRY_LET(added, add_primitives(member, source, level, exported, json));
    }
    const std::string name = k == 0 || exported.name.empty() ? exported.name : level_name(exported.name, k);
    if (!name.empty()) json["name"] = name;
    if (source != nullptr && source->is_object() && source->contains("extras")) json["extras"] = source->at("extras");
    exported.levels.push_back(static_cast<std::uint32_t>(meshes_.size()));
    meshes_.push_back(std::move(json));
  }
  return Ok{};
}

void Exporter::finish_document(bool has_lods) {
  document_.erase("meshes");
  document_.erase("skins");
  if (!meshes_.empty()) document_["meshes"] = std::move(meshes_);
  if (!binary_.bytes().empty()) document_["buffers"] = Json::array({{{"byteLength", binary_.bytes().size()}}});
  const bool is_compressed = primitives_.fallback_bytes() > 0;
  if (is_compressed) {
    document_["buffers"].push_back({{"byteLength", primitives_.fallback_bytes()},
                                    {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  }
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const auto it = document_.find(key);
    if (it == document_.end()) continue;
    Json kept = Json::array();
    for (const Json& name : *it) {
      const bool is_geometry = name.is_string() && std::find(kGeometryExtensions.begin(), kGeometryExtensions.end(),
                                                             name.get<std::string>()) != kGeometryExtensions.end();
      if (!is_geometry) kept.push_back(name);
    }
    if (kept.empty())
      document_.erase(key);
    else
      document_[key] = std::move(kept);
  }
  if (has_lods) use_extension(document_, "MSFT_lod", false);
  if (packing_.quantize && document_.contains("meshes")) use_extension(document_, "KHR_mesh_quantization", true);
  if (is_compressed) use_extension(document_, "EXT_meshopt_compression", true);
  // glTF wants every top-level list to have an element.
  for (auto it = document_.begin(); it != document_.end();) {
    it = it->is_array() && it->empty() ? document_.erase(it) : std::next(it);
  }
  Json& asset = document_["asset"];
  if (!asset.is_object()) asset = Json::object();
  asset["version"] = "2.0";
  asset["generator"] = "meshlode";
}

Result<std::vector<std::uint8_t>> Exporter::run() {
  const std::string_view text = asset_.scene_json();
  if (nests_deeper_than(text, kMaxDepth)) return malformed("JSON nests too deep");
  document_ = text.empty() ? Json::object() : Json::parse(text, nullptr, false);
  if (!document_.is_object()) return malformed("not a JSON object");
  TRY(check_arrays(document_, {"accessors", "bufferViews", "buffers", "extensionsRequired", "extensionsUsed", "images",
                               "nodes", "textures"}));
  TRY(carry_contents(asset_, document_, binary_));
  exported_.reserve(asset_.meshes().size());
  std::vector<std::vector<MeshId>> members(origins_.size());
  for (std::size_t m = 0; m < origins_.size(); ++m) members[origins_[m]].emplace_back(m);
  if (packing_.quantize) {
    TRY(find_steps(members));
  }
  for (std::size_t m = 0; m < members.size(); ++m) {
    TRY(add_mesh(m, members[m]));
  }
  TRY_LET(has_lods, attach_meshes(asset_, origins_, exported_, document_));
  finish_document(*has_lods);
  // Names of records need not be UTF-8; what is not is replaced, never refused.
  const std::string json = document_.dump(-1, ' ', false, Json::error_handler_t::replace);
  return assemble_glb(json, binary_.bytes());
}

bool is_sound(const LodChain& chain) {
  const std::vector<double>& coverage = chain.screen_coverage;
  const auto falls = [](double a, double b) { return a < b; };
  return coverage.empty() ||
         (coverage.size() == chain.cuts.size() && std::is_sorted(coverage.rbegin(), coverage.rend(), falls) &&
          std::all_of(coverage.begin(), coverage.end(), [](double c) { return c >= 0.0 && c <= 1.0; }));
}

}  // namespace

Result<std::vector<std::uint8_t>> export_glb(const run::Asset& asset,
                                             std::span<const std::vector<ClusterId>> cut_per_mesh, Packing packing) {
  std::vector<LodChain> chains(cut_per_mesh.size());
  for (std::size_t m = 0; m < chains.size(); ++m) chains[m].cuts = {cut_per_mesh[m]};
  return export_glb_lods(asset, chains, packing);
}

Result<std::vector<std::uint8_t>> export_glb_lods(const run::Asset& asset, std::span<const LodChain> chain_per_mesh,
                                                  Packing packing) {
  if (chain_per_mesh.size() != asset.meshes().size()) {
    return Error{ErrorCode::kUsage, "", "one cut per mesh is needed"};
  }
  for (std::size_t m = 0; m < chain_per_mesh.size(); ++m) {
    const LodChain& chain = chain_per_mesh[m];
    const bool has_gap = chain.cuts.size() > 1 &&
                         std::any_of(chain.cuts.begin(), chain.cuts.end(), [](const auto& cut) { return cut.empty(); });
    if (has_gap || !is_sound(chain)) {
      return Error{ErrorCode::kUsage, "mesh " + std::to_string(m), "its levels and coverage values are not a chain"};
    }
  }
  std::uint64_t bytes = 0;
  for (const LodChain& chain : chain_per_mesh) {
    for (const auto& cut : chain.cuts) {
      const bool is_known =
          std::all_of(cut.begin(), cut.end(), [&](ClusterId id) { return id.value < asset.clusters().size(); });
      if (is_known) bytes += run::count_decoded_bytes(asset, cut);  // others are refused where they are gathered
    }
  }
  TRY(run::check_decoded_bytes(asset, bytes));
  return guarded({}, [&]() -> Result<std::vector<std::uint8_t>> {
    try {
      return Exporter(asset, chain_per_mesh, packing).run();
    } catch (const Json::exception& failure) {
      return malformed(failure.what());  // the document is a file's, and of a shape that glTF does not allow
    }
  });
}

}  // namespace meshlode::app
