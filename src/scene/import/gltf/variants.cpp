// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/variants.h"

#include <map>
#include <utility>

#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

namespace {

constexpr std::string_view kVariants = "KHR_materials_variants";

/// Of a primitive, or of the root.
const Json* find_variants(const Json& object) {
  const Json* extensions = object.find("extensions");
  return extensions != nullptr ? extensions->find(kVariants) : nullptr;
}

class VariantsChecker : public JsonChecker {
 public:
  VariantsChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    const Json* all = find_variants(root_);
    const std::string here = "/extensions/" + std::string(kVariants);
    if (all != nullptr && !all->is_object()) fail(here, "not an object");
    if (all != nullptr) objects(*all, here, "variants");
    const std::size_t count = all != nullptr ? all->items("variants").size() : 0;
    const auto& meshes = root_.items("meshes");
    for (std::size_t m = 0; m < meshes.size() && ok(); ++m) {
      const auto& primitives = meshes[m].items("primitives");
      for (std::size_t p = 0; p < primitives.size() && ok(); ++p) {
        const Json* variants = find_variants(primitives[p]);
        if (variants == nullptr) continue;
        check_mappings(*variants, "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p) + here, count);
      }
    }
  }

 private:
  void check_mappings(const Json& variants, const std::string& path, std::size_t variant_count) {
    if (!variants.is_object()) {
      fail(path, "not an object");
      return;
    }
    if (!objects(variants, path, "mappings")) return;
    const auto& mappings = variants.items("mappings");
    for (std::size_t i = 0; i < mappings.size() && ok(); ++i) {
      const std::string here = path + "/mappings/" + std::to_string(i);
      required_index(mappings[i], here, "material", root_.items("materials").size());
      optional_indices(mappings[i], here, "variants", variant_count);
    }
  }

  const Json& root_;
};

}  // namespace

Status check_gltf_variants(const Json& root, const std::string& file) {
  VariantsChecker checker(root, file);
  checker.run();
  return checker.status();
}

Json::Array variant_primitives(const GltfAsset& asset, std::size_t m, std::vector<LeftOut>& left_out) {
  struct Mapped {
    std::string text;  ///< empty: a primitive without mappings
    const Json* variants = nullptr;
    bool is_one = true;
  };
  std::map<std::uint64_t, Mapped> by_material;
  bool has_any = false;
  for (const Json& primitive : asset.root.items("meshes")[m].items("primitives")) {
    if (index_or(primitive, "mode", 4) < 4) continue;
    const Json* variants = find_variants(primitive);
    has_any = has_any || variants != nullptr;
    std::string text = variants != nullptr ? dump_json(*variants) : std::string();
    const auto [known, is_new] = by_material.try_emplace(index_or(primitive, "material", kNoId));
    if (is_new) {
      known->second = {std::move(text), variants, true};
    } else {
      known->second.is_one = known->second.is_one && known->second.text == text;
    }
  }
  Json::Array out;
  if (!has_any) return out;
  for (const auto& [material, mapped] : by_material) {
    if (!mapped.is_one) {
      left_out.push_back({"mesh " + std::to_string(m) + " " + std::string(kVariants) +
                              (material == kNoId ? "" : " of material " + std::to_string(material)),
                          "primitives of one material have different mappings, and are one in the asset"});
      continue;
    }
    if (mapped.variants == nullptr) continue;
    Json extensions = Json::make_object();
    extensions.set(kVariants, *mapped.variants);
    Json primitive = Json::make_object();
    if (material != kNoId) primitive.set("material", Json::make_index(material));
    primitive.set("extensions", std::move(extensions));
    out.push_back(std::move(primitive));
  }
  return out;
}

void keep_uv_sets_of_variants(const GltfAsset& asset, std::vector<SceneMaterial>& materials) {
  const std::vector<SceneMaterial> own = materials;
  for (const Json& mesh : asset.root.items("meshes")) {
    for (const Json& primitive : mesh.items("primitives")) {
      const Json* variants = find_variants(primitive);
      const std::uint64_t base = index_or(primitive, "material", kNoId);
      if (variants == nullptr || base >= materials.size()) continue;
      for (const Json& mapping : variants->items("mappings")) {
        materials[base].uv_sets_used |= own[index_or(mapping, "material", 0)].uv_sets_used;
      }
    }
  }
}

}  // namespace meshlode::scene
