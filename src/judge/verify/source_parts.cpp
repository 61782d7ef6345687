// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/source_parts.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "judge/validate/file_tables.h"
#include "scene/parts/split_parts.h"

namespace meshlode::judge {

namespace {

std::uint64_t count_triangles(const scene::Scene& scene) {
  std::uint64_t triangles = 0;
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& primitive : mesh.primitives) triangles += primitive.indices.size() / 3;
  }
  return triangles;
}

}  // namespace

std::optional<scene::Scene> split_source(const run::Asset& asset, const scene::Scene& source) {
  const std::vector<MetaFacts::Part> told = read_meta_facts(asset.meta_json()).parts;
  if (told.empty() || asset.meshes().size() != source.meshes.size() + told.size()) return std::nullopt;
  std::vector<scene::MeshPart> parts;
  for (std::size_t i = 0; i < told.size(); ++i) {
    // A mesh has one part: else a file could ask for any amount of work.
    const bool is_next = told[i].of < source.meshes.size() && (i == 0 || told[i].of > told[i - 1].of);
    if (!is_next || told[i].mesh != source.meshes.size() + i) return std::nullopt;
    scene::MeshPart& part = parts.emplace_back();
    part.of = static_cast<std::uint32_t>(told[i].of);
    part.name = std::string(asset.string(asset.meshes()[told[i].mesh].name));
    part.most_triangles.assign(source.materials.size(), 0);
    for (const auto& [material, triangles] : told[i].most_triangles) {
      if (material < part.most_triangles.size()) part.most_triangles[material] = triangles;
    }
  }
  scene::Scene split = source;
  scene::split_parts(split, parts);
  if (count_triangles(split) != count_triangles(source)) return std::nullopt;
  return split;
}

}  // namespace meshlode::judge
