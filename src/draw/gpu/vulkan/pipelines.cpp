// SPDX-License-Identifier: GPL-3.0-or-later
// Pipelines: one layout of push constants for all.
#include <array>
#include <vector>

#include "draw/gpu/vulkan/float_controls.h"
#include "draw/gpu/vulkan/types.h"

namespace meshlode::draw {

namespace {

struct ShaderModule {
  DeviceImpl& device;
  VkShaderModule module = VK_NULL_HANDLE;

  ShaderModule(DeviceImpl& d, std::span<const std::uint32_t> spirv) : device(d) {
    const std::vector<std::uint32_t> words = declare_round_to_nearest_even(spirv);
    VkShaderModuleCreateInfo create = tagged<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    create.codeSize = words.size() * sizeof(std::uint32_t);
    create.pCode = words.data();
    if (d.f.vkCreateShaderModule(d.device, &create, nullptr, &module) != VK_SUCCESS) module = VK_NULL_HANDLE;
  }
  ShaderModule(const ShaderModule&) = delete;
  ShaderModule& operator=(const ShaderModule&) = delete;
  ~ShaderModule() {
    if (module != VK_NULL_HANDLE) device.f.vkDestroyShaderModule(device.device, module, nullptr);
  }
};

struct Specialization {
  std::vector<VkSpecializationMapEntry> entries;
  VkSpecializationInfo info{};

  explicit Specialization(std::span<const std::uint32_t> constants) {
    for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, i * 4, 4});
    info = {static_cast<std::uint32_t>(entries.size()), entries.data(), constants.size_bytes(), constants.data()};
  }
};

VkPipelineShaderStageCreateInfo stage_of(VkShaderStageFlagBits stage, const ShaderModule& shader,
                                         const Specialization& specialization) {
  VkPipelineShaderStageCreateInfo out =
      tagged<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  out.stage = stage;
  out.module = shader.module;
  out.pName = "main";
  out.pSpecializationInfo = &specialization.info;
  return out;
}

}  // namespace

Result<Pipeline> Device::make_compute(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> constants) {
  DeviceImpl& d = *impl_;
  const ShaderModule shader(d, spirv);
  const Specialization specialization(constants);
  VkComputePipelineCreateInfo create =
      tagged<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  create.stage = stage_of(VK_SHADER_STAGE_COMPUTE_BIT, shader, specialization);
  create.layout = d.layout;
  Pipeline out;
  out.impl_ = std::make_shared<PipelineImpl>();
  out.impl_->device = impl_;
  if (shader.module == VK_NULL_HANDLE ||
      d.f.vkCreateComputePipelines(d.device, VK_NULL_HANDLE, 1, &create, nullptr, &out.impl_->pipeline) != VK_SUCCESS) {
    out.impl_->pipeline = VK_NULL_HANDLE;
    return unsupported(d.info.name + " refused a compute pipeline");
  }
  return out;
}

Result<Pipeline> Device::make_draw(std::span<const std::uint32_t> first, std::span<const std::uint32_t> fragment,
                                   std::span<const std::uint32_t> constants, bool is_mesh_shader) {
  DeviceImpl& d = *impl_;
  const ShaderModule first_module(d, first), fragment_module(d, fragment);
  const Specialization specialization(constants);
  const std::array stages = {stage_of(is_mesh_shader ? VK_SHADER_STAGE_MESH_BIT_EXT : VK_SHADER_STAGE_VERTEX_BIT,
                                      first_module, specialization),
                             stage_of(VK_SHADER_STAGE_FRAGMENT_BIT, fragment_module, specialization)};
  VkPipelineVertexInputStateCreateInfo input =
      tagged<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  VkPipelineInputAssemblyStateCreateInfo assembly =
      tagged<VkPipelineInputAssemblyStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport =
      tagged<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster =
      tagged<VkPipelineRasterizationStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = VK_CULL_MODE_NONE;  // facing differs by instance and material: the fragment shader decides
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1.0F;
  VkPipelineMultisampleStateCreateInfo samples =
      tagged<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  const std::array states = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic =
      tagged<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(states.size());
  dynamic.pDynamicStates = states.data();
  VkPipelineRenderingCreateInfo rendering =
      tagged<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  VkGraphicsPipelineCreateInfo create =
      tagged<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  create.pNext = &rendering;
  create.stageCount = static_cast<std::uint32_t>(stages.size());
  create.pStages = stages.data();
  create.pVertexInputState = is_mesh_shader ? nullptr : &input;
  create.pInputAssemblyState = is_mesh_shader ? nullptr : &assembly;
  create.pViewportState = &viewport;
  create.pRasterizationState = &raster;
  create.pMultisampleState = &samples;
  create.pDynamicState = &dynamic;
  create.layout = d.layout;
  Pipeline out;
  out.impl_ = std::make_shared<PipelineImpl>();
  out.impl_->device = impl_;
  out.impl_->is_mesh_shader = is_mesh_shader;
  if (first_module.module == VK_NULL_HANDLE || fragment_module.module == VK_NULL_HANDLE ||
      d.f.vkCreateGraphicsPipelines(d.device, VK_NULL_HANDLE, 1, &create, nullptr, &out.impl_->pipeline) !=
          VK_SUCCESS) {
    out.impl_->pipeline = VK_NULL_HANDLE;
    return unsupported(d.info.name + " refused a draw pipeline");
  }
  return out;
}

}  // namespace meshlode::draw
