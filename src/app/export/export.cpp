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
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/export/cut_geometry.h"
#include "app/export/float_positions.h"
#include "app/export/glb_file.h"
#include "app/export/gltf_document.h"
#include "app/export/sniff.h"
#include "app/export/write_primitive.h"
#include "app/report/read_meta.h"
#include "base/guarded.h"
#include "base/hash.h"
#include "base/json_handle.h"
#include "base/try.h"
#include "format/names.h"

namespace meshlode::app {
namespace {

using Json = GltfJson;

constexpr std::size_t kMaxDepth = 200;  // of JSON nesting: copying and writing a document are recursive

/// Extensions that describe how geometry was stored; the exported geometry is plain.
constexpr std::array<std::string_view, 5> kGeometryExtensions = {"EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
                                                                 "KHR_meshopt_compression",
                                                                 "KHR_draco_mesh_compression", "KHR_mesh_quantization"};

struct ExportedMesh {
  std::vector<std::uint32_t> levels;  ///< indices in the glTF, the finest first; empty without primitives
  Vec3d translation{0.0};             ///< of a node to put around it
  double step = 0.0;                  ///< its scale, where positions are quantized; else 0
  std::string name;
  std::vector<double> screen_coverage;
  [[nodiscard]] bool is_moved() const { return step > 0.0 || translation != Vec3d(0.0); }
};

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

/// Whether each of these members is an array, where it is there.
Status check_arrays(const Json& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto it = object.find(key);
    if (it != object.end() && !it->is_null() && !it->is_array())
      return malformed(std::string("/") + key + " is not an array");
  }
  return Ok{};
}

std::string level_name(const std::string& name, std::size_t level) {
  return name + " (level " + std::to_string(level) + ")";
}

/// Nothing but a name: no transform, no children, nothing that something else could replace.
bool is_plain_node(const Json& node) {
  return node.size() == node.count("name");
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
  Status carry_buffers();
  Status carry_images();
  void move_texture_sources();
  void use_extension(const char* name, bool is_required);
  Status complete_materials();
  Status make_instance_nodes();
  Status attach_meshes();
  Status attach_mesh(std::size_t node);
  void attach_levels(std::size_t node, const ExportedMesh& mesh);
  void finish_document();
  Result<GlbBinary::Range> carry_blob(const format::BlobRecord& blob);
  [[nodiscard]] Result<const format::BlobRecord*> blob_of(const Json& owner) const;

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
  std::map<std::pair<std::uint64_t, std::uint64_t>, GlbBinary::Range> carried_;  ///< blobs in it, by offset and bytes
  bool has_lods_ = false;
};

/// The blob that a document entry names with its member "blob".
Result<const format::BlobRecord*> Exporter::blob_of(const Json& owner) const {
  const auto index = owner.at("blob").get<std::uint64_t>();
  if (index >= asset_.blobs().size()) return malformed("blob " + std::to_string(index) + " does not exist");
  return &asset_.blobs()[index];
}

/// The bytes of a blob in the BIN chunk: once, however many entries of the document name it. Opening an asset does not
/// look at them.
Result<GlbBinary::Range> Exporter::carry_blob(const format::BlobRecord& blob) {
  const auto [found, is_new] = carried_.try_emplace({blob.offset, blob.bytes});
  if (!is_new) return found->second;
  const std::span<const std::uint8_t> bytes = asset_.blob_bytes(blob);
  if (hash64(bytes) != blob.checksum) {
    const auto index = static_cast<std::size_t>(&blob - asset_.blobs().data());
    return Error{ErrorCode::kInvalid, "blob " + std::to_string(index) + ", field checksum",
                 "does not match the stored bytes"};
  }
  found->second = binary_.append(bytes);
  return found->second;
}

/// The buffers of animations become stretches of the one BIN chunk; their views keep their indices.
Status Exporter::carry_buffers() {
  std::vector<GlbBinary::Range> ranges;
  if (const auto buffers = document_.find("buffers"); buffers != document_.end()) {
    for (const Json& buffer : *buffers) {
      TRY_LET(blob, blob_of(buffer));
      TRY_LET(range, carry_blob(**blob));
      ranges.push_back(*range);
    }
    document_.erase("buffers");
  }
  if (!document_.contains("bufferViews")) return Ok{};
  for (Json& view : array_of(document_, "bufferViews")) {
    const auto buffer = view.at("buffer").get<std::size_t>();
    if (buffer >= ranges.size()) return malformed("buffer " + std::to_string(buffer) + " does not exist");
    const GlbBinary::Range range = ranges[buffer];
    const auto offset = view.value("byteOffset", std::uint64_t{0});
    const auto bytes = view.at("byteLength").get<std::uint64_t>();
    if (offset > range.bytes || bytes > range.bytes - offset) return malformed("a view leaves its buffer");
    view["buffer"] = 0;
    view["byteOffset"] = range.offset + offset;
  }
  return Ok{};
}

Status Exporter::carry_images() {
  if (!document_.contains("images")) return Ok{};
  constexpr std::size_t kLongestName = 4096;  // a name that many images share must not be multiplied by them
  for (Json& image : array_of(document_, "images")) {
    if (!image.contains("blob")) continue;
    TRY_LET(blob, blob_of(image));
    const format::BlobRecord& record = **blob;
    const std::span<const std::uint8_t> bytes = asset_.blob_bytes(record);
    TRY_LET(range, carry_blob(record));
    image["bufferView"] = add_view(document_, *range);
    const std::string_view mime_type = asset_.string(record.mime_type);
    // The record's is that of the stored bytes; the document has the source's.
    const bool is_known = !mime_type.empty() && mime_type.size() <= kLongestName;
    if (is_known || !image.contains("mimeType")) {
      image["mimeType"] = is_known ? std::string(mime_type) : sniff_mime_type(bytes);
    }
    const std::string_view name = asset_.string(record.name);
    if (!image.contains("name") && !name.empty() && name.size() <= kLongestName) image["name"] = std::string(name);
    image.erase("blob");
    image.erase("uri");
  }
  return Ok{};
}

void Exporter::use_extension(const char* name, bool is_required) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!is_required && list == std::string_view("extensionsRequired")) continue;
    Json& names = array_of(document_, list);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

/// A texture's own source may be PNG or JPEG only. A source file that refers to others by a URI without a type gets
/// away with more; inside a GLB each image has a type, and the other types have extensions to name them by.
void Exporter::move_texture_sources() {
  if (!document_.contains("textures")) return;
  std::set<std::string_view> used;
  for (Json& texture : array_of(document_, "textures")) {
    const auto source = texture.find("source");
    if (source == texture.end() || !source->is_number_unsigned()) continue;
    const Json* image = find_element(document_, "images", source->get<std::size_t>());
    if (image == nullptr || !image->is_object()) continue;
    const Json type = image->value("mimeType", Json());
    const char* extension = type == "image/ktx2"   ? "KHR_texture_basisu"
                            : type == "image/webp" ? "EXT_texture_webp"
                                                   : "";
    if (*extension == 0) continue;
    Json& named = texture["extensions"][extension];
    if (named.is_null()) named = {{"source", *source}};
    texture.erase("source");
    used.insert(extension);
  }
  for (const std::string_view extension : used) use_extension(extension.data(), true);  // of literals
}

/// Assets that do not come from a glTF have no materials in their document: the records say what is known.
Status Exporter::complete_materials() {
  if (document_.contains("materials")) return Ok{};
  std::map<std::uint32_t, Json> by_index;
  for (const format::MaterialRecord& record : asset_.materials()) {
    if (record.source_index == format::kNone) continue;
    Json material = Json::object();
    if (const auto name = asset_.string(record.name); !name.empty()) material["name"] = std::string(name);
    Json factor = Json::array();
    for (const float c : record.base_color) factor.push_back(c);
    material["pbrMetallicRoughness"] = {{"baseColorFactor", factor}, {"metallicFactor", 0}};
    if (record.alpha_mode != format::AlphaMode::kOpaque) material["alphaMode"] = format::name_of(record.alpha_mode);
    if (record.alpha_mode == format::AlphaMode::kMask) material["alphaCutoff"] = record.alpha_cutoff;
    if (record.double_sided != 0) material["doubleSided"] = true;
    by_index.emplace(record.source_index, std::move(material));
  }
  // Indices without gaps are what the builder writes; a gap cannot be filled with anything true.
  Json materials = Json::array();
  for (auto& [index, material] : by_index) {
    if (index != materials.size()) return malformed("material indices have a gap and there is no document");
    materials.push_back(std::move(material));
  }
  if (!materials.empty()) document_["materials"] = std::move(materials);
  return Ok{};
}

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

/// No scene graph in the source (PLY, arrays in memory): one root node for each instance.
Status Exporter::make_instance_nodes() {
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
void Exporter::attach_levels(std::size_t node, const ExportedMesh& mesh) {
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
Status Exporter::attach_mesh(std::size_t i) {
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
  if (const Status s = check_arrays(node, {"children"}); !s) return s;
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

Status Exporter::attach_meshes() {
  if (!document_.contains("nodes")) {
    if (const Status s = make_instance_nodes(); !s) return s;
    if (!document_.contains("nodes")) return Ok{};
  }
  Json& nodes = array_of(document_, "nodes");
  for (const format::InstanceRecord& instance : asset_.instances()) {
    if (instance.node < nodes.size() && !nodes[instance.node].contains("mesh")) {
      nodes[instance.node]["mesh"] = origins_[instance.mesh];
    }
  }
  const std::size_t node_count = nodes.size();
  for (std::size_t i = 0; i < node_count; ++i) {
    if (const Status s = attach_mesh(i); !s) return s;
  }
  return Ok{};
}

void Exporter::finish_document() {
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
  if (has_lods_) use_extension("MSFT_lod", false);
  if (packing_.quantize && document_.contains("meshes")) use_extension("KHR_mesh_quantization", true);
  if (is_compressed) use_extension("EXT_meshopt_compression", true);
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
  TRY_LET(arrays, check_arrays(document_, {"accessors", "bufferViews", "buffers", "extensionsRequired",
                                           "extensionsUsed", "images", "nodes", "textures"}));
  TRY(carry_buffers());
  TRY(carry_images());
  move_texture_sources();
  TRY(complete_materials());
  exported_.reserve(asset_.meshes().size());
  std::vector<std::vector<MeshId>> members(origins_.size());
  for (std::size_t m = 0; m < origins_.size(); ++m) members[origins_[m]].emplace_back(m);
  if (packing_.quantize) {
    TRY(find_steps(members));
  }
  for (std::size_t m = 0; m < members.size(); ++m) {
    TRY(add_mesh(m, members[m]));
  }
  TRY(attach_meshes());
  finish_document();
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
