// SPDX-License-Identifier: GPL-3.0-or-later
// Optional extensions that geometry would be lost without. A reader that leaves out an optional extension still shows
// the scene, only plainer; but some hold the scene itself: copies of a mesh, or the bytes of its vertices. Those are
// refused wherever they are used, whether the file requires them or not, so that nothing is lost with an exit code of
// 0.
#include <algorithm>
#include <set>

#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

constexpr std::string_view kDraco = "KHR_draco_mesh_compression";

/// EXT_mesh_gpu_instancing is read; whatever other prefix it may be ratified under may mean something else.
bool is_unread_instancing(std::string_view name) {
  return name.ends_with("_mesh_gpu_instancing") && name != "EXT_mesh_gpu_instancing";
}

/// Attributes that the importer reads; others are left out, and said so.
bool is_read(std::string_view attribute) {
  return attribute == "POSITION" || attribute == "NORMAL" || attribute == "COLOR_0" ||
         attribute.starts_with("TEXCOORD_");
}

bool is_look(std::string_view extension) {
  return extension.find("_materials_") != std::string_view::npos;
}

const Json::Object* extensions_of(const Json& object) {
  const Json* extensions = object.find("extensions");
  return extensions != nullptr ? extensions->object() : nullptr;
}

class LostGeometryChecker : public JsonChecker {
 public:
  LostGeometryChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    check_nodes();
    check_accessors();
    const auto& meshes = root_.items("meshes");
    for (std::size_t m = 0; m < meshes.size() && ok(); ++m) {
      const auto& primitives = meshes[m].items("primitives");
      for (std::size_t p = 0; p < primitives.size() && ok(); ++p) {
        check_primitive(primitives[p], "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p));
      }
    }
  }

 private:
  bool unread(const std::string& path, const std::string& name, const char* loss) {
    return fail(path + "/extensions/" + pointer_part(name),
                "this extension is not read, though optional here, and without it " + std::string(loss),
                ErrorCode::kUnsupported);
  }

  void check_nodes() {
    const auto& nodes = root_.items("nodes");
    for (std::size_t n = 0; n < nodes.size() && ok(); ++n) {
      const Json::Object* extensions = extensions_of(nodes[n]);
      if (extensions == nullptr) continue;
      for (const JsonMember& member : *extensions) {
        if (!is_unread_instancing(member.key)) continue;
        unread("/nodes/" + std::to_string(n), member.key, "the mesh's instances are lost");
      }
    }
  }

  /// Once an accessor, because many primitives may name the same.
  void check_accessors() {
    const auto& accessors = root_.items("accessors");
    is_empty_.resize(accessors.size());
    for (std::size_t a = 0; a < accessors.size(); ++a) {
      is_empty_[a] = accessors[a].find("bufferView") == nullptr && accessors[a].find("sparse") == nullptr &&
                     index_or(accessors[a], "count", 0) > 0;
      const Json::Object* extensions = extensions_of(accessors[a]);
      if (extensions == nullptr) continue;
      for (const JsonMember& member : *extensions) {
        const bool is_decoded = member.key == "WEB3D_quantized_attributes";  // positions before their matrix
        if (is_empty_[a] || is_decoded) {
          unread("/accessors/" + std::to_string(a), member.key, "its elements are not what they are meant to be");
        }
      }
    }
  }

  /// An accessor without bytes is all zero; where an extension holds the bytes, that is not what the scene looks like.
  void check_primitive(const Json& primitive, const std::string& path) {
    const Json::Object* extensions = extensions_of(primitive);
    if (extensions == nullptr) return;
    std::set<std::string_view> decoded;  // Draco's
    const std::string* holder = nullptr;
    bool has_draco = false;
    for (const JsonMember& member : *extensions) {
      if (member.key == kDraco) {
        has_draco = true;
        for (const JsonMember& attribute : *member.value.find("attributes")->object()) decoded.insert(attribute.key);
      } else if (holder == nullptr && !is_look(member.key)) {
        holder = &member.key;
      }
    }
    if (holder == nullptr) return;
    bool is_lost = !has_draco && primitive.find("indices") != nullptr && is_empty_[index_or(primitive, "indices", 0)];
    for (const JsonMember& attribute : *primitive.find("attributes")->object()) {
      if (!is_read(attribute.key) || decoded.contains(attribute.key)) continue;
      is_lost = is_lost || is_empty_[attribute.value.index().value_or(0)];
    }
    if (is_lost) unread(path, *holder, "vertices or indices have no bytes");
  }

  const Json& root_;
  std::vector<bool> is_empty_;  ///< accessors that neither a buffer view nor a sparse part gives bytes to
};

}  // namespace

Status check_gltf_lost_geometry(const Json& root, const std::string& file) {
  LostGeometryChecker checker(root, file);
  checker.run();
  return checker.status();
}

}  // namespace meshlode::scene
