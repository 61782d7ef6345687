// SPDX-License-Identifier: GPL-3.0-or-later
// Corners first, vertices afterwards: only vertices that triangles name are read where a primitive names few of many,
// because exporters let hundreds of primitives share one vertex buffer and copying it for each would explode.
#include "scene/import/gltf/primitive.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "base/byte_size.h"
#include "base/try.h"
#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/corners.h"
#include "scene/import/gltf/draco_decode.h"
#include "scene/import/gltf/normals.h"

namespace meshlode::scene {

namespace {

constexpr int kModeTriangles = TINYGLTF_MODE_TRIANGLES;
constexpr int kModeStrip = TINYGLTF_MODE_TRIANGLE_STRIP;

/// Where the vertices and corners of a primitive come from: accessors or a Draco mesh.
struct PrimitiveSource {
  std::map<std::string, AccessorReader> attributes;
  std::uint64_t vertex_count = 0;
  std::optional<AccessorReader> indices;
  std::optional<DracoMesh> draco;  ///< owns what the readers point into
};

class PrimitiveReader {
 public:
  PrimitiveReader(PrimitiveContext& context, std::size_t mesh, std::size_t primitive, const Json& json,
                  ImportDrops& drops)
      : asset_(*context.asset),
        context_(context),
        drops_(drops),
        path_("/meshes/" + std::to_string(mesh) + "/primitives/" + std::to_string(primitive)),
        what_("mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive)),
        source_(asset_.model.meshes[mesh].primitives[primitive]),
        json_(json) {}

  Result<std::optional<Primitive>> run(VertexWeights* weights);

 private:
  using Positions = std::vector<Vec3d>;

  void leave_out(const std::string& part, std::string why) {
    context_.left_out->push_back({part.empty() ? what_ : what_ + " " + part, std::move(why)});
  }
  Error no_budget(const std::string& path) const {
    return asset_.invalid(path, "it decodes to more than the size of the file justifies (and, where compressed, " +
                                    byte_size_text(context_.options->max_decoded) + " of --max-decoded)");
  }
  const Json* draco_json() const {
    const Json* extensions = json_.find("extensions");
    return extensions != nullptr ? extensions->find("KHR_draco_mesh_compression") : nullptr;
  }
  const tinygltf::Accessor& accessor(int index) const { return asset_.model.accessors[index]; }
  Result<AccessorReader> open_accessor(int index);
  Status open_accessors();
  Status open_draco(const Json& draco);
  Status check_types() const;
  Result<std::vector<std::uint32_t>> read_triangles();
  Status read_positions(std::vector<std::uint32_t>& corners);
  void keep_used(const std::vector<std::uint32_t>& corners);
  Status read_attributes();
  void read_normals(const AccessorReader& reader);
  void read_uvs(const AccessorReader& reader, std::size_t set);
  [[nodiscard]] bool has_whole_colors(const AccessorReader& reader) const;
  void read_colors(const AccessorReader& reader);
  Status read_weights(VertexWeights& out);
  /// The source vertex that stored vertex i was.
  [[nodiscard]] std::uint64_t source_vertex(std::size_t i) const { return is_compact_ ? used_[i] : i; }

  const GltfAsset& asset_;
  PrimitiveContext& context_;
  ImportDrops& drops_;
  std::string path_, what_;
  const tinygltf::Primitive& source_;
  const Json& json_;
  PrimitiveSource in_;
  bool is_compact_ = false;
  std::vector<std::uint32_t> used_;  ///< sorted source vertices, where is_compact_
  Primitive out_;
};

Result<AccessorReader> PrimitiveReader::open_accessor(int index) {
  if (!context_.budget->take(sparse_count_of(accessor(index)))) return no_budget(path_);
  return AccessorReader::open(asset_, index);
}

Status PrimitiveReader::open_accessors() {
  for (const auto& [name, index] : source_.attributes) {
    TRY_LET(reader, open_accessor(index));
    in_.attributes.emplace(name, *reader);
  }
  if (source_.indices >= 0) {
    TRY_LET(reader, open_accessor(source_.indices));
    in_.indices = *reader;
  }
  in_.vertex_count = in_.attributes.at("POSITION").count();
  return Ok{};
}

Status PrimitiveReader::open_draco(const Json& draco) {
  const std::string path = path_ + "/extensions/KHR_draco_mesh_compression";
  if (source_.mode != kModeTriangles && source_.mode != kModeStrip) {
    return asset_.invalid(path_ + "/mode", "KHR_draco_mesh_compression is for triangles and triangle strips");
  }
  DracoExpectation expected;
  expected.point_count = accessor(source_.attributes.at("POSITION")).count;
  // A strip comes out of Draco as a list of triangles; without indices only the vertices bound it.
  const bool has_indices = source_.indices >= 0;
  const std::uint64_t index_count = has_indices ? accessor(source_.indices).count : 12 * expected.point_count;
  expected.is_face_count_exact = has_indices && source_.mode == kModeTriangles;
  expected.max_face_count = source_.mode == kModeStrip && has_indices ? index_count : index_count / 3;
  std::map<std::string, std::uint32_t> ids;
  for (const JsonMember& member : *draco.find("attributes")->object()) {
    if (!source_.attributes.contains(member.key)) {
      return asset_.invalid(path + "/attributes", "an attribute that the primitive does not have");
    }
    ids[member.key] = static_cast<std::uint32_t>(member.value.index().value_or(0));
    expected.attribute_ids.push_back(ids[member.key]);
  }
  if (!ids.contains("POSITION")) return asset_.invalid(path + "/attributes", "POSITION is missing");
  expected.max_bytes = context_.budget->left_bytes();
  if (!context_.budget->take(expected.point_count + 3 * expected.max_face_count)) return no_budget(path);
  TRY_LET(bytes, asset_.view_bytes(draco.find("bufferView")->index().value_or(0), path + "/bufferView"));
  auto mesh = decode_draco(*bytes, expected);
  if (!mesh) return asset_.error(mesh.error().code, path, mesh.error().detail);
  in_.draco = std::move(*mesh);
  in_.vertex_count = in_.draco->point_count;
  for (const auto& [name, index] : source_.attributes) {
    const auto id = ids.find(name);
    if (id == ids.end()) {
      // An attribute beside the compressed ones is an ordinary accessor.
      TRY_LET(reader, open_accessor(index));
      in_.attributes.emplace(name, *reader);
      continue;
    }
    const DracoAttribute& attribute = in_.draco->attributes.at(id->second);
    in_.attributes.emplace(name, AccessorReader::over(attribute.bytes, in_.vertex_count, attribute.component_type,
                                                      attribute.component_count, accessor(index).normalized));
  }
  return Ok{};
}

Status PrimitiveReader::check_types() const {
  for (const auto& [name, reader] : in_.attributes) {
    const std::string path = path_ + "/attributes/" + name;
    const std::uint32_t n = reader.component_count();
    const bool is_float = reader.component_type() == kGltfFloat;
    const bool is_small = reader.component_type() != kGltfFloat && reader.component_type() != kGltfUnsignedInt;
    bool is_known = true;
    bool is_right = true;
    if (name == "POSITION" || name == "NORMAL") {
      is_right = n == 3 && (is_float || is_small);
    } else if (name.starts_with("TEXCOORD_")) {
      is_right = n == 2 && (is_float || is_small);
    } else if (name == "COLOR_0") {
      is_right = (n == 3 || n == 4) && (is_float || is_small);
    } else {
      is_known = false;
    }
    if (!is_right) return asset_.invalid(path, "an accessor type that this attribute cannot have");
    if (is_known && reader.count() != in_.vertex_count) {
      return asset_.invalid(
          path, std::to_string(reader.count()) + " elements where POSITION has " + std::to_string(in_.vertex_count));
    }
  }
  if (in_.indices) {
    const std::uint32_t type = in_.indices->component_type();
    if (in_.indices->component_count() != 1 ||
        (type != kGltfUnsignedByte && type != kGltfUnsignedShort && type != kGltfUnsignedInt)) {
      return asset_.invalid(path_ + "/indices", "not a scalar accessor of an unsigned integer type");
    }
  }
  return Ok{};
}

/// Three corners per triangle, each below vertex_count.
Result<std::vector<std::uint32_t>> PrimitiveReader::read_triangles() {
  if (in_.draco) return in_.draco->indices;
  CornerSource source;
  source.indices = in_.indices ? &*in_.indices : nullptr;
  source.mode = source_.mode;
  source.vertex_count = in_.vertex_count;
  source.may_restart = context_.has_restarts;
  source.repair = context_.options->repair;
  if (!context_.budget->take(3 * source.triangle_count())) return no_budget(path_);
  if (const std::uint64_t rest = source_.mode == kModeTriangles ? source.count() % 3 : 0; rest != 0) {
    leave_out("", "its last " + std::to_string(rest) + " corners make no triangle");
  }
  auto corners = read_corners(source);
  if (!corners) return asset_.invalid(path_ + "/indices", corners.error().detail);
  if (corners->restarts != 0 && !context_.has_restarts) {
    leave_out("indices",
              std::to_string(corners->restarts) + " restart values that no extension allows; it is split there");
  }
  drops_.repaired += corners->broken;
  if (corners->broken != 0) is_compact_ = true;
  return std::move(corners->vertices);
}

void PrimitiveReader::keep_used(const std::vector<std::uint32_t>& corners) {
  used_ = corners;
  std::sort(used_.begin(), used_.end());
  used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
}

/// Reads positions, drops triangles with broken ones (repair), and leaves corners in stored vertices.
Status PrimitiveReader::read_positions(std::vector<std::uint32_t>& corners) {
  const AccessorReader& reader = in_.attributes.at("POSITION");
  // More vertices than corners: some are unused for certain.
  if (in_.vertex_count > corners.size()) is_compact_ = true;
  const auto read = [&](std::uint64_t v, Vec3d& p) {
    const auto e = reader.element(v);
    p = {e[0], e[1], e[2]};
    return std::isfinite(e[0]) && std::isfinite(e[1]) && std::isfinite(e[2]);
  };
  if (context_.options->repair) {
    std::vector<std::uint32_t> kept;
    kept.reserve(corners.size());
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      Vec3d p;
      if (read(corners[i], p) && read(corners[i + 1], p) && read(corners[i + 2], p)) {
        kept.insert(kept.end(), {corners[i], corners[i + 1], corners[i + 2]});
      } else {
        ++drops_.repaired;
      }
    }
    if (kept.size() != corners.size()) is_compact_ = true;
    corners = std::move(kept);
    for (std::uint64_t v = 0; v < in_.vertex_count && !is_compact_; ++v) {
      Vec3d p;
      if (!read(v, p)) is_compact_ = true;  // an unused vertex that must not be stored
    }
  }
  if (is_compact_) keep_used(corners);
  const std::uint64_t count = is_compact_ ? used_.size() : in_.vertex_count;
  if (!context_.budget->take(count)) return no_budget(path_);
  out_.positions.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (read(source_vertex(i), out_.positions[i])) continue;
    return asset_.invalid(path_ + "/attributes/POSITION",
                          "the position of vertex " + std::to_string(source_vertex(i)) + " is not finite");
  }
  if (is_compact_) {
    for (std::uint32_t& corner : corners) {
      corner = static_cast<std::uint32_t>(std::lower_bound(used_.begin(), used_.end(), corner) - used_.begin());
    }
  }
  return Ok{};
}

void PrimitiveReader::read_normals(const AccessorReader& reader) {
  out_.normals.resize(out_.positions.size());
  for (std::size_t i = 0; i < out_.positions.size(); ++i) {
    const auto e = reader.element(source_vertex(i));
    out_.normals[i] = Vec3f(static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2]));
  }
  if (const std::size_t bad = mend_normals(out_); bad != 0) {
    leave_out("NORMAL",
              std::to_string(bad) + " normals are not finite or have no length; the triangles' own stand in for them");
  }
}

void PrimitiveReader::read_uvs(const AccessorReader& reader, std::size_t set) {
  std::size_t bad = 0;
  auto& uvs = out_.uvs[set];
  uvs.resize(out_.positions.size());
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    const auto e = reader.element(source_vertex(i));
    uvs[i] = Vec2f(static_cast<float>(e[0]), static_cast<float>(e[1]));
    if (std::isfinite(e[0]) && std::isfinite(e[1])) continue;
    uvs[i] = Vec2f(0.0F);
    ++bad;
  }
  if (bad != 0) {
    leave_out("TEXCOORD_" + std::to_string(set),
              std::to_string(bad) + " texture coordinates are not finite; zero stands in for them");
  }
}

/// glTF has normalized whole numbers alone. Where a file forgets to say so, one above 1 tells what is meant.
bool PrimitiveReader::has_whole_colors(const AccessorReader& reader) const {
  if (reader.is_normalized() || reader.component_type() == kGltfFloat) return false;
  for (std::size_t i = 0; i < out_.positions.size(); ++i) {
    const auto e = reader.element(source_vertex(i));
    if (std::any_of(e.begin(), e.end(), [](double c) { return c > 1.0; })) return true;
  }
  return false;
}

void PrimitiveReader::read_colors(const AccessorReader& reader) {
  std::size_t bad = 0;
  out_.colors.resize(out_.positions.size());
  const bool is_whole = has_whole_colors(reader);
  if (is_whole) context_.whole_colors += out_.colors.size();
  for (std::size_t i = 0; i < out_.colors.size(); ++i) {
    auto e = reader.element(source_vertex(i), is_whole || reader.is_normalized());
    if (reader.component_count() == 3) e[3] = 1.0;
    bool is_finite = true;
    bool is_clamped = false;
    for (double& c : e) {
      is_finite = is_finite && std::isfinite(c);
      is_clamped = is_clamped || c < 0.0 || c > 1.0;
      c = std::clamp(c, 0.0, 1.0);
    }
    if (!is_finite) {
      e = {1.0, 1.0, 1.0, 1.0};
      ++bad;
    } else if (is_clamped) {
      ++context_.clamped_colors;
    }
    out_.colors[i] =
        Vec4f(static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2]), static_cast<float>(e[3]));
  }
  if (bad != 0) leave_out("COLOR_0", std::to_string(bad) + " colours are not finite; white stands in for them");
}

/// JOINTS_n and WEIGHTS_n, as many pairs as there are.
Status PrimitiveReader::read_weights(VertexWeights& out) {
  std::vector<std::pair<const AccessorReader*, const AccessorReader*>> pairs;
  for (std::size_t n = 0;; ++n) {
    const auto joints = in_.attributes.find("JOINTS_" + std::to_string(n));
    const auto weights = in_.attributes.find("WEIGHTS_" + std::to_string(n));
    if (joints == in_.attributes.end() || weights == in_.attributes.end()) break;
    for (const auto& [name, reader] : {*joints, *weights}) {
      const std::string path = path_ + "/attributes/" + name;
      if (reader.component_count() != 4)
        return asset_.invalid(path, "an accessor type that this attribute cannot have");
      if (reader.count() != in_.vertex_count) {
        return asset_.invalid(
            path, std::to_string(reader.count()) + " elements where POSITION has " + std::to_string(in_.vertex_count));
      }
    }
    pairs.emplace_back(&joints->second, &weights->second);
  }
  const std::size_t count = out_.positions.size();
  if (!context_.budget->take(2 * count * pairs.size())) return no_budget(path_);
  out.width = 4 * pairs.size();
  out.joints.reserve(count * out.width);
  out.weights.reserve(count * out.width);
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [joints, weights] : pairs) {
      const auto j = joints->element(source_vertex(i));
      const auto w = weights->element(source_vertex(i));
      for (std::size_t c = 0; c < 4; ++c) {
        out.joints.push_back(j[c] >= 0.0 && j[c] < kNoId ? static_cast<std::uint32_t>(j[c]) : kNoId);
        out.weights.push_back(w[c]);
      }
    }
  }
  return Ok{};
}

Status PrimitiveReader::read_attributes() {
  for (const auto& [name, reader] : in_.attributes) {
    const bool is_kept = name == "NORMAL" || name == "COLOR_0" ||
                         (name.size() == 10 && name.starts_with("TEXCOORD_") && name[9] >= '0' && name[9] <= '3');
    if (is_kept && !context_.budget->take(out_.positions.size())) return no_budget(path_);
    if (name == "NORMAL") {
      read_normals(reader);
    } else if (name == "COLOR_0") {
      read_colors(reader);
    } else if (is_kept) {
      read_uvs(reader, static_cast<std::size_t>(name[9] - '0'));
    } else if (name == "TANGENT") {
      out_.has_tangents = true;
    } else if (name != "POSITION" && !name.starts_with("JOINTS_") && !name.starts_with("WEIGHTS_")) {
      leave_out(name, "only POSITION, NORMAL, TEXCOORD_0 to 3 and COLOR_0 are kept");
    }
  }
  return Ok{};
}

Result<std::optional<Primitive>> PrimitiveReader::run(VertexWeights* weights) {
  if (source_.mode < kModeTriangles) {
    leave_out("", source_.mode == 0 ? "points are not triangles" : "lines are not triangles");
    return std::optional<Primitive>{};
  }
  if (!source_.attributes.contains("POSITION")) {
    leave_out("", "it has no positions");
    return std::optional<Primitive>{};
  }
  const Json* draco = draco_json();
  TRY(draco != nullptr ? open_draco(*draco) : open_accessors());
  TRY(check_types());
  TRY_LET(corners, read_triangles());
  TRY(read_positions(*corners));
  out_.indices = std::move(*corners);
  if (source_.material >= 0) out_.material = MaterialId(static_cast<std::size_t>(source_.material));
  TRY(read_attributes());
  if (weights != nullptr) {
    TRY(read_weights(*weights));
  } else if (in_.attributes.contains("JOINTS_0")) {
    leave_out("JOINTS_0", "no node draws the mesh with a skin; joints and weights are left out");
  }
  return std::optional<Primitive>(std::move(out_));
}

}  // namespace

Result<std::optional<Primitive>> read_primitive(PrimitiveContext& context, std::size_t mesh, std::size_t primitive,
                                                const Json& json, ImportDrops& drops, VertexWeights* weights) {
  return PrimitiveReader(context, mesh, primitive, json, drops).run(weights);
}

}  // namespace meshlode::scene
