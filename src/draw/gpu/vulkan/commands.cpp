// SPDX-License-Identifier: GPL-3.0-or-later
// Command lists and their timestamps.
#include <algorithm>

#include "draw/gpu/vulkan/types.h"

namespace meshlode::draw {

Result<Commands> Commands::begin(const Device& device) {
  Commands out;
  out.impl_ = std::make_shared<CommandsImpl>();
  CommandsImpl& c = *out.impl_;
  c.device = device.impl_;
  const Functions& f = c.device->f;
  VkCommandBufferAllocateInfo allocate =
      tagged<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = c.device->pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  const VkFenceCreateInfo fence = tagged<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  VkQueryPoolCreateInfo queries = tagged<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
  queries.queryCount = kMaxStamps;
  const VkCommandBufferBeginInfo begin = tagged<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  if (f.vkAllocateCommandBuffers(c.device->device, &allocate, &c.buffer) != VK_SUCCESS ||
      f.vkCreateFence(c.device->device, &fence, nullptr, &c.fence) != VK_SUCCESS ||
      f.vkCreateQueryPool(c.device->device, &queries, nullptr, &c.queries) != VK_SUCCESS ||
      f.vkBeginCommandBuffer(c.buffer, &begin) != VK_SUCCESS) {
    return unsupported("no command list");
  }
  f.vkCmdResetQueryPool(c.buffer, c.queries, 0, kMaxStamps);
  return out;
}

namespace {

void bind_pipeline(CommandsImpl& c, const PipelineImpl& pipeline, VkPipelineBindPoint point,
                   std::span<const std::uint8_t> push) {
  const Functions& f = c.device->f;
  f.vkCmdBindPipeline(c.buffer, point, pipeline.pipeline);
  f.vkCmdPushConstants(c.buffer, c.device->layout, c.device->push_stages, 0, static_cast<std::uint32_t>(push.size()),
                       push.data());
}

}  // namespace

void Commands::dispatch(const Pipeline& pipeline, std::span<const std::uint8_t> push, std::uint32_t groups) {
  CommandsImpl& c = *impl_;
  c.keep.push_back(pipeline.impl_);
  bind_pipeline(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_COMPUTE, push);
  // One dimension holds 65535 groups at least; shaders read gl_WorkGroupID.y as the high part.
  constexpr std::uint32_t kRow = 32768;
  c.device->f.vkCmdDispatch(c.buffer, std::min(groups, kRow), (groups + kRow - 1) / kRow, 1);
}

void Commands::dispatch_indirect(const Pipeline& pipeline, std::span<const std::uint8_t> push, const Buffer& arguments,
                                 std::uint64_t offset) {
  CommandsImpl& c = *impl_;
  c.keep.push_back(pipeline.impl_);
  c.keep.push_back(arguments.impl_);
  bind_pipeline(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_COMPUTE, push);
  c.device->f.vkCmdDispatchIndirect(c.buffer, arguments.impl_->buffer, offset);
}

void Commands::draw_indirect(const Pipeline& pipeline, std::span<const std::uint8_t> push, const Buffer& arguments,
                             std::uint64_t offset, std::uint32_t width, std::uint32_t height) {
  CommandsImpl& c = *impl_;
  const Functions& f = c.device->f;
  c.keep.push_back(pipeline.impl_);
  c.keep.push_back(arguments.impl_);
  VkRenderingInfo rendering = tagged<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  rendering.renderArea.extent = {width, height};
  rendering.layerCount = 1;
  f.vkCmdBeginRendering(c.buffer, &rendering);
  bind_pipeline(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_GRAPHICS, push);
  const VkViewport viewport{0.0F, 0.0F, static_cast<float>(width), static_cast<float>(height), 0.0F, 1.0F};
  f.vkCmdSetViewport(c.buffer, 0, 1, &viewport);
  f.vkCmdSetScissor(c.buffer, 0, 1, &rendering.renderArea);
  if (pipeline.impl_->is_mesh_shader) {
    f.vkCmdDrawMeshTasksIndirectEXT(c.buffer, arguments.impl_->buffer, offset, 1, 12);
  } else {
    f.vkCmdDrawIndirect(c.buffer, arguments.impl_->buffer, offset, 1, 16);
  }
  f.vkCmdEndRendering(c.buffer);
}

void Commands::fill(const Buffer& buffer, std::uint64_t offset, std::uint64_t bytes, std::uint32_t value) {
  impl_->keep.push_back(buffer.impl_);
  impl_->device->f.vkCmdFillBuffer(impl_->buffer, buffer.impl_->buffer, offset, bytes, value);
}

void Commands::copy(const Buffer& from, std::uint64_t from_offset, const Buffer& to, std::uint64_t to_offset,
                    std::uint64_t bytes) {
  impl_->keep.push_back(from.impl_);
  impl_->keep.push_back(to.impl_);
  const VkBufferCopy region{from_offset, to_offset, bytes};
  impl_->device->f.vkCmdCopyBuffer(impl_->buffer, from.impl_->buffer, to.impl_->buffer, 1, &region);
}

void Commands::barrier() {
  VkMemoryBarrier2 memory = tagged<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  VkDependencyInfo dependency = tagged<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &memory;
  impl_->device->f.vkCmdPipelineBarrier2(impl_->buffer, &dependency);
}

void Commands::stamp(std::string_view name) {
  CommandsImpl& c = *impl_;
  if (c.stamps.size() >= kMaxStamps) return;
  c.device->f.vkCmdWriteTimestamp2(c.buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, c.queries,
                                   static_cast<std::uint32_t>(c.stamps.size()));
  c.stamps.emplace_back(name);
}

Result<std::vector<Commands::Time>> Commands::run() {
  CommandsImpl& c = *impl_;
  const Functions& f = c.device->f;
  if (!c.is_ended && f.vkEndCommandBuffer(c.buffer) != VK_SUCCESS) return unsupported("a command list did not end");
  c.is_ended = true;
  VkCommandBufferSubmitInfo buffer = tagged<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  buffer.commandBuffer = c.buffer;
  VkSubmitInfo2 submit = tagged<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  if (f.vkQueueSubmit2(c.device->queue, 1, &submit, c.fence) != VK_SUCCESS ||
      f.vkWaitForFences(c.device->device, 1, &c.fence, VK_TRUE, ~std::uint64_t{0}) != VK_SUCCESS) {
    return unsupported(c.device->info.name + " was lost while it ran");
  }
  f.vkResetFences(c.device->device, 1, &c.fence);
  std::vector<Time> times;
  if (c.stamps.size() < 2) return times;
  std::vector<std::uint64_t> ticks(c.stamps.size());
  if (f.vkGetQueryPoolResults(c.device->device, c.queries, 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT) != VK_SUCCESS) {
    return unsupported("no timestamps");
  }
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double milliseconds = static_cast<double>(ticks[i] - ticks[i - 1]) * c.device->info.timestamp_ns * 1e-6;
    times.push_back({c.stamps[i], milliseconds});
  }
  return times;
}

}  // namespace meshlode::draw
