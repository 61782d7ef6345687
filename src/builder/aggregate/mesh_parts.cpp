// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/mesh_parts.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace meshlode::builder {

std::vector<scene::MeshPart> plan_parts(const scene::Scene& scene, std::vector<AggregateDecision>& decisions,
                                        PipelineOptions& options) {
  std::vector<scene::MeshPart> parts;
  std::set<std::string> names;
  std::map<std::string, std::size_t> numbers;  // of a stem, how many were tried
  for (const scene::SourceMesh& mesh : scene.meshes) names.insert(mesh.name);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    if (decisions[i].most_triangles.empty()) continue;
    const std::string stem = scene.meshes[i].name + "#leaves";
    std::string name;
    do {
      const std::size_t number = ++numbers[stem];
      name = number == 1 ? stem : stem + std::to_string(number);
    } while (!names.insert(name).second);
    parts.push_back({static_cast<std::uint32_t>(i), std::move(name), std::move(decisions[i].most_triangles)});
  }
  if (parts.empty()) return parts;
  if (options.mesh_options.empty()) options.mesh_options.assign(scene.meshes.size(), options);
  for (const scene::MeshPart& part : parts) {
    options.mesh_options.push_back(options.mesh_options[part.of]);
    decisions.push_back({true, std::exchange(decisions[part.of], {}).reason, {}});
  }
  return parts;
}

}  // namespace meshlode::builder
