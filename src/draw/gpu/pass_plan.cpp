// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/pass_plan.h"

#include <algorithm>
#include <array>

namespace meshlode::draw {

namespace {

/// Below this, the depth pyramid and the second traversal cost more than they can hide: a frame's fixed cost.
constexpr std::uint64_t kOcclusionClusters = 1000000;

}  // namespace

Result<PassPlan> plan_passes(const GpuScene& scene, const DeviceInfo& device, std::uint32_t width, std::uint32_t height,
                             const std::vector<std::string>& force, bool has_colors) {
  PassFacts facts;
  facts.instance_count = scene.instance_count;
  facts.cluster_instances = scene.cluster_instances;
  facts.bvh_depth = scene.bvh_depth;
  facts.has_single_root = scene.max_root_triangles > 0;
  facts.has_double_sided = scene.has_double_sided;
  facts.has_alpha_mask = scene.has_alpha_mask;
  facts.has_textures = scene.has_textures;
  return plan_passes(facts, device, width, height, force, has_colors);
}

Result<PassPlan> plan_passes(const PassFacts& scene, const DeviceInfo& device, std::uint32_t width,
                             std::uint32_t height, const std::vector<std::string>& force, bool has_colors) {
  constexpr std::array kNames = {"double-sided", "alpha-mask", "occlusion", "hardware", "textures", "all"};
  for (const std::string& name : force) {
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
      return Error{ErrorCode::kUsage, "--force",
                   "no pass " + name + ": double-sided, alpha-mask, occlusion, hardware, textures or all"};
    }
  }
  const auto is_forced = [&](const char* name) {
    return std::any_of(force.begin(), force.end(), [&](const std::string& f) { return f == name || f == "all"; });
  };
  PassPlan plan;
  plan.options.width = width;
  plan.options.height = height;
  const auto decide = [&](const char* pass, bool wanted, bool forced, std::string reason) {
    plan.decisions.push_back(
        {pass, forced && !wanted ? "forced; else: " + reason : std::move(reason), wanted || forced});
    return wanted || forced;
  };
  decide("instances", true, false, std::to_string(scene.instance_count) + " instances to cull and set up");
  decide("traverse", true, false,
         (scene.bvh_depth > 0 ? std::to_string(scene.bvh_depth) + " depths of the BVH" : std::string("the BVH")) +
             ", a dispatch for all depths but the last");
  decide("clusters", true, false, "members of open groups");
  decide("software", true, false, "every cluster that is not the hardware's");
  decide("far", scene.has_single_root && !is_forced("hardware"), false,
         scene.has_single_root ? "a mesh has one root: where it covers a few pixels it goes past the BVH"
                               : "no mesh has one root cluster alone");
  decide("clipped", true, false, "triangles across the near plane; no work where there are none");
  plan.options.double_sided =
      decide("double-sided", scene.has_double_sided, is_forced("double-sided"),
             scene.has_double_sided ? "a material is double sided: back faces look their material up"
                                    : "no material is double sided: back faces are dropped unseen");
  plan.options.alpha_mask =
      decide("alpha-mask", scene.has_alpha_mask, is_forced("alpha-mask"),
             scene.has_alpha_mask ? "a material is masked: its samples look their texel up before they are written"
                                  : "no material is masked: no shader knows of masks");
  plan.options.occlusion = decide(
      "occlusion", scene.cluster_instances >= kOcclusionClusters && scene.instance_count > 1, is_forced("occlusion"),
      std::to_string(scene.cluster_instances) + " clusters in " + std::to_string(scene.instance_count) +
          " instances; a pyramid and a second traversal pay from " + std::to_string(kOcclusionClusters) +
          " clusters in several instances on");
  if (decide("hardware", false, is_forced("hardware"),
             "the software rasterizer draws every size, bit for bit as the CPU, and is faster where triangles are "
             "small")) {
    plan.options.hardware = device.has_mesh_shaders ? HardwarePath::kMesh : HardwarePath::kVertex;
  }
  plan.textures = decide("textures", scene.has_textures && has_colors, scene.has_textures && is_forced("textures"),
                         !scene.has_textures ? "no material has a base colour or normal texture"
                         : has_colors        ? "colours are resolved: base colours and normals, with their mip levels"
                                             : "no colours are resolved: no image is decoded but those of masks");
  return plan;
}

std::string describe_plan(const PassPlan& plan, const std::string& indent) {
  std::string out;
  for (const PassDecision& d : plan.decisions) {
    std::string pass = d.pass;
    pass.resize(14, ' ');
    out += indent + pass + (d.runs ? "runs   " : "-      ") + d.reason + "\n";
  }
  return out;
}

}  // namespace meshlode::draw
