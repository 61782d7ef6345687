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
#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/draco_decode.h"

namespace meshlode::scene {

namespace {

constexpr int kModeTriangles = TINYGLTF_MODE_TRIANGLES;
constexpr int kModeStrip = TINYGLTF_MODE_TRIANGLE_STRIP;
constexpr int kModeFan = TINYGLTF_MODE_TRIANGLE_FAN;

/// Where the vertices and corners of a primitive come from: accessors or a Draco mesh.
struct PrimitiveSource {
  std::map<std::string, AccessorReader> attributes;
  std::uint64_t vertex_count = 0;
  std::optional<AccessorReader> indices;
  std::optional<DracoMesh> draco;  ///< owns what the readers point into
};

class PrimitiveReader {
 public:
  PrimitiveReader(const PrimitiveContext& context, std::size_t mesh, std::size_t primitive, const Json& json,
                  ImportDrops& drops)
      : asset_(*context.asset),
        context_(context),
        drops_(drops),
        path_("/meshes/" + std::to_string(mesh) + "/primitives/" + std::to_string(primitive)),
        what_("mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive)),
        source_(asset_.model.meshes[mesh].primitives[primitive]),
        json_(json) {}

  Result<std::optional<Primitive>> run();

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
  Result<std::vector<std::uint32_t>> read_corners();
  Status read_positions(std::vector<std::uint32_t>& corners);
  void keep_used(const std::vector<std::uint32_t>& corners);
  Status read_attributes();
  void read_normals(const AccessorReader& reader);
  void read_uvs(const AccessorReader& reader, std::size_t set);
  void read_colors(const AccessorReader& reader);
  /// The source vertex that stored vertex i was.
  [[nodiscard]] std::uint64_t source_vertex(std::size_t i) const { return is_compact_ ? used_[i] : i; }

  const GltfAsset& asset_;
  const PrimitiveContext& context_;
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
    auto reader = open_accessor(index);
    if (!reader) return reader.error();
    in_.attributes.emplace(name, *reader);
  }
  if (source_.indices >= 0) {
    auto reader = open_accessor(source_.indices);
    if (!reader) return reader.error();
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
  const auto bytes = asset_.view_bytes(draco.find("bufferView")->index().value_or(0), path + "/bufferView");
  if (!bytes) return bytes.error();
  auto mesh = decode_draco(*bytes, expected);
  if (!mesh) return asset_.error(mesh.error().code, path, mesh.error().detail);
  in_.draco = std::move(*mesh);
  in_.vertex_count = in_.draco->point_count;
  for (const auto& [name, index] : source_.attributes) {
    const auto id = ids.find(name);
    if (id == ids.end()) {
      // An attribute beside the compressed ones is an ordinary accessor.
      auto reader = open_accessor(index);
      if (!reader) return reader.error();
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
Result<std::vector<std::uint32_t>> PrimitiveReader::read_corners() {
  if (in_.draco) return in_.draco->indices;
  const std::uint64_t count = in_.indices ? in_.indices->count() : in_.vertex_count;
  std::uint64_t triangle_count = count / 3;
  if (source_.mode != kModeTriangles) triangle_count = count < 3 ? 0 : count - 2;
  if (!context_.budget->take(3 * triangle_count)) return no_budget(path_);
  if (const std::uint64_t rest = source_.mode == kModeTriangles ? count % 3 : 0; rest != 0) {
    leave_out("", "its last " + std::to_string(rest) + " corners make no triangle");
  }
  // "indices MUST NOT contain the maximum value of their type": it would mean primitive restart (3.7.2.1).
  std::uint64_t restart = std::numeric_limits<std::uint64_t>::max();
  if (in_.indices) {
    restart = in_.indices->component_type() == kGltfUnsignedByte    ? 0xFFu
              : in_.indices->component_type() == kGltfUnsignedShort ? 0xFFFFu
                                                                    : 0xFFFFFFFFu;
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * triangle_count);
  for (std::uint64_t t = 0; t < triangle_count; ++t) {
    std::array<std::uint64_t, 3> at{3 * t, 3 * t + 1, 3 * t + 2};
    // Every second triangle of a strip turns the other way; a fan's centre comes last.
    if (source_.mode == kModeStrip) at = {t, t + (1 + t % 2), t + (2 - t % 2)};
    if (source_.mode == kModeFan) at = {t + 1, t + 2, 0};
    std::array<std::uint32_t, 3> triangle{};
    bool is_valid = true;
    for (std::size_t c = 0; c < 3; ++c) {
      triangle[c] = in_.indices ? in_.indices->index(at[c]) : static_cast<std::uint32_t>(at[c]);
      if (triangle[c] < in_.vertex_count && triangle[c] != restart) continue;
      if (!context_.options->repair) {
        const std::string why = triangle[c] == restart
                                    ? " is the primitive restart value"
                                    : " is out of range: there are " + std::to_string(in_.vertex_count) + " vertices";
        return asset_.invalid(path_ + "/indices",
                              "index " + std::to_string(triangle[c]) + " at " + std::to_string(at[c]) + why);
      }
      is_valid = false;
    }
    if (is_valid) {
      corners.insert(corners.end(), triangle.begin(), triangle.end());
    } else {
      ++drops_.repaired;
    }
  }
  if (corners.size() != 3 * triangle_count) is_compact_ = true;
  return corners;
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
  std::vector<std::uint32_t> bad;
  out_.normals.resize(out_.positions.size());
  for (std::size_t i = 0; i < out_.positions.size(); ++i) {
    const auto e = reader.element(source_vertex(i));
    const Vec3f n(static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2]));
    out_.normals[i] = n;
    const double length = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    if (!(length > 0.0) || !std::isfinite(length)) bad.push_back(static_cast<std::uint32_t>(i));
  }
  if (bad.empty()) return;
  // A broken normal becomes the area-weighted sum of its triangles' own.
  std::vector<Vec3d> sums(bad.size(), Vec3d(0.0));
  for (std::size_t t = 0; t < out_.indices.size(); t += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto slot = std::lower_bound(bad.begin(), bad.end(), out_.indices[t + c]);
      if (slot == bad.end() || *slot != out_.indices[t + c]) continue;
      const Vec3d& p = out_.positions[out_.indices[t]];
      sums[static_cast<std::size_t>(slot - bad.begin())] +=
          glm::cross(out_.positions[out_.indices[t + 1]] - p, out_.positions[out_.indices[t + 2]] - p);
    }
  }
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const Vec3d& s = sums[i];
    const double largest = std::max({std::fabs(s.x), std::fabs(s.y), std::fabs(s.z)});
    Vec3d n(0.0, 0.0, 1.0);
    if (largest > 0.0 && std::isfinite(largest)) {
      n = s / largest;  // so that squares neither overflow nor vanish
      n /= std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    }
    out_.normals[bad[i]] = Vec3f(n);
  }
  leave_out("NORMAL", std::to_string(bad.size()) +
                          " normals are not finite or have no length; the triangles' own stand in for them");
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

void PrimitiveReader::read_colors(const AccessorReader& reader) {
  std::size_t bad = 0;
  out_.colors.resize(out_.positions.size());
  for (std::size_t i = 0; i < out_.colors.size(); ++i) {
    auto e = reader.element(source_vertex(i));
    if (reader.component_count() == 3) e[3] = 1.0;
    bool is_finite = true;
    for (double& c : e) {
      is_finite = is_finite && std::isfinite(c);
      c = std::clamp(c, 0.0, 1.0);
    }
    if (!is_finite) {
      e = {1.0, 1.0, 1.0, 1.0};
      ++bad;
    }
    out_.colors[i] =
        Vec4f(static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2]), static_cast<float>(e[3]));
  }
  if (bad != 0) leave_out("COLOR_0", std::to_string(bad) + " colours are not finite; white stands in for them");
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

Result<std::optional<Primitive>> PrimitiveReader::run() {
  if (source_.mode < kModeTriangles) {
    leave_out("", source_.mode == 0 ? "points are not triangles" : "lines are not triangles");
    return std::optional<Primitive>{};
  }
  if (!source_.attributes.contains("POSITION")) {
    leave_out("", "it has no positions");
    return std::optional<Primitive>{};
  }
  const Json* draco = draco_json();
  if (auto status = draco != nullptr ? open_draco(*draco) : open_accessors(); !status) return status.error();
  if (auto status = check_types(); !status) return status.error();
  auto corners = read_corners();
  if (!corners) return corners.error();
  if (auto status = read_positions(*corners); !status) return status.error();
  out_.indices = std::move(*corners);
  if (source_.material >= 0) out_.material = MaterialId(static_cast<std::size_t>(source_.material));
  if (auto status = read_attributes(); !status) return status.error();
  return std::optional<Primitive>(std::move(out_));
}

}  // namespace

Result<std::optional<Primitive>> read_primitive(const PrimitiveContext& context, std::size_t mesh,
                                                std::size_t primitive, const Json& json, ImportDrops& drops) {
  return PrimitiveReader(context, mesh, primitive, json, drops).run();
}

}  // namespace meshlode::scene
