// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu/vulkan.h"

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <mutex>

namespace meshlode::gpu {

namespace {

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

struct Functions {
#define MESHLODE_MEMBER(name) PFN_##name name = nullptr;
  MESHLODE_GLOBAL_FUNCTIONS(MESHLODE_MEMBER)
  MESHLODE_INSTANCE_FUNCTIONS(MESHLODE_MEMBER)
  MESHLODE_DEVICE_FUNCTIONS(MESHLODE_MEMBER)
#undef MESHLODE_MEMBER
  PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;
  PFN_vkCmdDrawMeshTasksIndirectEXT vkCmdDrawMeshTasksIndirectEXT = nullptr;
};

constexpr std::uint32_t kPushBytes = 128;
constexpr std::uint32_t kMaxStamps = 128;
constexpr std::uint64_t kStagingBytes = 16u << 20;

template <class T>
T tagged(VkStructureType type) {
  T out{};
  out.sType = type;
  return out;
}

Error unsupported(std::string detail) {
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

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto* instance = static_cast<InstanceImpl*>(user);
  const std::lock_guard lock(instance->mutex);
  instance->messages.emplace_back(data->pMessage != nullptr ? data->pMessage : "");
  return VK_FALSE;
}

bool has_layer(const Functions& f, const char* name) {
  std::uint32_t count = 0;
  f.vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  f.vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

Result<std::shared_ptr<InstanceImpl>> make_instance(bool validate) {
  auto out = std::make_shared<InstanceImpl>();
  out->library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (out->library == nullptr) return unsupported("no Vulkan loader (libvulkan.so.1) on this machine");
  const auto get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(out->library, "vkGetInstanceProcAddr"));
  if (get == nullptr) return unsupported("libvulkan.so.1 is not a Vulkan loader");
  Functions& f = out->f;
#define MESHLODE_LOAD(name) f.name = reinterpret_cast<PFN_##name>(get(out->instance, #name));
  MESHLODE_GLOBAL_FUNCTIONS(MESHLODE_LOAD)
  std::uint32_t version = 0;
  if (f.vkCreateInstance == nullptr || f.vkEnumerateInstanceVersion == nullptr ||
      f.vkEnumerateInstanceVersion(&version) != VK_SUCCESS || version < VK_API_VERSION_1_3) {
    return unsupported("the Vulkan loader is older than 1.3");
  }
  constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
  out->is_validating = validate && has_layer(f, kLayer);

  VkApplicationInfo application = tagged<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "meshlode";
  application.apiVersion = VK_API_VERSION_1_3;
  const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features = tagged<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enables;
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  VkInstanceCreateInfo create = tagged<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  create.pApplicationInfo = &application;
  if (out->is_validating) {
    create.pNext = &features;
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &kLayer;
    create.enabledExtensionCount = 2;
    create.ppEnabledExtensionNames = extensions;
  }
  if (f.vkCreateInstance(&create, nullptr, &out->instance) != VK_SUCCESS) {
    out->instance = VK_NULL_HANDLE;
    return unsupported("no Vulkan driver on this machine");
  }
  MESHLODE_INSTANCE_FUNCTIONS(MESHLODE_LOAD)
  if (out->is_validating) {
    MESHLODE_LOAD(vkCreateDebugUtilsMessengerEXT)
    MESHLODE_LOAD(vkDestroyDebugUtilsMessengerEXT)
    VkDebugUtilsMessengerCreateInfoEXT info =
        tagged<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = out.get();
    if (f.vkCreateDebugUtilsMessengerEXT(out->instance, &info, nullptr, &out->messenger) != VK_SUCCESS) {
      out->messenger = VK_NULL_HANDLE;
      out->is_validating = false;
    }
  }
#undef MESHLODE_LOAD
  return out;
}

struct Features {
  VkPhysicalDeviceMeshShaderFeaturesEXT mesh =
      tagged<VkPhysicalDeviceMeshShaderFeaturesEXT>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT);
  VkPhysicalDeviceVulkan13Features v13 =
      tagged<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  VkPhysicalDeviceVulkan12Features v12 =
      tagged<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  VkPhysicalDeviceVulkan11Features v11 =
      tagged<VkPhysicalDeviceVulkan11Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
  VkPhysicalDeviceFeatures2 core = tagged<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);

  explicit Features(bool with_mesh) {
    core.pNext = &v11;
    v11.pNext = &v12;
    v12.pNext = &v13;
    v13.pNext = with_mesh ? &mesh : nullptr;
  }
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;
};

struct Candidate {
  VkPhysicalDevice device = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  DeviceInfo info;
};

Candidate describe(const Functions& f, VkPhysicalDevice device) {
  Candidate out;
  out.device = device;
  VkPhysicalDeviceVulkan11Properties v11 =
      tagged<VkPhysicalDeviceVulkan11Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES);
  VkPhysicalDeviceDriverProperties driver =
      tagged<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  v11.pNext = &driver;
  VkPhysicalDeviceProperties2 properties =
      tagged<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &v11;
  f.vkGetPhysicalDeviceProperties2(device, &properties);
  DeviceInfo& info = out.info;
  info.name = properties.properties.deviceName;
  info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
  info.is_software = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.subgroup_size = v11.subgroupSize;
  info.timestamp_ns = static_cast<double>(properties.properties.limits.timestampPeriod);
  if (properties.properties.apiVersion < VK_API_VERSION_1_3) {
    info.missing = "Vulkan 1.3";
    return out;
  }
  std::uint32_t count = 0;
  f.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  f.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  const bool has_mesh_extension = std::any_of(extensions.begin(), extensions.end(), [](const auto& e) {
    return std::strcmp(e.extensionName, VK_EXT_MESH_SHADER_EXTENSION_NAME) == 0;
  });
  Features features(has_mesh_extension);
  f.vkGetPhysicalDeviceFeatures2(device, &features.core);
  info.has_mesh_shaders = has_mesh_extension && features.mesh.meshShader != 0;
  const auto need = [&](VkBool32 has, const char* name) {
    if (has == 0) info.missing += (info.missing.empty() ? "" : ", ") + std::string(name);
  };
  need(features.core.features.shaderInt64, "shaderInt64");
  need(features.core.features.shaderFloat64, "shaderFloat64");
  need(features.core.features.fragmentStoresAndAtomics, "fragmentStoresAndAtomics");
  need(features.v12.bufferDeviceAddress, "bufferDeviceAddress");
  need(features.v12.shaderBufferInt64Atomics, "shaderBufferInt64Atomics");
  need(features.v12.scalarBlockLayout, "scalarBlockLayout");
  need(features.v13.maintenance4, "maintenance4");
  need(features.v13.dynamicRendering, "dynamicRendering");
  need(features.v13.synchronization2, "synchronization2");

  f.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  f.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags kQueue = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  const auto family = std::find_if(families.begin(), families.end(), [&](const auto& q) {
    return (q.queueFlags & kQueue) == kQueue && q.timestampValidBits >= 32;
  });
  if (family == families.end()) need(VK_FALSE, "a queue for compute, graphics and timestamps");
  out.queue_family = family == families.end() ? 0 : static_cast<std::uint32_t>(family - families.begin());
  return out;
}

Result<std::vector<Candidate>> find_devices(const InstanceImpl& instance) {
  std::uint32_t count = 0;
  instance.f.vkEnumeratePhysicalDevices(instance.instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  instance.f.vkEnumeratePhysicalDevices(instance.instance, &count, devices.data());
  std::vector<Candidate> out;
  for (std::uint32_t i = 0; i < count; ++i) out.push_back(describe(instance.f, devices[i]));
  if (out.empty()) return unsupported("the loader found no device");
  return out;
}

}  // namespace

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

DeviceImpl::~DeviceImpl() {
  staging = {};
  if (layout != VK_NULL_HANDLE) f.vkDestroyPipelineLayout(device, layout, nullptr);
  if (pool != VK_NULL_HANDLE) f.vkDestroyCommandPool(device, pool, nullptr);
  if (device != VK_NULL_HANDLE) f.vkDestroyDevice(device, nullptr);
}

std::uint64_t Buffer::address() const {
  return impl_->address;
}
std::uint64_t Buffer::bytes() const {
  return impl_->bytes;
}
std::uint8_t* Buffer::mapped() const {
  return impl_->mapped;
}

Result<std::vector<DeviceInfo>> list_devices() {
  const auto instance = make_instance(false);
  if (!instance) return instance.error();
  const auto candidates = find_devices(**instance);
  if (!candidates) return candidates.error();
  std::vector<DeviceInfo> out;
  for (const Candidate& candidate : *candidates) out.push_back(candidate.info);
  return out;
}

Result<Device> Device::open(const DeviceOptions& options) {
  auto instance = make_instance(options.validate);
  if (!instance) return instance.error();
  const auto candidates = find_devices(**instance);
  if (!candidates) return candidates.error();

  const Candidate* chosen = nullptr;
  std::size_t index = candidates->size();
  std::from_chars(options.device.data(), options.device.data() + options.device.size(), index);
  for (std::size_t i = 0; i < candidates->size() && chosen == nullptr; ++i) {
    const DeviceInfo& info = (*candidates)[i].info;
    const bool is_named =
        !options.device.empty() && (i == index || info.name.find(options.device) != std::string::npos);
    if (options.device.empty() ? info.missing.empty() : is_named) chosen = &(*candidates)[i];
  }
  if (chosen == nullptr) {
    if (options.device.empty()) {
      return unsupported((*candidates)[0].info.name + " lacks " + (*candidates)[0].info.missing);
    }
    std::string names;
    for (std::size_t i = 0; i < candidates->size(); ++i) {
      names += (i > 0 ? ", " : "") + std::to_string(i) + " " + (*candidates)[i].info.name;
    }
    return Error{ErrorCode::kUsage, "--device", "no device " + options.device + "; there are: " + names};
  }
  if (!chosen->info.missing.empty()) return unsupported(chosen->info.name + " lacks " + chosen->info.missing);

  Device out;
  out.impl_ = std::make_shared<DeviceImpl>();
  DeviceImpl& d = *out.impl_;
  d.instance = *instance;
  d.f = d.instance->f;
  d.info = chosen->info;
  Features features(d.info.has_mesh_shaders);
  features.core.features.shaderInt64 = VK_TRUE;
  features.core.features.shaderFloat64 = VK_TRUE;
  features.core.features.fragmentStoresAndAtomics = VK_TRUE;
  features.v12.bufferDeviceAddress = VK_TRUE;
  features.v12.shaderBufferInt64Atomics = VK_TRUE;
  features.v12.scalarBlockLayout = VK_TRUE;
  features.v13.maintenance4 = VK_TRUE;
  features.v13.dynamicRendering = VK_TRUE;
  features.v13.synchronization2 = VK_TRUE;
  features.mesh.meshShader = d.info.has_mesh_shaders ? VK_TRUE : VK_FALSE;
  const float priority = 1.0F;
  VkDeviceQueueCreateInfo queue = tagged<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = chosen->queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  const char* mesh_extension = VK_EXT_MESH_SHADER_EXTENSION_NAME;
  VkDeviceCreateInfo create = tagged<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  create.pNext = &features.core;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = d.info.has_mesh_shaders ? 1 : 0;
  create.ppEnabledExtensionNames = &mesh_extension;
  if (d.f.vkCreateDevice(chosen->device, &create, nullptr, &d.device) != VK_SUCCESS) {
    d.device = VK_NULL_HANDLE;
    return unsupported(d.info.name + " could not be opened");
  }
#define MESHLODE_LOAD(name) d.f.name = reinterpret_cast<PFN_##name>(d.f.vkGetDeviceProcAddr(d.device, #name));
  MESHLODE_DEVICE_FUNCTIONS(MESHLODE_LOAD)
  if (d.info.has_mesh_shaders) MESHLODE_LOAD(vkCmdDrawMeshTasksIndirectEXT)
#undef MESHLODE_LOAD
  d.f.vkGetDeviceQueue(d.device, chosen->queue_family, 0, &d.queue);
  d.f.vkGetPhysicalDeviceMemoryProperties(chosen->device, &d.memory);
  VkCommandPoolCreateInfo pool = tagged<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.queueFamilyIndex = chosen->queue_family;
  if (d.f.vkCreateCommandPool(d.device, &pool, nullptr, &d.pool) != VK_SUCCESS) return unsupported("no command pool");
  d.push_stages = VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  if (d.info.has_mesh_shaders) d.push_stages |= VK_SHADER_STAGE_MESH_BIT_EXT;
  const VkPushConstantRange range{d.push_stages, 0, kPushBytes};
  VkPipelineLayoutCreateInfo layout = tagged<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  if (d.f.vkCreatePipelineLayout(d.device, &layout, nullptr, &d.layout) != VK_SUCCESS) {
    return unsupported("no pipeline layout");
  }
  auto staging = out.make_buffer(kStagingBytes, Memory::kHost);
  if (!staging) return staging.error();
  d.staging = *staging;
  return out;
}

const DeviceInfo& Device::info() const {
  return impl_->info;
}
bool Device::is_validating() const {
  return impl_->instance->is_validating;
}
std::vector<std::string> Device::messages() const {
  const std::lock_guard lock(impl_->instance->mutex);
  return impl_->instance->messages;
}

Result<Buffer> Device::make_buffer(std::uint64_t bytes, Memory kind) {
  DeviceImpl& d = *impl_;
  Buffer out;
  out.impl_ = std::make_shared<BufferImpl>();
  BufferImpl& b = *out.impl_;
  if (d.staging) b.owner = impl_;
  b.device = d.device;
  b.destroy = d.f.vkDestroyBuffer;
  b.release = d.f.vkFreeMemory;
  b.bytes = (std::max<std::uint64_t>(bytes, 16) + 15) / 16 * 16;
  VkBufferCreateInfo create = tagged<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  create.size = b.bytes;
  create.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  const std::string size = std::to_string(b.bytes) + " bytes";
  if (d.f.vkCreateBuffer(d.device, &create, nullptr, &b.buffer) != VK_SUCCESS) {
    b.buffer = VK_NULL_HANDLE;
    return unsupported("no buffer of " + size);
  }
  VkMemoryRequirements needs{};
  d.f.vkGetBufferMemoryRequirements(d.device, b.buffer, &needs);
  const VkMemoryPropertyFlags wanted = kind == Memory::kDevice
                                           ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                           : VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  // Reading back from uncached memory is slow: of the mapped types a cached one is preferred.
  std::uint32_t type = VK_MAX_MEMORY_TYPES;
  for (std::uint32_t i = 0; i < d.memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = d.memory.memoryTypes[i].propertyFlags;
    if ((needs.memoryTypeBits >> i & 1u) == 0 || (flags & wanted) != wanted) continue;
    const bool is_cached = (flags & VK_MEMORY_PROPERTY_HOST_CACHED_BIT) != 0;
    if (type == VK_MAX_MEMORY_TYPES || (kind == Memory::kHost && is_cached)) type = i;
  }
  if (type == VK_MAX_MEMORY_TYPES) return unsupported("no memory type for " + size);
  VkMemoryAllocateFlagsInfo flags = tagged<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo allocate = tagged<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.pNext = &flags;
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  if (d.f.vkAllocateMemory(d.device, &allocate, nullptr, &b.memory) != VK_SUCCESS) {
    b.memory = VK_NULL_HANDLE;
    return unsupported("the device has no room for " + size);
  }
  if (d.f.vkBindBufferMemory(d.device, b.buffer, b.memory, 0) != VK_SUCCESS) return unsupported("no memory bound");
  if (kind == Memory::kHost) {
    void* mapped = nullptr;
    if (d.f.vkMapMemory(d.device, b.memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
      return unsupported("memory could not be mapped");
    }
    b.mapped = static_cast<std::uint8_t*>(mapped);
  }
  VkBufferDeviceAddressInfo address = tagged<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  address.buffer = b.buffer;
  b.address = d.f.vkGetBufferDeviceAddress(d.device, &address);
  return out;
}

Status Device::upload(const Buffer& buffer, std::span<const std::uint8_t> bytes, std::uint64_t offset) {
  if (offset > buffer.bytes() || bytes.size() > buffer.bytes() - offset)
    return unsupported("upload past a buffer's end");
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t count = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
    std::memcpy(impl_->staging.mapped(), bytes.data() + done, count);
    auto commands = Commands::begin(*this);
    if (!commands) return commands.error();
    commands->copy(impl_->staging, 0, buffer, offset + done, count);
    commands->barrier();
    if (const auto ran = commands->run(); !ran) return ran.error();
    done += count;
  }
  return Ok{};
}

Status Device::download(const Buffer& buffer, std::span<std::uint8_t> bytes, std::uint64_t offset) {
  if (offset > buffer.bytes() || bytes.size() > buffer.bytes() - offset) return unsupported("read past a buffer's end");
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t count = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
    auto commands = Commands::begin(*this);
    if (!commands) return commands.error();
    commands->copy(buffer, offset + done, impl_->staging, 0, count);
    commands->barrier();
    if (const auto ran = commands->run(); !ran) return ran.error();
    std::memcpy(bytes.data() + done, impl_->staging.mapped(), count);
    done += count;
  }
  return Ok{};
}

namespace {

struct ShaderModule {
  DeviceImpl& device;
  VkShaderModule module = VK_NULL_HANDLE;

  ShaderModule(DeviceImpl& d, std::span<const std::uint32_t> spirv) : device(d) {
    VkShaderModuleCreateInfo create = tagged<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    create.codeSize = spirv.size_bytes();
    create.pCode = spirv.data();
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

void bind(CommandsImpl& c, const PipelineImpl& pipeline, VkPipelineBindPoint point,
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
  bind(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_COMPUTE, push);
  // One dimension holds 65535 groups at least; shaders read gl_WorkGroupID.y as the high part.
  constexpr std::uint32_t kRow = 32768;
  c.device->f.vkCmdDispatch(c.buffer, std::min(groups, kRow), (groups + kRow - 1) / kRow, 1);
}

void Commands::dispatch_indirect(const Pipeline& pipeline, std::span<const std::uint8_t> push, const Buffer& arguments,
                                 std::uint64_t offset) {
  CommandsImpl& c = *impl_;
  c.keep.push_back(pipeline.impl_);
  c.keep.push_back(arguments.impl_);
  bind(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_COMPUTE, push);
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
  bind(c, *pipeline.impl_, VK_PIPELINE_BIND_POINT_GRAPHICS, push);
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

}  // namespace meshlode::gpu
