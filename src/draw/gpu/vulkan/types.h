// SPDX-License-Identifier: GPL-3.0-or-later
// What the four files of the Vulkan wrapper share and nobody else includes: the functions that are loaded, and what
// stands behind Device, Buffer, Pipeline and Commands.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "draw/gpu/vulkan/vulkan.h"

namespace meshlode::draw {

// clang-format off
#define MESHLODE_GLOBAL_FUNCTIONS(X) \
  X(vkCreateInstance) X(vkEnumerateInstanceLayerProperties) X(vkEnumerateInstanceVersion)

#define MESHLODE_INSTANCE_FUNCTIONS(X)                                                             \
  X(vkDestroyInstance)                                                                             \
  X(vkEnumeratePhysicalDevices)                                                                    \
  X(vkGetPhysicalDeviceProperties2)                                                                \
  X(vkGetPhysicalDeviceFeatures2)                                                                  \
  X(vkGetPhysicalDeviceQueueFamilyProperties)                                                      \
  X(vkGetPhysicalDeviceMemoryProperties) X(vkEnumerateDeviceExtensionProperties) X(vkCreateDevice) \
      X(vkGetDeviceProcAddr)

#define MESHLODE_DEVICE_FUNCTIONS(X)                                                                                \
  X(vkDestroyDevice)                                                                                                \
  X(vkGetDeviceQueue)                                                                                               \
  X(vkCreateBuffer)                                                                                                 \
  X(vkDestroyBuffer)                                                                                                \
  X(vkGetBufferMemoryRequirements)                                                                                  \
  X(vkAllocateMemory) X(vkFreeMemory) X(vkBindBufferMemory) X(vkMapMemory) X(vkGetBufferDeviceAddress)              \
      X(vkCreateShaderModule) X(vkDestroyShaderModule) X(vkCreatePipelineLayout) X(vkDestroyPipelineLayout)         \
          X(vkCreateComputePipelines) X(vkCreateGraphicsPipelines) X(vkDestroyPipeline) X(vkCreateCommandPool)      \
              X(vkDestroyCommandPool) X(vkAllocateCommandBuffers) X(vkFreeCommandBuffers) X(vkBeginCommandBuffer)   \
                  X(vkEndCommandBuffer) X(vkQueueSubmit2) X(vkCreateFence) X(vkDestroyFence) X(vkWaitForFences)     \
                      X(vkResetFences) X(vkCreateQueryPool) X(vkDestroyQueryPool) X(vkGetQueryPoolResults)          \
                          X(vkCmdResetQueryPool) X(vkCmdWriteTimestamp2) X(vkCmdBindPipeline) X(vkCmdPushConstants) \
                              X(vkCmdDispatch) X(vkCmdDispatchIndirect) X(vkCmdFillBuffer) X(vkCmdCopyBuffer)       \
                                  X(vkCmdPipelineBarrier2) X(vkCmdBeginRendering) X(vkCmdEndRendering)              \
                                      X(vkCmdSetViewport) X(vkCmdSetScissor) X(vkCmdDrawIndirect)
// clang-format on

struct Functions {
#define MESHLODE_MEMBER(name) PFN_##name name = nullptr;
  MESHLODE_GLOBAL_FUNCTIONS(MESHLODE_MEMBER)
  MESHLODE_INSTANCE_FUNCTIONS(MESHLODE_MEMBER)
  MESHLODE_DEVICE_FUNCTIONS(MESHLODE_MEMBER)
#undef MESHLODE_MEMBER
  // NOLINTBEGIN(readability-identifier-naming): the functions' own names, as the macro gives them above.
  PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;
  PFN_vkCmdDrawMeshTasksIndirectEXT vkCmdDrawMeshTasksIndirectEXT = nullptr;
  // NOLINTEND(readability-identifier-naming)
};

constexpr std::uint32_t kPushBytes = 128;
constexpr std::uint32_t kMaxStamps = 128;
constexpr std::uint64_t kStagingBytes = 16u << 20;

template <class T>
[[nodiscard]] T tagged(VkStructureType type) {
  T out{};
  out.sType = type;
  return out;
}

[[nodiscard]] inline Error unsupported(std::string detail) {
  return {ErrorCode::kUnsupported, "vulkan", std::move(detail)};
}

struct InstanceImpl {
  void* library = nullptr;
  Functions f;
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  bool is_validating = false;
  std::mutex mutex;
  std::vector<std::string> messages;

  InstanceImpl() = default;
  InstanceImpl(const InstanceImpl&) = delete;
  InstanceImpl& operator=(const InstanceImpl&) = delete;
  ~InstanceImpl() {
    if (messenger != VK_NULL_HANDLE) f.vkDestroyDebugUtilsMessengerEXT(instance, messenger, nullptr);
    if (instance != VK_NULL_HANDLE) f.vkDestroyInstance(instance, nullptr);
    // The library stays: drivers leave threads and exit handlers behind that would run into unmapped code.
  }
};

struct DeviceImpl {
  std::shared_ptr<InstanceImpl> instance;
  Functions f;
  DeviceInfo info;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkShaderStageFlags push_stages = 0;
  VkPhysicalDeviceMemoryProperties memory{};
  Buffer staging;

  DeviceImpl() = default;
  DeviceImpl(const DeviceImpl&) = delete;
  DeviceImpl& operator=(const DeviceImpl&) = delete;
  ~DeviceImpl();
};

struct BufferImpl {
  std::shared_ptr<DeviceImpl> owner;  ///< none for the staging buffer: it would own its owner
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkDestroyBuffer destroy = nullptr;
  PFN_vkFreeMemory release = nullptr;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  std::uint64_t address = 0, bytes = 0;
  std::uint8_t* mapped = nullptr;

  BufferImpl() = default;
  BufferImpl(const BufferImpl&) = delete;
  BufferImpl& operator=(const BufferImpl&) = delete;
  ~BufferImpl() {
    if (buffer != VK_NULL_HANDLE) destroy(device, buffer, nullptr);
    if (memory != VK_NULL_HANDLE) release(device, memory, nullptr);
  }
};

struct PipelineImpl {
  std::shared_ptr<DeviceImpl> device;
  VkPipeline pipeline = VK_NULL_HANDLE;
  bool is_mesh_shader = false;

  PipelineImpl() = default;
  PipelineImpl(const PipelineImpl&) = delete;
  PipelineImpl& operator=(const PipelineImpl&) = delete;
  ~PipelineImpl() {
    if (pipeline != VK_NULL_HANDLE) device->f.vkDestroyPipeline(device->device, pipeline, nullptr);
  }
};

struct CommandsImpl {
  std::shared_ptr<DeviceImpl> device;
  VkCommandBuffer buffer = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  VkQueryPool queries = VK_NULL_HANDLE;
  std::vector<std::string> stamps;
  std::vector<std::shared_ptr<void>> keep;  ///< what the list refers to
  bool is_ended = false;

  CommandsImpl() = default;
  CommandsImpl(const CommandsImpl&) = delete;
  CommandsImpl& operator=(const CommandsImpl&) = delete;
  ~CommandsImpl() {
    const Functions& f = device->f;
    if (buffer != VK_NULL_HANDLE) f.vkFreeCommandBuffers(device->device, device->pool, 1, &buffer);
    if (fence != VK_NULL_HANDLE) f.vkDestroyFence(device->device, fence, nullptr);
    if (queries != VK_NULL_HANDLE) f.vkDestroyQueryPool(device->device, queries, nullptr);
  }
};

}  // namespace meshlode::draw
