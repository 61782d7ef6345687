// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/skins.h"

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/try.h"
#include "scene/import/gltf/accessor.h"
#include "scene/import/gltf/gltf_import.h"
#include "scene/import/gltf/skin_mesh.h"

namespace meshlode::scene {

namespace {

/// How a mesh is drawn with a skin.
struct Settled {
  enum class Kind : std::uint8_t { kByNode, kRigid, kBaked };
  Kind kind = Kind::kByNode;  ///< by node: nothing in the mesh or the skin says otherwise
  Mat4d matrix{1.0};
  std::uint32_t mesh = 0;  ///< the one to draw
};

class SkinSettler {
 public:
  SkinSettler(GltfAsset& asset, const std::vector<std::vector<VertexWeights>>& weights, DecodeBudget& budget,
              Scene& scene)
      : asset_(asset), weights_(weights), budget_(budget), scene_(scene) {}

  Status run() {
    const std::size_t skin_count = asset_.model.skins.size();
    if (skin_count == 0) return Ok{};
    find_places();
    matrices_.resize(skin_count);
    bad_vertices_.resize(skin_count);
    unweighted_.resize(skin_count);
    const std::size_t node_count = asset_.model.nodes.size();
    for (std::size_t n = 0; n < node_count; ++n) {
      if (!is_skinned(n)) continue;
      if (Status settled = settle(pair_of(n)); !settled) return settled;
    }
    if (Status baked = bake(); !baked) return baked;
    for (std::size_t n = 0; n < node_count; ++n) {
      if (!is_skinned(n)) continue;
      const Settled& how = settled_.at(pair_of(n));
      if (how.kind == Settled::Kind::kByNode) continue;
      if (Status moved = move_mesh(n, how); !moved) return moved;
    }
    tell();
    return Ok{};
  }

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< mesh and skin

  [[nodiscard]] bool is_skinned(std::size_t n) const {
    return asset_.model.nodes[n].mesh >= 0 && asset_.model.nodes[n].skin >= 0;
  }
  [[nodiscard]] Pair pair_of(std::size_t n) const {
    return {static_cast<std::uint32_t>(asset_.model.nodes[n].mesh),
            static_cast<std::uint32_t>(asset_.model.nodes[n].skin)};
  }
  static std::string skin_path(std::size_t s) { return "/skins/" + std::to_string(s); }
  [[nodiscard]] Error no_budget(std::size_t s) const {
    return asset_.invalid(skin_path(s), "more meshes are drawn with it than the size of the file justifies");
  }

  /// Where each node stands, whether it is hidden, and the root of its tree.
  void find_places() {
    const auto& nodes = asset_.model.nodes;
    const auto& json = asset_.root.items("nodes");
    world_.resize(nodes.size());
    is_hidden_.resize(nodes.size());
    root_.resize(nodes.size());
    std::vector<bool> has_parent(nodes.size(), false);
    for (const tinygltf::Node& node : nodes) {
      for (const int child : node.children) has_parent[child] = true;
    }
    std::vector<std::size_t> stack;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (has_parent[n]) continue;
      root_[n] = n;
      world_[n] = Mat4d(1.0) * local_transform(nodes[n]);
      is_hidden_[n] = is_hidden(json[n]);
      stack.push_back(n);
    }
    while (!stack.empty()) {
      const std::size_t n = stack.back();
      stack.pop_back();
      for (const int child : nodes[n].children) {
        root_[child] = root_[n];
        world_[child] = world_[n] * local_transform(nodes[child]);
        is_hidden_[child] = is_hidden_[n] || is_hidden(json[child]);
        stack.push_back(static_cast<std::size_t>(child));
      }
    }
    const auto& scenes = asset_.model.scenes;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      for (const int root : scenes[s].nodes) scenes_of_[static_cast<std::size_t>(root)].push_back(s);
    }
  }

  /// World transform of each joint times its inverse bind matrix.
  Status read_matrices(std::size_t s) {
    if (matrices_[s]) return Ok{};
    const tinygltf::Skin& skin = asset_.model.skins[s];
    std::vector<Mat4d>& out = matrices_[s].emplace();
    std::optional<AccessorReader> inverse;
    const std::string path = skin_path(s) + "/inverseBindMatrices";
    if (skin.inverseBindMatrices >= 0) {
      const tinygltf::Accessor& accessor = asset_.model.accessors[skin.inverseBindMatrices];
      if (accessor.type != TINYGLTF_TYPE_MAT4 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        return asset_.invalid(path, "not an accessor of matrices of 4 x 4 floats");
      }
      if (accessor.count < skin.joints.size()) {
        return asset_.invalid(
            path, std::to_string(accessor.count) + " matrices for " + std::to_string(skin.joints.size()) + " joints");
      }
      if (!budget_.take(sparse_count_of(accessor))) return no_budget(s);
      TRY_LET(reader, AccessorReader::open(asset_, static_cast<std::size_t>(skin.inverseBindMatrices)));
      inverse = *reader;
    }
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const Mat4d bind = inverse ? affine_matrix(inverse->raw(j)) : Mat4d(1.0);
      out.push_back(world_[static_cast<std::size_t>(skin.joints[j])] * bind);
    }
    return Ok{};
  }

  /// Corners, and influences of vertices by fours.
  [[nodiscard]] std::uint64_t work_on(std::uint32_t m) const {
    std::uint64_t sum = 1;
    for (std::size_t p = 0; p < scene_.meshes[m].primitives.size(); ++p) {
      const Primitive& primitive = scene_.meshes[m].primitives[p];
      sum += primitive.indices.size() + primitive.positions.size() * (1 + weights_[m][p].width / 4);
    }
    return sum;
  }

  Status settle(const Pair& pair) {
    if (settled_.contains(pair)) return Ok{};
    const auto [m, s] = pair;
    Settled& how = settled_[pair];
    how.mesh = m;
    if (Status read = read_matrices(s); !read) return read;
    const std::vector<Mat4d>& matrices = *matrices_[s];
    if (!budget_.take(work_on(m) + matrices.size())) return no_budget(s);
    const MeshJoints joints = find_joints(scene_.meshes[m], weights_[m], matrices.size());
    if (!joints.has_weights || matrices.empty()) return Ok{};
    for (const std::uint32_t j : joints.used) {
      if (is_finite(matrices[j])) continue;
      return asset_.invalid(skin_path(s) + "/joints/" + std::to_string(j), "its matrix is not finite");
    }
    bad_vertices_[s] += joints.bad_vertices;
    unweighted_[s] += joints.unweighted_vertices;
    const auto matrix = common_matrix(joints, matrices);
    how.kind = matrix ? Settled::Kind::kRigid : Settled::Kind::kBaked;
    if (matrix) how.matrix = *matrix;
    return Ok{};
  }

  /// Whether a node draws the mesh as it is.
  [[nodiscard]] std::vector<bool> find_kept_meshes() const {
    std::vector<bool> kept(scene_.meshes.size(), false);
    for (std::size_t n = 0; n < asset_.model.nodes.size(); ++n) {
      if (asset_.model.nodes[n].mesh < 0) continue;
      const bool is_baked = is_skinned(n) && settled_.at(pair_of(n)).kind == Settled::Kind::kBaked;
      if (!is_baked) kept[static_cast<std::size_t>(asset_.model.nodes[n].mesh)] = true;
    }
    return kept;
  }

  Status bake() {
    const std::vector<bool> kept = find_kept_meshes();
    std::map<std::uint32_t, std::uint32_t> last;  // of a mesh that is baked in its place: the last skin, which is it
    for (const auto& [pair, how] : settled_) {
      if (how.kind == Settled::Kind::kBaked && !kept[pair.first]) last[pair.first] = pair.second;
    }
    for (auto& [pair, how] : settled_) {
      if (how.kind != Settled::Kind::kBaked) continue;
      const auto [m, s] = pair;
      const auto in_place = last.find(m);
      if (in_place == last.end() || in_place->second != s) {
        if (Status copied = copy_mesh(m, s); !copied) return copied;
        how.mesh = static_cast<std::uint32_t>(scene_.meshes.size() - 1);
      }
      scene_.meshes[how.mesh].is_deformed = true;
      if (!bake_mesh(scene_.meshes[how.mesh], weights_[m], *matrices_[s])) {
        return asset_.invalid(skin_path(s), "a vertex of mesh " + std::to_string(m) + " is not finite in its pose");
      }
    }
    return Ok{};
  }

  Status copy_mesh(std::uint32_t m, std::uint32_t s) {
    // Its text too, with extras of any size.
    const std::uint64_t text_bytes = dump_json(asset_.root.items("meshes")[m]).size();
    if (!budget_.take(8 * work_on(m) + text_bytes / 4)) return no_budget(s);
    SourceMesh copy = scene_.meshes[m];
    scene_.meshes.push_back(std::move(copy));
    auto& meshes = std::get<Json::Array>(asset_.root.find("meshes")->value);
    Json json = meshes[m];
    meshes.push_back(std::move(json));
    tinygltf::Mesh model = asset_.model.meshes[m];
    asset_.model.meshes.push_back(std::move(model));
    return Ok{};
  }

  /// From node `n` to one of its own.
  Status move_mesh(std::size_t n, const Settled& how) {
    auto& nodes = std::get<Json::Array>(asset_.root.find("nodes")->value);
    Json json = Json::make_object();
    tinygltf::Node model;
    model.name = asset_.model.nodes[n].name;
    model.mesh = static_cast<int>(how.mesh);
    for (const std::string_view key : {"name", "extras"}) {
      if (const Json* member = nodes[n].find(key)) json.set(key, *member);
    }
    json.set("mesh", Json::make_index(how.mesh));
    if (how.matrix != Mat4d(1.0)) {
      Json::Array numbers;
      for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
          model.matrix.push_back(how.matrix[c][r]);
          numbers.push_back(Json::make_number(how.matrix[c][r]));
        }
      }
      json.set("matrix", Json{std::move(numbers)});
    }
    if (is_hidden_[n]) {
      Json visibility = Json::make_object(), extensions = Json::make_object();
      visibility.set("visible", Json::make_bool(false));
      extensions.set("KHR_node_visibility", std::move(visibility));
      json.set("extensions", std::move(extensions));
    }
    for (const char* key : {"mesh", "skin", "weights"}) nodes[n].erase(key);
    asset_.model.nodes[n].mesh = -1;
    const std::size_t added = nodes.size();
    if (!budget_.take(64)) return no_budget(static_cast<std::size_t>(asset_.model.nodes[n].skin));
    nodes.push_back(std::move(json));
    asset_.model.nodes.push_back(std::move(model));
    const auto scenes = scenes_of_.find(root_[n]);
    if (scenes == scenes_of_.end()) return Ok{};
    if (!budget_.take(8 * scenes->second.size())) {
      return no_budget(static_cast<std::size_t>(asset_.model.nodes[n].skin));
    }
    Json::Array& list = std::get<Json::Array>(asset_.root.find("scenes")->value);
    for (const std::size_t s : scenes->second) {
      asset_.model.scenes[s].nodes.push_back(static_cast<int>(added));
      std::get<Json::Array>(list[s].find("nodes")->value).push_back(Json::make_index(added));
    }
    return Ok{};
  }

  void tell() {
    auto& left_out = scene_.left_out;
    std::vector<bool> moves(matrices_.size(), false);
    for (const auto& [pair, how] : settled_) {
      if (how.kind != Settled::Kind::kByNode) {
        moves[pair.second] = true;
        continue;
      }
      left_out.push_back({"skin " + std::to_string(pair.second) + " of mesh " + std::to_string(pair.first),
                          "the mesh has no JOINTS_0 and WEIGHTS_0, or the skin no joints; the node places the mesh"});
    }
    for (std::size_t s = 0; s < moves.size(); ++s) {
      left_out.push_back({"skin " + std::to_string(s),
                          moves[s] ? "its meshes are built where its joints put them in the rest pose of the file; "
                                     "joints and weights are left out"
                                   : "no mesh is moved by it"});
      if (unweighted_[s] != 0) {
        left_out.push_back({"skin " + std::to_string(s) + ": " + std::to_string(unweighted_[s]) + " vertices",
                            "their primitives have no JOINTS_0 and WEIGHTS_0; they follow the skin's first joint"});
      }
      if (bad_vertices_[s] == 0) continue;
      left_out.push_back(
          {"skin " + std::to_string(s) + ": weights of " + std::to_string(bad_vertices_[s]) + " vertices",
           "negative, not finite, all zero or of joints that it does not have; the vertex's other "
           "joints stand in for them, else its first"});
    }
  }

  GltfAsset& asset_;
  const std::vector<std::vector<VertexWeights>>& weights_;
  DecodeBudget& budget_;
  Scene& scene_;
  std::vector<Mat4d> world_;
  std::vector<bool> is_hidden_;
  std::vector<std::size_t> root_;
  std::map<std::size_t, std::vector<std::size_t>> scenes_of_;  ///< of a root
  std::vector<std::optional<std::vector<Mat4d>>> matrices_;    ///< by skin: of its joints
  std::vector<std::uint64_t> bad_vertices_, unweighted_;       ///< by skin
  std::map<Pair, Settled> settled_;
};

}  // namespace

std::vector<bool> find_skinned_meshes(const GltfAsset& asset) {
  std::vector<bool> out(asset.model.meshes.size(), false);
  for (const tinygltf::Node& node : asset.model.nodes) {
    if (node.mesh >= 0 && node.skin >= 0) out[static_cast<std::size_t>(node.mesh)] = true;
  }
  return out;
}

Status settle_skins(GltfAsset& asset, const std::vector<std::vector<VertexWeights>>& weights, DecodeBudget& budget,
                    Scene& scene) {
  return SkinSettler(asset, weights, budget, scene).run();
}

}  // namespace meshlode::scene
