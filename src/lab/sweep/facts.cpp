// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/facts.h"

#include <algorithm>

#include "base/hash.h"

namespace meshlode::lab {

SceneSummary summary_of(const scene::Scene& scene) {
  SceneSummary summary{scene.source_name, scene.source_hash, scene.meshes.size(), scene.instances.size(), 0, 0};
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& primitive : mesh.primitives) {
      summary.triangles += primitive.indices.size() / 3;
      summary.vertices += primitive.positions.size();
    }
  }
  return summary;
}

SceneFacts facts_of(const run::Asset& asset) {
  SceneFacts facts;
  for (const format::MeshRecord& mesh : asset.meshes()) {
    facts.largest_diagonal = std::max(facts.largest_diagonal, mesh.diagonal);
    facts.has_normals = facts.has_normals || mesh.normal_mode == format::NormalMode::kStored;
    facts.has_uvs = facts.has_uvs || mesh.uv_set_count > 0;
  }
  return facts;
}

std::string fingerprint_of(const SweepOptions& options, const SweepResult& result) {
  const std::string text =
      options.program_id + "\n" + result.machine.name + "\n" + result.machine.system + "\n" +
      std::to_string(result.machine.threads) + "\n" + result.scene.hash + "\n" + options.scene_choice + "\n" +
      std::to_string(result.fineness.samples) + "\n" + std::to_string(result.fineness.width) + "\n" +
      std::to_string(static_cast<int>(result.fineness.searches)) + "\n" + std::to_string(options.max_decoded) + "\n";
  return to_hex(hash128({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
}

}  // namespace meshlode::lab
