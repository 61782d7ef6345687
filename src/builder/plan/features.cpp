// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/features.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include <meshlode/format.h>

#include "base/byte_size.h"
#include "builder/write/instance_scale.h"
#include "scene/import/json.h"

namespace meshlode::builder {

namespace {

std::string count_text(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

class FeatureList {
 public:
  explicit FeatureList(const scene::Scene& scene) : scene_(scene) {}

  std::vector<PlanDecision> take_all(const TextureChoice& textures) {
    add_materials();
    add_images(textures);
    add_instances();
    add_document();
    for (const scene::LeftOut& left : scene_.left_out) add(left.what, false, left.why);
    return std::move(out_);
  }
  std::vector<PlanDecision> take_ruled() {
    add_materials();
    add_instances();
    return std::move(out_);
  }

 private:
  void add(std::string what, bool kept, std::string reason) {
    out_.push_back({std::move(what), kept, std::move(reason), false, {}});
  }
  void add_count(std::uint64_t count, const char* one, const char* many, const char* reason) {
    if (count > 0) add(count_text(count, one, many), true, reason);
  }
  /// Materials of which this is true.
  template <class Is>
  [[nodiscard]] std::uint64_t materials(const Is& is) const {
    return static_cast<std::uint64_t>(std::count_if(scene_.materials.begin(), scene_.materials.end(), is));
  }

  void add_materials() {
    using scene::SceneMaterial;
    add_count(materials([](const SceneMaterial& m) { return m.alpha_mode == scene::AlphaMode::kMask; }),
              "masked material", "masked materials", "alpha is tested when drawing; simplified as if opaque");
    add_count(materials([](const SceneMaterial& m) { return m.alpha_mode == scene::AlphaMode::kBlend; }),
              "blended material", "blended materials",
              "passed through: drawn as opaque here, and triangles are not sorted");
    add_count(materials([](const SceneMaterial& m) { return m.double_sided; }), "double-sided material",
              "double-sided materials", "back faces are drawn");
    const auto has_normal_map = [](const SceneMaterial& m) {
      return std::any_of(m.textures.begin(), m.textures.end(),
                         [](const scene::TextureUse& use) { return use.role == scene::TextureRole::kNormal; });
    };
    add_count(materials(has_normal_map), "normal map", "normal maps",
              "tangents are derived from normals and texture coordinates");
  }

  void add_images(const TextureChoice& textures) {
    std::uint64_t count = 0, bytes = 0, unread = 0;
    std::set<std::uint32_t> sampled;
    for (const scene::SceneMaterial& material : scene_.materials) {
      for (const scene::TextureUse& use : material.textures) sampled.insert(use.blob);
    }
    for (std::uint32_t i = 0; i < scene_.blobs.size(); ++i) {
      if (scene_.blobs[i].kind != scene::SceneBlob::Kind::kImage) continue;
      ++count;
      bytes += scene_.blobs[i].bytes.size();
      unread += sampled.contains(i) ? 0 : 1;
    }
    if (count > 0) {
      std::string reason = "carried through, bytes unchanged";
      if (!textures.is_keep()) {
        reason = "stored as textures " + texture_word(textures) + " says, where they can be decoded";
      }
      if (unread > 0) reason += ", " + std::to_string(unread) + " that no material samples too";
      add(count_text(count, "image", "images") + ", " + byte_size_text(bytes), true, std::move(reason));
    }
  }

  void add_instances() {
    std::uint64_t mirrored = 0, singular = 0;
    for (const scene::SceneInstance& instance : scene_.instances) {
      const std::uint32_t flags = measure_instance(instance.transform).flags;
      mirrored += (flags & format::kInstanceMirrored) != 0 ? 1 : 0;
      singular += (flags & format::kInstanceSingular) != 0 ? 1 : 0;
    }
    add_count(mirrored, "mirrored instance", "mirrored instances",
              "which side is the front is turned for each by its transform: no pass of its own");
    add_count(singular, "singular instance", "singular instances", "passed through, and not drawn");
    const std::uint64_t undrawn = count_undrawn_meshes();
    add_count(undrawn, "mesh that no node draws", "meshes that no node draws", "built all the same");
  }

  [[nodiscard]] std::uint64_t count_undrawn_meshes() const {
    std::vector<std::uint8_t> is_drawn(scene_.meshes.size(), 0);
    for (const scene::SceneInstance& instance : scene_.instances) {
      if (instance.mesh.value < is_drawn.size()) is_drawn[instance.mesh.value] = 1;
    }
    return static_cast<std::uint64_t>(std::count(is_drawn.begin(), is_drawn.end(), 0));
  }

  void add_document() {
    const Result<scene::Json> document = scene::parse_json(scene_.document);
    if (!document) return;
    std::uint64_t flat = 0;
    const scene::Json::Array& cameras = document->items("cameras");
    for (const scene::Json& camera : cameras) {
      const scene::Json* type = camera.find("type");
      flat += type != nullptr && type->is_string() && *type->string() == "orthographic" ? 1 : 0;
    }
    add_count(cameras.size() - flat, "perspective camera", "perspective cameras", "carried through");
    add_count(flat, "orthographic camera", "orthographic cameras",
              "carried through; errors are projected without distance, by the same passes");
    add_count(document->items("animations").size(), "animation", "animations",
              "rigid channels are carried through; clusters do not move within a mesh");
    add_extensions(*document);
  }

  void add_extensions(const scene::Json& document) {
    for (const scene::Json& name : document.items("extensionsUsed")) {
      if (!name.is_string()) continue;
      add("extension " + std::string(name.string()->substr(0, 64)), true,
          *name.string() == "KHR_texture_transform" ? "acted on, and carried through"
                                                    : "carried through with the document");
    }
  }

  const scene::Scene& scene_;
  std::vector<PlanDecision> out_;
};

}  // namespace

std::vector<PlanDecision> list_features(const scene::Scene& scene, const TextureChoice& textures) {
  return FeatureList(scene).take_all(textures);
}

std::vector<PlanDecision> list_ruled_features(const scene::Scene& scene) {
  return FeatureList(scene).take_ruled();
}

}  // namespace meshlode::builder
