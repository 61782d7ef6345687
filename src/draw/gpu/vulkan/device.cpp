// SPDX-License-Identifier: GPL-3.0-or-later
// The loader, the choice of a device and its features.
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/vulkan/types.h"

namespace meshlode::draw {

namespace {

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
  if (out->library == nullptr) {
    const char* why = dlerror();
    return unsupported("no Vulkan loader on this machine: " + std::string(why != nullptr ? why : "libvulkan.so.1"));
  }
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
  VkPhysicalDeviceFloatControlsProperties floats =
      tagged<VkPhysicalDeviceFloatControlsProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES);
  v11.pNext = &driver;
  driver.pNext = &floats;
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
  // Without these a device may round towards zero, and ids rest on sums and products rounded to nearest.
  need(floats.shaderRoundingModeRTEFloat32, "shaderRoundingModeRTEFloat32");
  need(floats.shaderRoundingModeRTEFloat64, "shaderRoundingModeRTEFloat64");
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

DeviceImpl::~DeviceImpl() {
  staging = {};
  if (layout != VK_NULL_HANDLE) f.vkDestroyPipelineLayout(device, layout, nullptr);
  if (pool != VK_NULL_HANDLE) f.vkDestroyCommandPool(device, pool, nullptr);
  if (device != VK_NULL_HANDLE) f.vkDestroyDevice(device, nullptr);
}
Result<std::vector<DeviceInfo>> list_devices() {
  TRY_LET(instance, make_instance(false));
  TRY_LET(candidates, find_devices(**instance));
  std::vector<DeviceInfo> out;
  for (const Candidate& candidate : *candidates) out.push_back(candidate.info);
  return out;
}

namespace {

/// The one that is named, by index or a part of the name; without a name the first that can run.
Result<const Candidate*> choose(const std::vector<Candidate>& candidates, const std::string& name) {
  const Candidate* chosen = nullptr;
  std::size_t index = candidates.size();
  std::from_chars(name.data(), name.data() + name.size(), index);
  for (std::size_t i = 0; i < candidates.size() && chosen == nullptr; ++i) {
    const DeviceInfo& info = candidates[i].info;
    const bool is_named = !name.empty() && (i == index || info.name.find(name) != std::string::npos);
    if (name.empty() ? info.missing.empty() : is_named) chosen = &candidates[i];
  }
  if (chosen == nullptr) {
    if (name.empty()) return unsupported(candidates[0].info.name + " lacks " + candidates[0].info.missing);
    std::string names;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      names += (i > 0 ? ", " : "") + std::to_string(i) + " " + candidates[i].info.name;
    }
    return Error{ErrorCode::kUsage, "--device", "no device " + name + "; there are: " + names};
  }
  if (!chosen->info.missing.empty()) return unsupported(chosen->info.name + " lacks " + chosen->info.missing);
  return chosen;
}

/// The device with the features that shaders here use.
Status create_device(const Candidate& chosen, DeviceImpl& d) {
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
  queue.queueFamilyIndex = chosen.queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  const char* mesh_extension = VK_EXT_MESH_SHADER_EXTENSION_NAME;
  VkDeviceCreateInfo create = tagged<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  create.pNext = &features.core;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = d.info.has_mesh_shaders ? 1 : 0;
  create.ppEnabledExtensionNames = &mesh_extension;
  if (d.f.vkCreateDevice(chosen.device, &create, nullptr, &d.device) != VK_SUCCESS) {
    d.device = VK_NULL_HANDLE;
    return unsupported(d.info.name + " could not be opened");
  }
  return Ok{};
}

void load_functions(DeviceImpl& d) {
#define MESHLODE_LOAD(name) d.f.name = reinterpret_cast<PFN_##name>(d.f.vkGetDeviceProcAddr(d.device, #name));
  MESHLODE_DEVICE_FUNCTIONS(MESHLODE_LOAD)
  if (d.info.has_mesh_shaders) MESHLODE_LOAD(vkCmdDrawMeshTasksIndirectEXT)
#undef MESHLODE_LOAD
}

/// What command lists come from, and the one layout of all pipelines: push constants alone.
Status make_pool_and_layout(const Candidate& chosen, DeviceImpl& d) {
  VkCommandPoolCreateInfo pool = tagged<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.queueFamilyIndex = chosen.queue_family;
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
  return Ok{};
}

}  // namespace

Result<Device> Device::open(const DeviceOptions& options) {
  TRY_LET(instance, make_instance(options.validate));
  TRY_LET(candidates, find_devices(**instance));
  TRY_LET(found, choose(*candidates, options.device));
  const Candidate& chosen = **found;

  Device out;
  out.impl_ = std::make_shared<DeviceImpl>();
  DeviceImpl& d = *out.impl_;
  d.instance = *instance;
  d.f = d.instance->f;
  d.info = chosen.info;
  TRY(create_device(chosen, d));
  load_functions(d);
  d.f.vkGetDeviceQueue(d.device, chosen.queue_family, 0, &d.queue);
  d.f.vkGetPhysicalDeviceMemoryProperties(chosen.device, &d.memory);
  TRY(make_pool_and_layout(chosen, d));
  TRY_LET(staging, out.make_buffer(kStagingBytes, Memory::kHost));
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

}  // namespace meshlode::draw
